#include "saltus/fesd_integrator/element/rest_projection.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/fesd_integrator/element/dense_system_internal.hpp"
#include "saltus/fesd_integrator/element/selection_margins.hpp"

namespace saltus::fesd_integrator {

RestProjection::RestProjection(const discretization::StageKernel& kernel) : kernel_(kernel) { kernel.size(values_); }

/// Of the surfaces that slide, then of those that rest, by n_x.
linalg::Matrix RestProjection::gradients_of(const ActiveSet& set, std::size_t n_x) const {
  DenseMatrices memory;
  const double* const indicator_x = field_view(values_, memory).indicator_x;
  const std::size_t slide = set.sliding().size();
  linalg::Matrix gradients(index(slide + set.resting().size()), index(n_x));
  for (std::size_t i = 0; i < n_x; ++i) {
    const double* const column = indicator_x + i * kernel_.selections();
    for (std::size_t k = 0; k < slide; ++k) gradients(index(k), index(i)) = set.surface(k, column);
    for (std::size_t k = 0; k < set.resting().size(); ++k) {
      gradients(index(slide + k), index(i)) = set.resting()[k].value(column);
    }
  }
  return gradients;
}

std::optional<double> RestProjection::step(const ActiveSet& set, double size, std::vector<double>& x) {
  const std::size_t n_x = x.size(), slide = set.sliding().size(), count = slide + set.resting().size();
  const linalg::Matrix gradients = gradients_of(set, n_x);
  DenseSystem system;
  system.reserve(index(count));
  system.reset(index(count));
  system.matrix() = gradients * gradients.transpose();
  for (std::size_t k = 0; k < count; ++k) {
    system.right()(index(k)) =
        -(k < slide ? set.sliding()[k].surface : set.resting()[k - slide]).value(values_.indicator.data());
  }
  if (!system.solve(1e-13 * size)) return std::nullopt;
  double change = 0.0;
  for (std::size_t i = 0; i < n_x; ++i) {
    double step = 0.0;
    for (std::size_t k = 0; k < count; ++k) {
      step += gradients(index(k), index(i)) * system.right()(index(k));
    }
    x[i] += step;
    change = std::max(change, std::abs(step));
  }
  return change;
}

bool RestProjection::onto_surfaces(const ActiveSet& set, const Place& place, std::vector<double>& x) {
  const std::vector<double> middle(kernel_.selections(), 0.5);
  constexpr int most_iterations = 20;
  double before = std::numeric_limits<double>::infinity();
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    kernel_.evaluate(place.t, x.data(), middle.data(), place.held, values_);
    const auto change = step(set, place.size, x);
    if (!change) return false;
    if (*change <= 1e-15 * place.size || *change >= 0.5 * before) return *change <= 1e-9 * place.size;
    before = *change;
  }
  return false;
}

RestProjection::Rate RestProjection::rate_of(std::size_t k, const ActiveSet& set, const Place& place,
                                             const std::vector<double>& x) {
  kernel_.evaluate(place.t, x.data(), place.selections.data(), place.held, values_);
  Rate rate{set.surface(k, values_.indicator_t.data()), false};
  const linalg::Matrix gradients = gradients_of(set, x.size());
  DenseMatrices memory;
  const double* const f_selection = field_view(values_, memory).f_selection;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double gradient = gradients(index(k), index(i));
    rate.value += gradient * values_.f[i];
    for (const Sliding& entry : set.sliding()) {
      double along = f_selection[at(entry.selection) * x.size() + i];
      if (entry.reference >= 0) along -= f_selection[at(entry.reference) * x.size() + i];
      rate.moved = rate.moved || gradient * along != 0.0;
    }
  }
  return rate;
}

/// A step along the gradient of the rate of surface k, and back onto the surfaces.
bool RestProjection::rest_one(std::size_t k, const ActiveSet& set, const Place& place, double farthest,
                              std::vector<double>& x) {
  const Rate rate = rate_of(k, set, place, x);
  if (rate.moved || rate.value == 0.0) return true;
  std::vector<double> gradient(x.size());
  double square = 0.0, noise = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    // Central differences with the step of least error.
    const double step = 6e-6 * std::max(place.size, std::abs(x[i]));
    auto above = x, below = x;
    above[i] += step;
    below[i] -= step;
    gradient[i] = (rate_of(k, set, place, above).value - rate_of(k, set, place, below).value) / (2.0 * step);
    square += gradient[i] * gradient[i];
    noise += 1e-14 * place.size * std::abs(gradient[i]);
  }
  if (std::abs(rate.value) <= noise) return true;
  if (!(square > 0.0)) return false;
  auto moved = x;
  double distance = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    moved[i] -= rate.value * gradient[i] / square;
    distance = std::max(distance, std::abs(moved[i] - x[i]));
  }
  if (!(distance <= farthest) || !onto_surfaces(set, place, moved)) return false;
  if (std::abs(rate_of(k, set, place, moved).value) > std::max(noise, 1e-3 * std::abs(rate.value))) return false;
  x = std::move(moved);
  return true;
}

bool RestProjection::to_rest(const ActiveSet& set, const Place& place, double farthest, std::vector<double>& x) {
  if (!onto_surfaces(set, place, x)) return false;
  Place behind = place;
  for (std::size_t j = 0; j < behind.selections.size(); ++j) {
    if (set.modes()[j] == 0) behind.selections[j] = 0.5;
  }
  // One surface after the other: as a rule there is one.
  for (std::size_t k = 0; k < set.sliding().size(); ++k) {
    if (!rest_one(k, set, behind, farthest, x)) return false;
  }
  return true;
}

}  // namespace saltus::fesd_integrator
