#include <cmath>

#include "saltus/base/at.hpp"
#include "saltus/linalg/factors.hpp"
#include "saltus/linalg/matrix.hpp"
#include "saltus/model/layout.hpp"
#include "saltus/pipeline/optimal_control/touching_bodies_internal.hpp"

namespace saltus::pipeline {

using result::ContactMode;

TouchingBodies::TouchingBodies(const evaluation::ModelKernel& kernel)
    : kernel_(kernel), alpha_(at(kernel.switching_functions()), 0.5) {}

std::vector<ContactMode> TouchingBodies::modes_at(double t, const std::vector<double>& x) {
  constexpr double none = 1e-9;
  std::vector<ContactMode> modes;
  if (kernel_.layout().contacts.empty()) return modes;
  evaluate(t, x);
  for (linalg::Index k = 0; k < values_.gap.size(); ++k) {
    const bool rests = values_.gap(k) <= none && std::abs(values_.velocity(k)) <= none;
    modes.push_back(rests ? ContactMode::closed : ContactMode::open);
  }
  return modes;
}

void TouchingBodies::project(double t, const std::vector<ContactMode>& modes, std::vector<double>& x) {
  if (modes.empty()) return;
  constexpr int corrections = 5;
  for (int i = 0; i < corrections; ++i) {
    evaluate(t, x);
    std::vector<int> rows;
    for (std::size_t k = 0; k < modes.size(); ++k) {
      if (modes[k] != ContactMode::open || values_.gap(index(k)) < 0.0) rows.push_back(static_cast<int>(k));
    }
    if (rows.empty()) break;
    correct(rows, values_.gap.selected_rows(rows), kernel_.layout().positions, x);
  }
  evaluate(t, x);
  std::vector<int> held;
  for (std::size_t k = 0; k < modes.size(); ++k) {
    if (modes[k] != ContactMode::open) held.push_back(static_cast<int>(k));
    if (modes[k] == ContactMode::stick) held.push_back(static_cast<int>(k + modes.size()));
  }
  if (!held.empty()) correct(held, values_.velocity.selected_rows(held), kernel_.layout().velocities, x);
}

std::vector<std::vector<double>> TouchingBodies::impulses(double t, const std::vector<double>& x,
                                                          const std::vector<double>& x_after) {
  constexpr double closed = 1e-6;  // gaps of an optimised trajectory
  evaluate(t, x);
  const auto& contacts = kernel_.layout().contacts;
  const auto& velocities = kernel_.layout().velocities;
  const auto m = static_cast<int>(contacts.size());
  std::vector<int> rows;
  for (int i = 0; i < m; ++i) {
    const auto& contact = contacts[at(i)];
    if (!contact.has_gap || values_.gap(i) > closed) continue;
    rows.push_back(i);
    for (int k = 0; contact.has_friction && k < contact.tangents(); ++k) rows.push_back(m * (1 + k) + i);
  }
  linalg::Vector change(index(velocities.size())), all = linalg::Vector::zero(values_.velocity.size());
  for (std::size_t k = 0; k < velocities.size(); ++k) {
    const std::size_t v = at(velocities[k]);
    change(index(k)) = x_after[v] - x[v];
  }
  if (!rows.empty()) {
    const linalg::Vector found_impulses = linalg::least_squares(values_.responses.selected_cols(rows), change);
    for (std::size_t k = 0; k < rows.size(); ++k) all(rows[k]) = found_impulses(index(k));
  }
  std::vector<std::vector<double>> found;
  for (int i = 0; i < m; ++i) {
    found.push_back({all(i)});
    const auto& contact = contacts[at(i)];
    for (int k = 0; k < contact.tangents(); ++k) {
      found.back().push_back(contact.has_friction ? all(m * (1 + k) + i) : 0.0);
    }
  }
  return found;
}

void TouchingBodies::evaluate(double t, const std::vector<double>& x) {
  kernel_.contacts(t, x.data(), alpha_.data(), values_);
}

void TouchingBodies::correct(const std::vector<int>& rows, const linalg::Vector& values, const std::vector<int>& states,
                             std::vector<double>& x) const {
  const linalg::Matrix response = values_.responses.selected_cols(rows);
  const linalg::Matrix influence = values_.rows.selected_rows(rows) * response;
  const linalg::Vector change = response * linalg::least_squares(influence, values);
  for (std::size_t k = 0; k < states.size(); ++k) x[at(states[k])] -= change(index(k));
}

}  // namespace saltus::pipeline
