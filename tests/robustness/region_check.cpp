// Judges runs of random systems of regions by indicator, with weights from linear equations of its own.
#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "region_systems.hpp"
#include "saltus/linalg/factors.hpp"
#include "saltus/linalg/matrix.hpp"

namespace saltus::robustness {
namespace {

using linalg::Matrix;
using linalg::Vector;
using result::Result;

Vector vector_of(const std::vector<double>& x) { return linalg::ConstView(x); }

double indicator(const RegionSystem& system, std::size_t i, const Vector& x) {
  const Region& region = system.regions[i];
  return system.quadratic * x.squared_norm() + vector_of(region.slope).dot(x) + region.offset;
}

Vector field(const RegionSystem& system, std::size_t i, const Vector& x) {
  const Region& region = system.regions[i];
  Vector xdot = vector_of(region.b);
  for (linalg::Index row = 0; row < xdot.size(); ++row)
    xdot[row] += vector_of(region.A[static_cast<std::size_t>(row)]).dot(x);
  return xdot;
}

/// Regions that are active together.
class ActiveSet {
 public:
  ActiveSet(const RegionSystem& system, std::vector<std::size_t> active) : system_(system), active_(std::move(active)) {
    const auto m = static_cast<linalg::Index>(active_.size()), n = static_cast<linalg::Index>(system.start.size());
    // The quadratic terms of indicators are one: gradients of differences are constant.
    differences_.resize(m - 1, n);
    for (linalg::Index k = 1; k < m; ++k) {
      differences_.row(k - 1) = slope(k) - slope(0);
    }
    rank_ = m > 1 ? linalg::FullLu(differences_).rank() : 0;
  }

  [[nodiscard]] bool is_determined() const { return rank_ == differences_.rows(); }
  /// More regions than the differences of their indicators tell apart, at a point that these fix.
  [[nodiscard]] bool is_fixed() const { return rank_ == differences_.cols(); }

  /// The field with weights that keep the indicators equal; nullopt where these are not positive to `slack`, or not
  /// determined.
  [[nodiscard]] std::optional<Vector> sliding_field(const Vector& x, double slack) const {
    const auto m = static_cast<linalg::Index>(active_.size());
    Matrix fields(x.size(), m), equations = Matrix::constant(m, m, 1.0);
    for (linalg::Index k = 0; k < m; ++k) fields.col(k) = field(system_, active_[static_cast<std::size_t>(k)], x);
    if (m > 1) equations.top_rows(m - 1) = differences_ * fields;
    Vector right = Vector::zero(m);
    right[m - 1] = 1.0;
    const Vector theta = linalg::FullLu(equations).solve(right);
    if (!theta.all_finite() || theta.min() < -slack) return std::nullopt;
    return Vector(fields * theta);
  }

  /// d(g_i - g_0)/dt of the largest one with given weights, of the size of the fields; and the field.
  [[nodiscard]] double imbalance(const Vector& x, const std::vector<double>& theta) const {
    Vector xdot = Vector::zero(x.size());
    double size = 1.0;
    for (const std::size_t i : active_) {
      const Vector f = field(system_, i, x);
      size = std::max(size, f.norm());
      xdot += theta[i] * f;
    }
    return active_.size() > 1 ? (differences_ * xdot).max_abs() / size : 0.0;
  }

  /// Whether the fields of two regions that slide against each other both point to their border.
  [[nodiscard]] bool holds_two(const Vector& x, double slack) const {
    if (active_.size() != 2) return true;
    const double first = differences_.row(0).dot(field(system_, active_[0], x));
    const double second = differences_.row(0).dot(field(system_, active_[1], x));
    return first <= slack && second >= -slack;
  }

 private:
  [[nodiscard]] Vector slope(linalg::Index k) const {
    return vector_of(system_.regions[active_[static_cast<std::size_t>(k)]].slope);
  }

  const RegionSystem& system_;
  std::vector<std::size_t> active_;
  Matrix differences_;
  linalg::Index rank_ = 0;
};

std::vector<std::size_t> active_of(const Result& result, std::size_t row) {
  std::vector<std::size_t> active;
  for (const auto& region : result.trajectory.regions[row].front()) active.push_back(std::stoul(region.substr(1)));
  return active;
}

std::string row_of(const RegionSystem& system, const std::vector<std::size_t>& active, const Vector& x,
                   const std::vector<double>& theta) {
  const ActiveSet set(system, active);
  double smallest = INFINITY, sum = 0.0;
  for (std::size_t i = 0; i < system.regions.size(); ++i) smallest = std::min(smallest, indicator(system, i, x));
  for (std::size_t i = 0; i < system.regions.size(); ++i) {
    const bool is_active = std::find(active.begin(), active.end(), i) != active.end();
    if (!(theta[i] >= -1e-9) || (!is_active && theta[i] != 0.0)) return fmt::format("weight {} of r{}", theta[i], i);
    sum += theta[i];
    const double above = indicator(system, i, x) - smallest;
    if (is_active && !(above <= 1e-10 * (1.0 + x.squared_norm())))
      return fmt::format("r{} is {} above the smallest", i, above);
  }
  if (!(std::abs(sum - 1.0) <= 1e-12)) return fmt::format("weights sum up to {}", sum);
  if (const double d = set.imbalance(x, theta); !(d <= 1e-8)) return fmt::format("weights leave d g/dt = {}", d);
  return "";
}

std::string follow(const RegionSystem& system, const std::vector<std::size_t>& active, double duration, const Vector& x,
                   const Vector& x_next, double rtol) {
  const ActiveSet set(system, active);
  const double size = std::max({1.0, x.max_abs(), x_next.max_abs()});
  const double tolerance = (10.0 * rtol + 1e-9) * size;
  if (!set.is_determined()) {
    if (set.is_fixed() && !((x_next - x).max_abs() <= tolerance)) return "moves where many regions meet";
    return "";
  }
  Vector before;
  for (int steps = 1; steps <= 4096; steps *= 2) {
    const double h = duration / steps;
    Vector y = x;
    std::string problem;
    for (int step = 0; step < steps; ++step) {
      const auto rate = [&](const Vector& at) { return set.sliding_field(at, INFINITY).value(); };
      const Vector k1 = rate(y), k2 = rate(y + 0.5 * h * k1), k3 = rate(y + 0.5 * h * k2), k4 = rate(y + h * k3);
      if (step > 0 && problem.empty()) {
        if (!set.sliding_field(y, 1e-6)) problem = "weights that are negative on the way";
        if (!set.holds_two(y, 1e-6 * size)) problem = "slides where a field points away";
        double smallest = INFINITY;
        for (std::size_t i = 0; i < system.regions.size(); ++i) smallest = std::min(smallest, indicator(system, i, y));
        const double above = indicator(system, active.front(), y) - smallest;
        if (!(above <= 10.0 * tolerance)) problem = fmt::format("a region is {} above the smallest on the way", above);
      }
      y += h / 6.0 * (k1 + 2.0 * (k2 + k3) + k4);
    }
    if (before.size() > 0 && (before - y).max_abs() <= 0.01 * tolerance) {
      if (!problem.empty()) return problem;
      const double error = (y - x_next).max_abs();
      return error <= tolerance ? ""
                                : fmt::format("the next row is {} off, that is {} rtol", error, error / (size * rtol));
    }
    before = y;
  }
  return "fixed steps do not converge";
}

}  // namespace

std::string complaint(const RegionSystem& system, const Result& result, double rtol) {
  using result::Termination;
  const bool completed = result.status.termination == Termination::completed;
  if (!completed && (result.status.termination != Termination::outside_class || result.status.message.empty())) {
    return fmt::format("{}: {}", result::name(result.status.termination), result.status.message);
  }
  const auto& rows = result.trajectory;
  const auto limit_at = [&](double t) {
    return std::any_of(result.events.begin(), result.events.end(), [&](const auto& event) {
      return event.kind == result::EventKind::accumulation && std::abs(event.t - t) <= 1e-6;
    });
  };
  for (std::size_t i = 0; i + 1 < rows.t.size() || (completed && i < rows.t.size()); ++i) {
    const auto active = active_of(result, i);
    const Vector x = vector_of(rows.x[i]);
    const auto where = [&](const std::string& problem) {
      return fmt::format("row {} (t = {:.17g}, regions {}): {}", i, rows.t[i], fmt::join(active, " "), problem);
    };
    // The last cycles before a limit, and what is extrapolated of them.
    const bool in_cycles = limit_at(rows.t[i]);
    if (const auto problem = in_cycles ? "" : row_of(system, active, x, rows.theta[i]); !problem.empty())
      return where(problem);
    if (i + 1 == rows.t.size()) break;
    const Vector x_next = vector_of(rows.x[i + 1]);
    const double moves = (x_next - x).max_abs();
    const double duration = rows.t[i + 1] - rows.t[i];
    if (duration < 0.0) return where("the next row is earlier");
    if (duration == 0.0 || (in_cycles && limit_at(rows.t[i + 1]))) {
      if (!(moves <= (in_cycles ? 1e-5 : 1e-12 * (1.0 + x.norm()))))
        return where(fmt::format("moves by {} at once", moves));
      continue;
    }
    if (const auto problem = follow(system, active, duration, x, x_next, rtol); !problem.empty()) return where(problem);
  }
  return "";
}

}  // namespace saltus::robustness
