#include "saltus/event_integrator/field/held_functions.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "saltus/event_integrator/mode/at_surface.hpp"
#include "saltus/event_integrator/mode/small_internal.hpp"

namespace saltus::event_integrator {
namespace {

using linalg::Index;

/// Width of central differences, a power of two relative to 1 + |x|: truncation and rounding are both about 1e-11.
double width_at(double x) { return std::ldexp(std::exp2(std::ceil(std::log2(std::abs(x) + 1.0))), -17); }

}  // namespace

HeldFunctions::HeldFunctions(const evaluation::ModelKernel& kernel)
    : kernel_(kernel),
      row_(at(kernel.states())),
      direction_(row_.size()),
      point_(row_.size()),
      values_(at(kernel.event_functions())) {
  set({}, {});
}

void HeldFunctions::set(std::vector<HeldFunction> functions, std::vector<double> alpha) {
  functions_ = std::move(functions);
  alpha_ = std::move(alpha);
  const auto m = index(functions_.size());
  rows_.set_zero(m, kernel_.states());
  basis_.set_zero(kernel_.states(), m);
  rates_.set_zero(m);
  parts_.set_zero(m);
  const auto of_order_zero = std::count_if(functions_.begin(), functions_.end(),
                                           [](const HeldFunction& function) { return function.order == 0; });
  rooted_ = std::any_of(functions_.begin(), functions_.end(),
                        [&](const HeldFunction& function) { return kernel_.has_root(function.surface); });
  find_forms();
  onto_[0].residual.set_zero(static_cast<Index>(of_order_zero));
  onto_[1].residual.set_zero(m);
  for (auto& part : onto_) part.gradients.resize(static_cast<std::size_t>(part.residual.size()), row_.size());
}

void HeldFunctions::find_forms() {
  forms_.clear();
  beside_root_.clear();
  for (const HeldFunction& function : functions_) {
    const auto is_inside = [&](const HeldFunction& other) {
      return other.order == 0 && contains(kernel_.inner(function.surface), other.surface);
    };
    const bool around = std::any_of(functions_.begin(), functions_.end(), is_inside);
    forms_.push_back(around ? kernel_.with_limited_roots(function.surface) : function.surface);
    beside_root_.push_back(!around && function.order == 0 && is_around_root(kernel_, function.surface));
  }
}

double HeldFunctions::value(std::size_t i, double t, const double* x) const {
  const auto [surface, order] = functions_[i];
  if (order > 0 || forms_[i] < 0) return kernel_.lie_derivative(forms_[i], order, t, x, alpha_.data());
  kernel_.functions(t, x, alpha_.data(), values_.data());
  return values_[at(surface)];
}

/// The number of functions before i that are of lower order.
std::size_t HeldFunctions::below(std::size_t i) const {
  std::size_t lower = i;
  while (lower > 0 && functions_[lower - 1].order == functions_[i].order) --lower;
  return lower;
}

/// The part of a unit vector along the set where the first `lower` functions vanish; false if there is none.
bool HeldFunctions::tangent_direction(std::size_t state, std::size_t lower, std::vector<double>& direction) const {
  std::fill(direction.begin(), direction.end(), 0.0);
  direction[state] = 1.0;
  for (std::size_t k = 0; k < lower; ++k) {
    const double part = basis_(index(state), index(k));
    for (std::size_t i = 0; i < direction.size(); ++i) direction[i] -= part * basis_(index(i), index(k));
  }
  double square = 0.0;
  for (const double d : direction) square += d * d;
  constexpr double dependent = 1e-20;  // of the square of a unit vector
  return square > dependent;
}

/// How a point moves, into direction_, that stays where the first `lower` functions vanish as time passes: in the span
/// of their gradients.
void HeldFunctions::find_drift(std::size_t lower) {
  std::fill(direction_.begin(), direction_.end(), 0.0);
  for (std::size_t k = 0; k < lower; ++k) {
    double missing = -rates_[index(k)];
    for (std::size_t s = 0; s < direction_.size(); ++s) missing -= rows_(index(k), index(s)) * direction_[s];
    const double along = rows_.row(index(k)).dot(basis_.col(index(k)));
    if (missing == 0.0 || along == 0.0) continue;
    for (std::size_t s = 0; s < direction_.size(); ++s) direction_[s] += missing / along * basis_(index(s), index(k));
  }
}

/// Function i at x, displaced along direction_.
double HeldFunctions::value_along(std::size_t i, double t, const double* x, double width) {
  for (std::size_t s = 0; s < point_.size(); ++s) point_[s] = x[s] + width * direction_[s];
  return value(i, t, point_.data());
}

/// Gradient i, less what the ones before span, normed.
void HeldFunctions::extend_basis(std::size_t i) {
  const auto row = rows_.row(index(i));
  basis_.col(index(i)) = row;
  Index from = 0, to = row.size();
  while (from < to && row(from) == 0.0) ++from;
  while (to > from && row(to - 1) == 0.0) --to;
  bool is_orthogonal = true;  // to those before it
  for (std::size_t k = 0; k < i; ++k) {
    // Of many surfaces most have no states in common: their product is 0 without forming it.
    if (basis_.col(index(k)).segment(from, to - from).is_zero()) continue;
    basis_.col(index(i)).add_scaled(-row.dot(basis_.col(index(k))), basis_.col(index(k)));
    is_orthogonal = false;
  }
  const double whole = row.norm();
  const double size = is_orthogonal ? whole : basis_.col(index(i)).norm();
  parts_[index(i)] = whole == 0.0 ? 0.0 : size / whole;
  if (size > 0.0) basis_.col(index(i)) /= size;
}

void HeldFunctions::differentiate(double t, const double* x) {
  for (std::size_t i = 0; i < functions_.size(); ++i) {
    const auto r = index(i);
    if (functions_[i].order == 0) {
      if (forms_[i] < 0) {
        kernel_.lie_gradient(forms_[i], 0, t, x, alpha_.data(), row_.data(), &rates_[r]);
      } else {
        kernel_.gradient(functions_[i].surface, t, x, alpha_.data(), row_.data(), &rates_[r]);
      }
      for (std::size_t k = 0; k < row_.size(); ++k) rows_(r, index(k)) = row_[k];
      extend_basis(i);
      continue;
    }
    const std::size_t lower = below(i);
    const bool by_form = is_by_form(i);
    double rate = 0.0;
    if (by_form) kernel_.lie_gradient(forms_[i], functions_[i].order, t, x, alpha_.data(), row_.data(), &rate);
    const auto along = [&] { return std::inner_product(row_.begin(), row_.end(), direction_.begin(), 0.0); };
    for (std::size_t k = 0; k < row_.size(); ++k) {
      rows_(r, index(k)) = 0.0;
      if (!tangent_direction(k, lower, direction_)) continue;
      const double width = width_at(x[k]);
      rows_(r, index(k)) =
          by_form ? along() : (value_along(i, t, x, width) - value_along(i, t, x, -width)) / (2.0 * width);
    }
    const double width = width_at(t);
    find_drift(lower);
    rates_[r] = by_form ? rate + along()
                        : (value_along(i, t + width, x, width) - value_along(i, t - width, x, -width)) / (2.0 * width);
    extend_basis(i);
  }
}

double HeldFunctions::velocity(std::size_t i, const std::vector<double>& f) const {
  double sum = rates_[index(i)];
  for (std::size_t k = 0; k < f.size(); ++k) {
    // A field may be infinite in states that the function does not hold.
    if (rows_(index(i), index(k)) != 0.0) sum += rows_(index(i), index(k)) * f[k];
  }
  return sum;
}

double HeldFunctions::velocity_terms(std::size_t i, const std::vector<double>& f) const {
  double sum = std::abs(rates_[index(i)]);
  for (std::size_t k = 0; k < f.size(); ++k) sum += std::abs(rows_(index(i), index(k)) * f[k]);
  return sum;
}

/// The gradients of its functions, behind differentiate().
NormalRows& HeldFunctions::gradients_of(Part& part) {
  for (Index r = 0; r < part.residual.size(); ++r) {
    for (std::size_t k = 0; k < row_.size(); ++k) row_[k] = rows_(r, index(k));
    part.gradients.set(static_cast<std::size_t>(r), row_);
  }
  return part.gradients;
}

void HeldFunctions::remove_normal_part(std::vector<double>& f) {
  auto& [gradients, residual] = onto_[1];
  for (std::size_t i = 0; i < functions_.size(); ++i) residual[index(i)] = velocity(i, f);
  if (!gradients_of(onto_[1]).solve(residual)) {
    std::fill(f.begin(), f.end(), std::numeric_limits<double>::quiet_NaN());
    return;
  }
  gradients.subtract_transposed(residual, f.data());
  // A function of one state fixes its rate: a coordinate stays exactly where it is.
  for (Index r = 0; r < rates_.size(); ++r) {
    const int only = gradients[static_cast<std::size_t>(r)].only();
    if (only < 0) continue;
    double& rate = f[at(only)];
    if (std::isfinite(rate)) rate = rates_[r] == 0.0 ? 0.0 : -rates_[r] / rows_(r, only);
  }
}

/// One Newton step onto the functions of a part; whether x changed.
bool HeldFunctions::correct(Part& part, double t, double* x) {
  bool away = false;
  for (Index r = 0; r < part.residual.size(); ++r) {
    part.residual[r] = value(static_cast<std::size_t>(r), t, x);
    away = away || part.residual[r] != 0.0;
  }
  if (!away || !part.residual.all_finite()) return false;
  differentiate(t, x);
  return gradients_of(part).correct(part.residual, x);
}

bool HeldFunctions::project(double t, double* x) {
  bool changed = false;
  // Derivatives mean something on the surfaces only. Newton converges quadratically: three steps reach rounding.
  for (auto& part : onto_) {
    for (int iteration = 0; iteration < 4 && correct(part, t, x); ++iteration) changed = true;
  }
  return changed;
}

std::vector<double> HeldFunctions::displaced(double t, const double* x, double step, unsigned pattern) {
  std::vector<double> moved(x, x + row_.size());
  for (std::size_t k = 0; k < row_.size(); ++k) {
    if (!tangent_direction(k, functions_.size(), direction_)) continue;
    const double length = displacement(k, x[k], step, pattern);
    for (std::size_t i = 0; i < moved.size(); ++i) moved[i] += length * direction_[i];
  }
  static_cast<void>(project(t, moved.data()));
  return moved;
}

}  // namespace saltus::event_integrator
