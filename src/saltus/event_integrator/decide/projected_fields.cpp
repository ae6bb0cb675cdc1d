#include "saltus/event_integrator/decide/projected_fields.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "saltus/event_integrator/field/held_functions.hpp"
#include "saltus/event_integrator/mode/at_surface.hpp"
#include "saltus/event_integrator/mode/resolution.hpp"
#include "saltus/event_integrator/mode/small_internal.hpp"
#include "saltus/event_integrator/sliding/normal_rows.hpp"
#include "saltus/linalg/sparse_factors.hpp"
#include "saltus/switching/table/independent_rows.hpp"

namespace saltus::event_integrator {
namespace {

/// Derivatives looked at before psi is said to stay 0.
constexpr int most_derivatives = 5;

Motion along_velocity(double velocity) {
  return {{velocity, velocity > 0.0 ? switching::Drift::up : switching::Drift::down}, 1};
}

}  // namespace

ProjectedFields::ProjectedFields(const evaluation::ModelKernel& kernel, const SwitchingPoint& switching_point)
    : kernel_(kernel), switching_point_(switching_point), noise_(at(kernel.event_functions())), slope_(noise_.size()) {
  // Any selections do: scales only bound rounding.
  const std::vector<double> alpha(at(kernel.switching_functions()), 0.5);
  kernel.scales(switching_point.t, switching_point.x, alpha.data(), noise_.data(), slope_.data());
  // A handful of roundings of terms as large as the magnitude.
  for (double& value : noise_) value = std::isfinite(value) ? rounding_of(value) : 0.0;
}

std::vector<double> ProjectedFields::corner_alpha(const std::vector<double>& base, const std::vector<int>& group,
                                                  std::size_t corner) const {
  std::vector<double> alpha = base;
  for (std::size_t i = 0; i < group.size(); ++i) alpha[at(group[i])] = (corner >> i & 1U) != 0 ? 1.0 : 0.0;
  std::vector<double> values;
  // Inner functions have smaller indices: one ascending pass reads every nested sign with its inner ones settled.
  for (int j = 0; j < kernel_.switching_functions(); ++j) {
    const auto& inner = kernel_.inner(j);
    if (inner.empty() || contains(switching_point_.at_zero, j)) continue;
    const auto in_group = [&](int i) { return contains(group, i); };
    if (std::none_of(inner.begin(), inner.end(), in_group)) continue;
    values.resize(at(kernel_.event_functions()));
    kernel_.functions(switching_point_.t, switching_point_.x, alpha.data(), values.data());
    if (std::abs(values[at(j)]) > noise_[at(j)]) alpha[at(j)] = values[at(j)] > 0.0 ? 1.0 : 0.0;
  }
  return alpha;
}

std::vector<double> ProjectedFields::point_beside(const std::vector<double>& alpha) const {
  const auto n = at(kernel_.states());
  std::vector<double> x(switching_point_.x, switching_point_.x + n);
  std::vector<double> row(n);
  std::vector<double> values(at(kernel_.event_functions()));
  double largest = 0.0;
  for (const double value : x) largest = std::max(largest, std::abs(value));
  for (const int j : switching_point_.at_zero) {
    kernel_.functions(switching_point_.t, x.data(), alpha.data(), values.data());
    double rate = 0.0;
    kernel_.gradient(j, switching_point_.t, switching_point_.x, alpha.data(), row.data(), &rate);
    double square = 0.0;
    for (const double d : row) square += d * d;
    if (!(square > 0.0) || !std::isfinite(square)) continue;
    // Just enough to be on the right side after rounding, of states that are 0, too.
    constexpr double least_state = 1e-30;
    const double distance =
        4.0 * std::max({noise_[at(j)], rounding_unit * slope_[at(j)] * largest, least_state * slope_[at(j)]});
    const double side = alpha[at(j)] == 1.0 ? 1.0 : alpha[at(j)] == 0.0 ? -1.0 : 0.0;
    const double step = side * distance - values[at(j)];
    if (!std::isfinite(step)) continue;
    for (std::size_t i = 0; i < n; ++i) x[i] += step * row[i] / square;
  }
  return x;
}

std::vector<double> ProjectedFields::velocities(const std::vector<double>& alpha, const std::vector<int>& group) const {
  const auto n = at(kernel_.states());
  std::vector<double> f(n);
  std::vector<double> row(n);
  std::vector<double> beside;
  const double* x = switching_point_.x;
  kernel_.field(switching_point_.t, x, alpha.data(), f.data());
  if (!is_finite(f)) {
    beside = point_beside(alpha);
    x = beside.data();
    kernel_.field(switching_point_.t, x, alpha.data(), f.data());
  }
  std::vector<double> result;
  result.reserve(group.size());
  for (const int j : group) {
    double velocity = 0.0;
    kernel_.gradient(j, switching_point_.t, x, alpha.data(), row.data(), &velocity);
    for (std::size_t i = 0; i < n; ++i) velocity += row[i] == 0.0 ? 0.0 : row[i] * f[i];
    result.push_back(velocity);
  }
  return result;
}

std::optional<Motion> ProjectedFields::motion_by_velocity(double velocity, double scale) {
  if (std::abs(velocity) > sign_tolerance * scale) return along_velocity(velocity);
  return std::nullopt;
}

/// Whether a velocity has the other sign a few roundings of the time later: the event is not known better than that.
bool ProjectedFields::turns_within_rounding(const std::vector<double>& alpha, int surface, double velocity) const {
  const double time = 64.0 * rounding_unit * std::abs(switching_point_.t);
  const double bend = kernel_.lie_derivative(surface, 2, switching_point_.t, switching_point_.x, alpha.data());
  return velocity * bend < 0.0 && std::abs(velocity) <= std::abs(bend) * time;
}

bool ProjectedFields::is_exit(int surface, int side) const {
  return contains(side > 0 ? switching_point_.exit_above : switching_point_.exit_below, surface);
}

Motion ProjectedFields::motion_seen(const std::vector<double>& alpha, int surface, int side, double velocity,
                                    double scale) const {
  const bool leaves = is_exit(surface, side);
  Motion motion = this->motion(alpha, surface, leaves ? 0.0 : velocity, scale);
  // At a two-fold point sliding does not end with the field that leaves.
  const bool is_seen = !leaves || std::abs(velocity) < selection_rounding * scale;
  if (is_seen && motion.order > 1)
    motion.side.drift = leaves == (side > 0) ? switching::Drift::up : switching::Drift::down;
  return motion;
}

Motion ProjectedFields::motion(const std::vector<double>& alpha, int surface, double velocity, double scale) const {
  const double tau = switching_point_.time_scale;
  // Where all fields are nearly tangent the scale says nothing: what a velocity moves psi by has to be more than
  // rounding.
  const bool moves = std::abs(velocity) * tau > noise_[at(surface)];
  const auto motion = motion_by_velocity(velocity, scale);
  if (motion && moves && !turns_within_rounding(alpha, surface, velocity)) return *motion;
  if (!kernel_.inner(surface).empty() &&
      moves_along(kernel_, alpha, surface, switching_point_.t, switching_point_.x, scale))
    return {};
  // What turns later is no tangency.
  constexpr double by_far = 1e3;
  const double threshold = std::max(noise_[at(surface)], (moves ? by_far : 1.0) * std::abs(velocity) * tau);
  double weight = tau;  // tau^k / k!
  for (int order = 2; order <= most_derivatives; ++order) {
    weight *= tau / order;
    const double derivative =
        kernel_.lie_derivative(surface, order, switching_point_.t, switching_point_.x, alpha.data());
    if (std::abs(derivative) * weight > threshold) {
      return {{0.0, derivative > 0.0 ? switching::Drift::up : switching::Drift::down}, order};
    }
  }
  // Small, but not rounding, and no later derivative overrules it.
  if (std::abs(velocity) > velocity_rounding * scale) return along_velocity(velocity);
  return {};
}

bool ProjectedFields::nearly_two_fold(const std::vector<double>& alpha, int surface) const {
  // A selection is carried along to about 1e-8 of its fields: a hundred times that leaves it two digits. Ten times less
  // and steps end in roundings before they get here; ten times more would refuse slow sliding that is still accurate.
  constexpr double nearly = 1e-6;
  std::vector<double> f(at(kernel_.states()));
  std::vector<double> row(f.size());
  for (const std::size_t corner : {std::size_t{0}, std::size_t{1}}) {
    const auto selections = corner_alpha(alpha, {surface}, corner);
    double velocity = 0.0;
    kernel_.field(switching_point_.t, switching_point_.x, selections.data(), f.data());
    kernel_.gradient(surface, switching_point_.t, switching_point_.x, selections.data(), row.data(), &velocity);
    const double rate = velocity;
    double row_square = 0.0;
    double f_square = 0.0;
    for (std::size_t i = 0; i < f.size(); ++i) {
      velocity += row[i] * f[i];
      row_square += row[i] * row[i];
      f_square += f[i] * f[i];
    }
    if (!(std::abs(velocity) <= nearly * (std::sqrt(row_square * f_square) + std::abs(rate)))) return false;
  }
  return true;
}

bool ProjectedFields::gradient_vanishes(const std::vector<double>& alpha, int surface) const {
  const auto n = at(kernel_.states());
  std::vector<double> row(n);
  std::vector<double> x(switching_point_.x, switching_point_.x + n);
  double rate = 0.0;
  const auto size = [&] {
    kernel_.gradient(surface, switching_point_.t, x.data(), alpha.data(), row.data(), &rate);
    double sum = 0.0;
    for (const double d : row) sum += std::abs(d);
    return sum;
  };
  const double here = size();
  if (rate != 0.0 || here == 0.0) return rate == 0.0;
  // Close by: a thousandth of the state and of what a step changes. A square is located to a relative 1e-8, where its
  // gradient is 1e-5 of that.
  constexpr double close = 1e-3, vanishing = 1e-4;
  std::vector<double> f(n);
  kernel_.field(switching_point_.t, switching_point_.x, alpha.data(), f.data());
  for (std::size_t i = 0; i < n; ++i) x[i] += close * (std::abs(x[i]) + switching_point_.time_scale * std::abs(f[i]));
  return here <= vanishing * size();
}

/// Of many surfaces each depends on few states: a sparse factorisation. nullopt where a gradient is not finite, beside
/// a root.
std::optional<bool> ProjectedFields::sparse_gradients_depend(const std::vector<double>& alpha,
                                                             const std::vector<int>& surfaces) const {
  const auto n = at(kernel_.states());
  std::vector<double> row(n);
  std::vector<linalg::Triplet> entries;
  for (std::size_t k = 0; k < surfaces.size(); ++k) {
    double in_time = 0.0, square = 0.0;
    kernel_.gradient(surfaces[k], switching_point_.t, switching_point_.x, alpha.data(), row.data(), &in_time);
    for (const double d : row) square += d * d;
    if (!std::isfinite(square)) return std::nullopt;
    if (square == 0.0) return true;
    for (std::size_t i = 0; i < n; ++i) {
      if (row[i] != 0.0)
        entries.push_back({static_cast<linalg::Index>(i), static_cast<linalg::Index>(k), row[i] / std::sqrt(square)});
    }
  }
  const linalg::SparseColumns gradients(static_cast<linalg::Index>(n), static_cast<linalg::Index>(surfaces.size()),
                                        entries);
  return !linalg::dependent_columns(gradients, switching::dependent_part).empty();
}

bool ProjectedFields::gradients_depend(const std::vector<double>& alpha, const std::vector<int>& surfaces) const {
  if (surfaces.size() >= sparse_from) {
    if (const auto depend = sparse_gradients_depend(alpha, surfaces)) return *depend;
  }
  std::vector<HeldFunction> functions;
  for (const int j : surfaces) functions.push_back({j, 0});
  HeldFunctions held(kernel_);
  held.set(std::move(functions), alpha);
  held.differentiate(switching_point_.t, switching_point_.x);
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    if (held.independent_part(i) <= switching::dependent_part) return true;
  }
  return false;
}

switching::CornerTable ProjectedFields::table(const ModeState& before, const std::vector<int>& group) const {
  switching::CornerTable table;
  table.surfaces = static_cast<int>(group.size());
  table.sides.resize(group.size() * table.corners());
  std::vector<std::vector<double>> alphas;
  for (std::size_t corner = 0; corner < table.corners(); ++corner) {
    alphas.push_back(corner_alpha(before.alpha, group, corner));
    const auto velocity = velocities(alphas.back(), group);
    for (std::size_t j = 0; j < group.size(); ++j) table.sides[j * table.corners() + corner].velocity = velocity[j];
  }
  for (std::size_t j = 0; j < group.size(); ++j) {
    const int surface = group[j];
    const int mode = before.mode[at(surface)];
    double scale = 0.0;
    for (std::size_t corner = 0; corner < table.corners(); ++corner) {
      scale = std::max(scale, std::abs(table.side(static_cast<int>(j), corner).velocity));
    }
    for (std::size_t corner = 0; corner < table.corners(); ++corner) {
      auto& side = table.sides[j * table.corners() + corner];
      // Of coupled surfaces no single field need be tangent at an exit, nor is it the one that arrives.
      const int sign = (corner >> j & 1U) != 0 ? 1 : -1;
      const bool arrives = sign == mode && !switching_point_.start && contains(switching_point_.touched, surface);
      const bool is_seen = group.size() == 1 && (arrives || is_exit(surface, sign));
      const double velocity = side.velocity;
      side = (is_seen ? motion_seen(alphas[corner], surface, sign, velocity, scale)
                      : motion(alphas[corner], surface, velocity, scale))
                 .side;
    }
    table.arrival.push_back(switching_point_.start ? switching::Arrival::at_start
                            : mode < 0             ? switching::Arrival::from_below
                            : mode > 0             ? switching::Arrival::from_above
                                                   : switching::Arrival::along);
  }
  return table;
}

bool ProjectedFields::fields_agree(const ModeState& before, const std::vector<int>& group) const {
  const auto n = at(kernel_.states());
  std::vector<double> first(n);
  std::vector<double> other(n);
  const std::size_t corners = std::size_t{1} << group.size();
  kernel_.field(switching_point_.t, switching_point_.x, corner_alpha(before.alpha, group, 0).data(), first.data());
  for (std::size_t corner = 1; corner < corners; ++corner) {
    kernel_.field(switching_point_.t, switching_point_.x, corner_alpha(before.alpha, group, corner).data(),
                  other.data());
    constexpr double one_field = 1e-12;
    for (std::size_t i = 0; i < n; ++i) {
      const double size = std::max(std::abs(first[i]), std::abs(other[i]));
      if (!(std::abs(first[i] - other[i]) <= one_field * size)) return false;
    }
  }
  return true;
}

}  // namespace saltus::event_integrator
