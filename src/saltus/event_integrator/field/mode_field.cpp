#include "saltus/event_integrator/field/mode_field.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "saltus/event_integrator/mode/small_internal.hpp"
#include "saltus/switching/table/surface_decision.hpp"

namespace saltus::event_integrator {

ModeField::ModeField(const evaluation::ModelKernel& kernel, bool affine_in_alpha)
    : kernel_(kernel),
      affine_in_alpha_(affine_in_alpha),
      rows_(at(kernel.switching_functions())),
      groups_(at(kernel.switching_functions())),
      exit_rows_(kernel) {
  const auto n_psi = at(kernel.switching_functions());
  for (auto& f : f_) f.resize(at(kernel.states()));
  for (auto& corner : corner_) corner.resize(n_psi);
  trial_.resize(n_psi);
  alpha_.resize(n_psi);
  values_.resize(at(kernel.event_functions()));
}

void ModeField::gradients(double t, const double* x) {
  for (std::size_t row = 0; rows_.varying > 0 && row < sliding_.size(); ++row) {
    if (rows_.is_constant[row]) continue;
    if (!rows_.take_known(row, at(sliding_[row]))) {
      // With the mode's selections, not the last ones: the field must not depend on what was evaluated before.
      kernel_.gradient(sliding_[row], t, x, start_alpha_.data(), f_[0].data(),
                       &rows_.rates[static_cast<linalg::Index>(row)]);
      take_row(row);
    }
    if (sliding_.size() != 1) continue;
    rows_.square = rows_.dense.squared_norm();
    refer_to_constants();
  }
  find_ties();
}

ode::Attempt ModeField::attempt(ode::Stepper& stepper, double t, const double* x, const double* slope, double h,
                                const ode::Tolerances& tolerances) {
  constexpr double the_same = 1.0 + 1e-9;
  if (known_ != nullptr && t == known_->t && h <= known_->h * the_same) {
    stepper.follow(*known_, std::min(h, known_->h));
    return ode::Attempt::finite;
  }
  const auto f = [this](double t_stage, const double* x_stage, double* xdot) { (*this)(t_stage, x_stage, xdot); };
  auto stages = native_stages();
  if (stepper.wants_linear_field()) {
    stages.linear = linear_field();
    if (stages.linear != nullptr) return stepper.attempt(f, t, x, slope, h, tolerances, stages);
  }
  if (stepper.wants_pattern() && solve_ != SlidingSolve::higher_order) {
    const auto of_region = [this](double t_start, const double* x_start, double* entries) {
      return kernel_.field_jacobian(t_start, x_start, constants_[0].alpha.data(), entries);
    };
    const ode::JacobianFunction jacobian(of_region);
    return stepper.attempt(f, t, x, slope, h, tolerances,
                           {.functions = {},
                            .pattern = kernel_.jacobian_pattern(),
                            .jacobian = solve_ == SlidingSolve::none ? &jacobian : nullptr});
  }
  if (stepper.stages_function(stages.functions) == nullptr) return stepper.attempt(f, t, x, slope, h, tolerances);
  const long before = stepper.evaluations();
  const auto outcome = stepper.attempt(f, t, x, slope, h, tolerances, stages);
  constants_[0].use->evaluations += (is_single() ? 2 : 1) * (stepper.evaluations() - before);
  return outcome;
}

ode::RightHandSideStages ModeField::native_stages() const {
  if (solve_ == SlidingSolve::none) {
    if (!constants_[0].has_steps()) return {};
    return {constants_[0].steps->field, constants_[0].values.data()};
  }
  if (!is_single() || !rows_.is_constant[0] || !constants_[0].has_steps()) return {};
  return {constants_[0].steps->sliding, &sliding_constants_};
}

const ode::LinearField* ModeField::linear_field() {
  if (solve_ == SlidingSolve::none) return linear_motion_.of_region(kernel_, constants_[0]);
  if (!is_single() || !rows_.is_constant[0]) return nullptr;
  return linear_motion_.on_surface(kernel_, constants_[0], constants_[1], {rows_.dense.data(), rows_.coordinate[0]});
}

const evaluation::AffineRow* ModeField::exit_row(std::size_t row, Region region, const double* x) {
  if (solve_ != SlidingSolve::decoupled || !rows_.is_constant[row]) return nullptr;
  const double side = region == Region::below ? 0.0 : 1.0;
  // Where several are slid on, none of the others influences this one.
  const auto& alpha = sliding_.size() == 1 ? corner_[region == Region::below ? 0 : 1] : start_alpha_;
  return exit_rows_.of(sliding_[row], side, kept_state(row, x), alpha,
                       kernel_.has_fixed_constants() ? ExitRows::Rows::lasting : ExitRows::Rows::changing);
}

double ModeField::normal_terms(std::size_t row) const {
  if (solve_ == SlidingSolve::coupled || solve_ == SlidingSolve::higher_order) return groups_.condition[row];
  const auto r = static_cast<linalg::Index>(row);
  double sum = std::abs(rows_.rates[r]);
  const auto& [column, value] = rows_.normal[row];
  for (std::size_t k = 0; k < column.size(); ++k) {
    const std::size_t i = column[k];
    sum += std::abs(value[k]) * std::max(std::abs(f_[0][i]), std::abs(f_[1][i]));
  }
  return sum;
}

/// The fields of the two regions that meet at the one sliding surface, and their normal components.
void ModeField::evaluate_corners(double t, const double* x) {
  gradients(t, x);
  kernel_.prepared_field(t, x, constants_[0], f_[0].data());
  kernel_.prepared_field(t, x, constants_[1], f_[1].data());
  exits_[0] = {rows_.velocity(0, f_[0]), rows_.velocity(0, f_[1]), 0.0};
}

/// The usual sliding: everything in closed form.
void ModeField::slide_on_one(double t, const double* x, double* xdot) {
  evaluate_corners(t, x);
  const double selection = switching::sliding_alpha(exits_[0].below, exits_[0].above);
  for (const std::size_t i : between_) alpha_[i] = corner_[0][i] + selection * (corner_[1][i] - corner_[0][i]);
  const auto n = f_[0].size();
  for (std::size_t i = 0; i < n; ++i) xdot[i] = f_[0][i] + selection * (f_[1][i] - f_[0][i]);
  const double* row = rows_.dense.data();
  if (const int only = rows_.coordinate[0]; only >= 0) {
    if (std::isfinite(xdot[only])) xdot[only] = rows_.rates[0] == 0.0 ? 0.0 : -rows_.rates[0] / row[only];
    return;
  }
  double normal = rows_.rates[0];
  for (std::size_t i = 0; i < n; ++i) normal += row[i] * xdot[i];
  if (!rooted_rows_.empty()) {  // as in balance_beside_roots()
    const double factor = normal / (exits_[0].above - exits_[0].below);
    for (std::size_t i = 0; i < n; ++i) xdot[i] -= (f_[1][i] - f_[0][i]) * factor;
    return;
  }
  const double factor = rows_.square > 0.0 ? normal / rows_.square : not_a_number;
  for (std::size_t i = 0; i < n; ++i) xdot[i] -= row[i] * factor;
}

double ModeField::selected_velocity(double t, const double* x, std::size_t row, double selection) {
  trial_[at(sliding_[row])] = selection;
  kernel_.field(t, x, trial_.data(), f_[1].data());
  return rows_.velocity(row, f_[1]);
}

void ModeField::evaluate_nonaffine(double t, const double* x) {
  trial_ = start_alpha_;
  for (std::size_t row = 0; row < sliding_.size(); ++row) {
    const auto j = at(sliding_[row]);
    double a = start_alpha_[j];
    constexpr double beside = 1e-3;
    double b = a > 0.5 ? a - beside : a + beside;
    double at_a = selected_velocity(t, x, row, a);
    double at_b = selected_velocity(t, x, row, b);
    for (int iteration = 0; iteration < 30 && at_a != 0.0 && at_a != at_b; ++iteration) {
      const double next = a - at_a * (a - b) / (at_a - at_b);
      const double change = std::abs(next - a);
      b = a;
      at_b = at_a;
      a = next;
      at_a = selected_velocity(t, x, row, a);
      if (change <= 2.0 * std::numeric_limits<double>::epsilon()) break;
    }
    const double width = 1e-4;  // central difference: exact for quadratics, 1e-8 relative otherwise
    const double slope =
        (selected_velocity(t, x, row, a + width) - selected_velocity(t, x, row, a - width)) / (2.0 * width);
    // The secant has left the root it started from: this mode has no selection here.
    if (!(std::abs(a - start_alpha_[j]) < 0.5)) a = not_a_number;
    trial_[j] = a;
    alpha_[j] = a;
    exits_[row] = {a, a - 1.0, slope};
  }
  kernel_.field(t, x, alpha_.data(), f_[0].data());
}

void ModeField::select(double t, const double* x) {
  if (solve_ != SlidingSolve::higher_order) gradients(t, x);
  switch (solve_) {
    case SlidingSolve::none:
      return;
    case SlidingSolve::decoupled:
    case SlidingSolve::coupled:
      return evaluate_groups(t, x);
    case SlidingSolve::nonaffine:
      return evaluate_nonaffine(t, x);
    case SlidingSolve::higher_order:
      return evaluate_higher_order(t, x);
  }
}

/// A balance is lost where all its corners have one sign in some direction; one of its surfaces stands for that.
void ModeField::evaluate_higher_order(double t, const double* x) {
  higher_order_->evaluate(t, x);
  alpha_ = higher_order_->alpha();
  exits_.assign(sliding_.size(), {1.0, -1.0});
  for (const auto& range : higher_order_->ranges()) {
    exits_[range.row] = {range.max, range.min};
    groups_.condition[range.row] = range.exactness * range.terms;
  }
}

void ModeField::slide(double t, const double* x, double* xdot) {
  if (is_single()) return slide_on_one(t, x, xdot);
  select(t, x);
  if (solve_ == SlidingSolve::higher_order) {
    std::copy(higher_order_->motion().begin(), higher_order_->motion().end(), xdot);
    return;
  }
  if (!rooted_rows_.empty() && solve_ == SlidingSolve::decoupled) balance_beside_roots(t, x);
  remove_normal_part(xdot);
}

void ModeField::exits(double t, const double* x, ExitValues* values) {
  if (solve_ == SlidingSolve::none) return;
  if (is_single()) {
    evaluate_corners(t, x);
  } else {
    select(t, x);
    if (solve_ == SlidingSolve::coupled) find_stability();
  }
  std::copy(exits_.begin(), exits_.end(), values);
}

}  // namespace saltus::event_integrator
