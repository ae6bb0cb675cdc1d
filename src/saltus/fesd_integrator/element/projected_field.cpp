#include "saltus/fesd_integrator/element/projected_field.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "saltus/base/at.hpp"
#include "saltus/fesd_integrator/element/newton_system_internal.hpp"
#include "saltus/fesd_integrator/element/sliding_matrices_internal.hpp"

namespace saltus::fesd_integrator {

struct ProjectedField::Work {
  explicit Work(const discretization::StageKernel& kernel)
      : system(kernel.pattern().is_sparse ? NewtonSystem::Storage::sparse : NewtonSystem::Storage::dense,
               static_cast<linalg::Index>(kernel.selections())) {}
  NewtonSystem system;
  std::vector<double> unknown;
};

ProjectedField::ProjectedField(const discretization::StageKernel& kernel)
    : kernel_(kernel), work_(std::make_unique<Work>(kernel)) {
  kernel.size(values_);
  const std::size_t n = kernel.selections();
  work_->unknown.resize(n);
  in_no_equation_.resize(n);
}
ProjectedField::ProjectedField(ProjectedField&&) noexcept = default;
ProjectedField::~ProjectedField() = default;

ProjectedField::Sizes ProjectedField::form_equations(const ActiveSet& set) {
  const auto& sliding = set.sliding();
  const std::size_t count = sliding.size(), n_x = kernel_.states(), n = kernel_.selections();
  auto& system = work_->system;
  system.reset(static_cast<linalg::Index>(count));
  if (system.is_sparse()) return form_entries(set);
  auto matrix = system.matrix();
  auto right = system.right();
  double size = 0.0, gradients = 0.0;
  for (std::size_t k = 0; k < count; ++k) {
    double rate = set.surface(k, values_.indicator_t.data());
    size = std::max(size, std::abs(rate));
    for (std::size_t i = 0; i < n_x; ++i) {
      const double gradient = set.surface(k, values_.indicator_x.data() + i * n);
      if (gradient == 0.0) continue;
      rate += gradient * values_.f[i];
      gradients = std::max(gradients, std::abs(gradient));
      size = std::max(size, std::abs(gradient * values_.f[i]));
      for (std::size_t l = 0; l < count; ++l) {
        const auto j = static_cast<std::size_t>(sliding[l].selection);
        double along = values_.f_selection[j * n_x + i];
        if (sliding[l].reference >= 0) {
          along -= values_.f_selection[static_cast<std::size_t>(sliding[l].reference) * n_x + i];
        }
        matrix(static_cast<linalg::Index>(k), static_cast<linalg::Index>(l)) += gradient * along;
      }
    }
    right(static_cast<linalg::Index>(k)) = -rate;
  }
  for (std::size_t l = 0; l < count; ++l) in_no_equation_[l] = matrix.col(static_cast<linalg::Index>(l)).is_zero();
  return {size, gradients};
}

/// The same by the entries of gradients and directions. Cost: linear in them.
ProjectedField::Sizes ProjectedField::form_entries(const ActiveSet& set) {
  auto& system = work_->system;
  const SparseRows surfaces = sliding_surfaces(set, values_);
  const SparseRows matrix = surfaces * linalg::by_rows(sliding_directions(set, values_));
  Sizes sizes;
  std::fill(in_no_equation_.begin(), in_no_equation_.end(), true);
  for (linalg::Index k = 0; k < surfaces.rows(); ++k) {
    double rate = set.surface(static_cast<std::size_t>(k), values_.indicator_t.data());
    sizes.terms = std::max(sizes.terms, std::abs(rate));
    for (const auto [state, gradient] : surfaces.along(k)) {
      const double term = gradient * values_.f[at(state)];
      rate += term;
      sizes.gradients = std::max(sizes.gradients, std::abs(gradient));
      sizes.terms = std::max(sizes.terms, std::abs(term));
    }
    system.right()(k) = -rate;
    for (const auto [column, value] : matrix.along(k)) {
      system.add(k, column, value);
      if (value != 0.0) in_no_equation_[at(column)] = false;
    }
  }
  return sizes;
}

bool ProjectedField::solve(double t, const double* x, const ActiveSet& set, const double* held, double* selections,
                           double rounding) {
  const auto& sliding = set.sliding();
  const std::size_t count = sliding.size();
  double* unknown = work_->unknown.data();
  set.unknowns(selections, unknown);
  for (std::size_t k = 0; k < count; ++k) {
    // Not at their bounds: there, derivatives of guarded branches are missing.
    if (sliding[k].reference < 0) unknown[k] = std::clamp(unknown[k], 1e-3, 1.0 - 1e-3);
  }
  set.selections(unknown, selections);
  double before = std::numeric_limits<double>::infinity();
  constexpr int most_iterations = 30;
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    kernel_.evaluate(t, x, selections, held, values_);
    regular_ = true;
    if (count == 0) return true;
    const auto [size, gradients] = form_equations(set);
    auto& system = work_->system;
    const bool solved = system.solve(1e-11 * size + rounding * gradients);
    regular_ = system.is_factorised();
    if (!solved) return false;
    double change = 0.0;
    for (std::size_t l = 0; l < count; ++l) {
      const double step = system.right()(static_cast<linalg::Index>(l));
      unknown[l] += step;
      change = std::max(change, std::abs(step));
    }
    set.selections(unknown, selections);
    // Selections are of size 1: 1e-9 and quadratic convergence are rounding; or steps that no longer shrink.
    if ((change <= 1e-9 && before <= 1e-3) || change <= 1e-15 || (change <= 1e-10 && change >= 0.25 * before)) {
      if (change > 1e-15) kernel_.evaluate(t, x, selections, held, values_);
      return true;
    }
    if (change > 1e6) return false;
    before = change;
  }
  return false;
}

void ProjectedField::take_undetermined(const ActiveSet& set, const double* known, double* selections) const {
  for (std::size_t k = 0; k < set.sliding().size(); ++k) {
    if (!in_no_equation(k)) continue;
    const Sliding& entry = set.sliding()[k];
    const auto j = static_cast<std::size_t>(entry.selection);
    const double change = known[j] - selections[j];
    selections[j] = known[j];
    if (entry.reference >= 0) selections[at(entry.reference)] -= change;
  }
}

void ProjectedField::rates(std::vector<double>& rate) const {
  rate.assign(values_.indicator_t.begin(), values_.indicator_t.end());
  for (std::size_t i = 0; i < kernel_.states(); ++i) {
    discretization::visit_column(values_.pattern->indicator_x, values_.indicator_x, i,
                                 [&](std::size_t j, double gradient) { rate[j] += gradient * values_.f[i]; });
  }
}

}  // namespace saltus::fesd_integrator
