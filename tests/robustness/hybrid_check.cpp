// Judges runs of random systems with jumps by their own right-hand sides, resets and thresholds.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "firings.hpp"
#include "hybrid_systems.hpp"
#include "states.hpp"

namespace saltus::robustness {
namespace {

using result::Event;
using result::EventKind;
using result::Result;

double value(const Course& course, double t) {
  if (course.times.empty()) return course.constant + course.amplitude * std::sin(course.frequency * t);
  if (t <= course.times.front()) return course.values.front();
  if (t >= course.times.back()) return course.values.back();
  const auto next = std::upper_bound(course.times.begin(), course.times.end(), t);
  const auto k = static_cast<std::size_t>(next - course.times.begin());
  const double part = (t - course.times[k - 1]) / (course.times[k] - course.times[k - 1]);
  return course.values[k - 1] + part * (course.values[k] - course.values[k - 1]);
}

/// d course / dt in the middle of a stretch without corners: at t.
double slope(const Course& course, double t) {
  if (course.times.empty()) return course.amplitude * course.frequency * std::cos(course.frequency * t);
  if (t <= course.times.front() || t >= course.times.back()) return 0.0;
  const auto next = std::upper_bound(course.times.begin(), course.times.end(), t);
  const auto k = static_cast<std::size_t>(next - course.times.begin());
  return (course.values[k] - course.values[k - 1]) / (course.times[k] - course.times[k - 1]);
}

/// A stretch of one mode: its laws' signs (0: sticks), and the walls that hold.
class Stretch {
 public:
  /// A wall holds where the state is at rest on it at both ends. Cycles that contract have turning points 1e-13 before
  /// it.
  Stretch(const Hybrid& hybrid, std::vector<int> signs, const State& x, const State& x_next)
      : hybrid_(hybrid), signs_(std::move(signs)) {
    for (const Wall& wall : hybrid.walls) {
      const auto rests = [&](const State& y) {
        return std::abs(y[wall.position] - wall.place) <= 1e-14 && std::abs(y[wall.velocity]) <= 1e-12;
      };
      held_.push_back(rests(x) && rests(x_next));
    }
  }

  /// What is wrong at a point; laws and sides to `slack`.
  [[nodiscard]] std::string point(double t, const State& x, double slack) const {
    for (std::size_t k = 0; k < hybrid_.laws.size(); ++k) {
      const Law& law = hybrid_.laws[k];
      if (is_held(law.row)) continue;
      const double psi = x[law.row] - value(law.course, t);
      if (signs_[k] != 0 && !(signs_[k] * psi >= -slack))
        return fmt::format("s{} = {} with sign {}", k, psi, signs_[k]);
      if (signs_[k] != 0) continue;
      if (!(std::abs(psi) <= slack)) return fmt::format("sticks on s{} with psi = {}", k, psi);
      const double needed = free_rate(law.row, t, x) - slope(law.course, t);
      const double size = sticking(law.row);
      // At the corner of a course its rate is that of either side.
      if (!(std::abs(needed) <= size * (1.0 + 1e-6) + 10.0 * slack) && !near_corner(law.course, t)) {
        return fmt::format("sticks on s{} where that needs {} of {}", k, needed, size);
      }
    }
    for (std::size_t k = 0; k < hybrid_.walls.size(); ++k) {
      const Wall& wall = hybrid_.walls[k];
      const double gap = wall.side * (x[wall.position] - wall.place);
      if (!(gap >= -slack)) return fmt::format("behind wall {} by {}", k, -gap);
      const double away = held_[k] ? wall.side * free_rate(wall.velocity, t, x) - sticking(wall.velocity) : 0.0;
      if (!(away <= 1e-6 * (1.0 + size_of(x)))) return fmt::format("held at wall {}, which it leaves with {}", k, away);
    }
    for (std::size_t k = 0; k < hybrid_.thresholds.size(); ++k) {
      const double above = x[hybrid_.thresholds[k].state] - hybrid_.thresholds[k].value;
      if (!(above <= slack)) return fmt::format("above threshold {} by {}", k, above);
    }
    for (std::size_t k = 0; k < hybrid_.relays.size(); ++k) {
      const double n = x[hybrid_.start.size() + k];
      const double beyond = n > 0.0 ? y(k, x) - hybrid_.relays[k].high : hybrid_.relays[k].low - y(k, x);
      if (n != 1.0 && n != -1.0) return fmt::format("relay {} is {}", k, n);
      if (!(beyond <= slack * 3.0)) return fmt::format("relay {} is {}, beyond its threshold by {}", k, n, beyond);
    }
    return "";
  }

  [[nodiscard]] State rates(double t, const State& x) const {
    State xdot(x.size());
    for (std::size_t i = 0; i < hybrid_.start.size(); ++i) {
      if (is_held(i)) continue;
      const auto sticks = std::find_if(hybrid_.laws.begin(), hybrid_.laws.end(), [&](const Law& law) {
        return law.row == i && signs_[static_cast<std::size_t>(&law - hybrid_.laws.data())] == 0;
      });
      xdot[i] = sticks != hybrid_.laws.end() ? slope(sticks->course, t) : free_rate(i, t, x);
    }
    return xdot;
  }

  /// y(k, x) = slope . x of a relay.
  [[nodiscard]] double y(std::size_t k, const State& x) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < hybrid_.start.size(); ++i) sum += hybrid_.relays[k].slope[i] * x[i];
    return sum;
  }

 private:
  [[nodiscard]] bool is_held(std::size_t row) const {
    for (std::size_t k = 0; k < held_.size(); ++k) {
      if (held_[k] && (hybrid_.walls[k].velocity == row || hybrid_.walls[k].position == row)) return true;
    }
    return false;
  }

  /// What laws that stick in a row may add to its rate.
  [[nodiscard]] double sticking(std::size_t row) const {
    double sum = 0.0;
    for (std::size_t k = 0; k < hybrid_.laws.size(); ++k) {
      if (hybrid_.laws[k].row == row && signs_[k] == 0) sum += hybrid_.laws[k].size;
    }
    return sum;
  }

  /// The rate of a row but for what sticks in it.
  [[nodiscard]] double free_rate(std::size_t row, double t, const State& x) const {
    double rate = hybrid_.b[row];
    for (std::size_t j = 0; j < hybrid_.start.size(); ++j) rate += hybrid_.A[row][j] * x[j];
    for (const auto& [r, course] : hybrid_.drives) rate += r == row ? value(course, t) : 0.0;
    for (std::size_t k = 0; k < hybrid_.laws.size(); ++k) {
      if (hybrid_.laws[k].row == row) rate -= signs_[k] * hybrid_.laws[k].size;
    }
    for (std::size_t k = 0; k < hybrid_.relays.size(); ++k) {
      if (hybrid_.relays[k].row == row) rate += hybrid_.relays[k].gain * x[hybrid_.start.size() + k];
    }
    return rate;
  }

  static bool near_corner(const Course& course, double t) {
    return std::any_of(course.times.begin(), course.times.end(), [&](double c) { return std::abs(c - t) < 1e-9; });
  }

  const Hybrid& hybrid_;
  std::vector<int> signs_;
  std::vector<bool> held_;
};

/// Runge-Kutta steps of one length from row to row, halved until two lengths agree.
std::string follow(const Stretch& stretch, double t, double t_next, const State& x, const State& x_next, double rtol) {
  const double size = std::max(size_of(x), size_of(x_next));
  const double tolerance = (10.0 * rtol + 1e-9) * size;
  State before;
  for (int steps = 1; steps <= 4096; steps *= 2) {
    const double h = (t_next - t) / steps;
    State y = x;
    std::string problem;
    for (int step = 0; step < steps; ++step) {
      // Ends of the stretch belong to it: a course may have a corner there.
      const double shift = 1e-9 * (t_next - t);
      const double now = t + step * h, first = step == 0 ? now + shift : now,
                   last = now + h - (step + 1 == steps ? shift : 0.0);
      const State k1 = stretch.rates(first, y), k2 = stretch.rates(now + 0.5 * h, moved(y, 0.5 * h, k1));
      const State k3 = stretch.rates(now + 0.5 * h, moved(y, 0.5 * h, k2)), k4 = stretch.rates(last, moved(y, h, k3));
      if (problem.empty() && step > 0) {
        problem = stretch.point(now, y, 10.0 * tolerance);
        if (!problem.empty()) problem += fmt::format(" at t = {}", now);
      }
      for (std::size_t i = 0; i < y.size(); ++i) y[i] += h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]);
    }
    if (!before.empty() && distance(before, y) <= 0.01 * tolerance) {
      if (!problem.empty()) return problem;
      const double error = distance(y, x_next);
      return error <= tolerance ? ""
                                : fmt::format("the next row (t = {}) is {} off, that is {} rtol", t_next, error,
                                              error / (size * rtol));
    }
    before = std::move(y);
  }
  return "fixed steps do not converge";
}

/// The resets that an event says it has executed, one after the other, from the state before it.
std::string jumps_of(const Hybrid& hybrid, const Event& event, Firings& firings) {
  State x = event.x;
  const double near = 1e-9 * size_of(x);
  const Stretch none(hybrid, std::vector<int>(hybrid.laws.size()), x, x);
  for (const auto& full_name : event.surfaces) {
    const auto digit = full_name.find_first_of("0123456789");
    const std::string kind = full_name.substr(0, digit);
    const auto k = static_cast<std::size_t>(std::stoul(full_name.substr(digit)));
    if (kind == "wall") {
      const Wall& wall = hybrid.walls[k];
      if (!(std::abs(x[wall.position] - wall.place) <= near)) return "hits a wall away from it";
      if (!(wall.side * x[wall.velocity] <= near)) return "hits a wall from behind";
      // What turns around within the rounding of the place, v^2 / (2 a) < 2e-16 for a up to 20 and v behind the impact,
      // may stay at rest.
      const double behind = -wall.restitution * x[wall.velocity];
      const bool rests = std::abs(behind) <= 1e-7 && std::abs(event.x_after[wall.velocity]) <= 1e-12;
      x[wall.velocity] = rests ? 0.0 : behind;
    } else if (kind == "threshold") {
      const Threshold& threshold = hybrid.thresholds[k];
      if (auto problem = firings.fire(k); !problem.empty()) return problem;
      for (std::size_t i = 0; i < threshold.reset.size(); ++i) x[i] += threshold.reset[i];
      firings.see(x);
    } else {
      const Relay& relay = hybrid.relays[k];
      const double beyond = kind == "high" ? none.y(k, x) - relay.high : relay.low - none.y(k, x);
      if (!(beyond >= -3.0 * near)) return "a relay switches before its threshold";
      x[hybrid.start.size() + k] = kind == "high" ? -1.0 : 1.0;
    }
  }
  if (!(distance(x, event.x_after) <= 1e-12 * size_of(x))) {
    return fmt::format("its resets lead {} away from the state behind it", distance(x, event.x_after));
  }
  return "";
}

std::vector<int> signs_of(const Hybrid& hybrid, const Result& result, std::size_t row) {
  std::vector<int> signs(hybrid.laws.size());
  for (std::size_t column = 0; column < result.switching_functions.size(); ++column) {
    const std::string& column_name = result.switching_functions[column];
    signs[static_cast<std::size_t>(std::stoul(column_name.substr(1)))] = result.trajectory.mode[row][column];
  }
  return signs;
}

/// What the state may move by at a time: rounding, or where jumps have their limit what their last cycle, which is
/// extrapolated, leaves of velocities, and what it moves by at these rates in the time that is left: cycles that shrink
/// by 0.95, the largest restitution, leave 19 times the last one.
double limit_moves(const Result& result, double t, const State& x, const State& rates) {
  double last = t, before = t, moves = 1e-13 * size_of(x);
  for (const Event& event : result.events) {
    if (event.kind == EventKind::accumulation && event.t == t)
      moves = 1e-6 + 20.0 * (last - before) * std::max(size_of(x), size_of(rates));
    if (event.kind != EventKind::jump || event.t == last) continue;
    before = last;
    last = event.t;
  }
  return moves;
}

}  // namespace

std::string complaint(const Hybrid& hybrid, const Result& result, double rtol) {
  using result::Termination;
  const bool completed = result.status.termination == Termination::completed;
  if (!completed && (result.status.termination != Termination::outside_class || result.status.message.empty())) {
    return fmt::format("{}: {}", result::name(result.status.termination), result.status.message);
  }
  if (result.switching_functions.size() != hybrid.laws.size()) return "not one column for each law";
  const auto& rows = result.trajectory;
  Firings firings(hybrid);
  double jumps_at = -1.0;
  for (std::size_t i = 0; i < result.events.size(); ++i) {
    const Event& event = result.events[i];
    if (event.kind != EventKind::jump) continue;
    if (event.t != jumps_at) firings.begin(event.x);
    jumps_at = event.t;
    auto problem = jumps_of(hybrid, event, firings);
    const bool last = i + 1 == result.events.size() || result.events[i + 1].t != event.t;
    if (problem.empty() && last) problem = firings.end();
    if (!problem.empty()) {
      return fmt::format("the event at t = {:.17g} ({}): {}", event.t, fmt::join(event.surfaces, ", "), problem);
    }
  }
  const auto event_at = [&](double t, auto&& is_wanted) {
    return std::any_of(result.events.begin(), result.events.end(),
                       [&](const Event& event) { return event.t == t && is_wanted(event); });
  };
  const auto is_limit = [](const Event& event) { return event.kind == EventKind::accumulation; };
  const auto is_jump = [](const Event& event) { return event.kind == EventKind::jump; };
  for (std::size_t i = 0; i + 1 < rows.t.size(); ++i) {
    const auto where = [&](const std::string& problem) {
      return fmt::format("row {} (t = {:.17g}, mode [{}]): {}", i, rows.t[i], fmt::join(rows.mode[i], " "), problem);
    };
    const bool same_time = rows.t[i + 1] == rows.t[i];
    const double moves = distance(rows.x[i], rows.x[i + 1]);
    if (same_time || event_at(rows.t[i + 1], is_limit)) {
      const Stretch stretch(hybrid, signs_of(hybrid, result, i), rows.x[i], rows.x[i + 1]);
      const double may_move = limit_moves(result, rows.t[i + 1], rows.x[i], stretch.rates(rows.t[i], rows.x[i]));
      if (moves > may_move && !event_at(rows.t[i + 1], is_jump))
        return where(fmt::format("moves by {} at once", moves));
      continue;
    }
    if (!(rows.t[i + 1] > rows.t[i])) return where("the next row is not later");
    // Two events within the last digits of t.
    if (rows.t[i + 1] - rows.t[i] <= 1e-13 * (1.0 + rows.t[i]) && moves <= 1e-12 * size_of(rows.x[i])) continue;
    const Stretch stretch(hybrid, signs_of(hybrid, result, i), rows.x[i], rows.x[i + 1]);
    if (const auto problem = stretch.point(rows.t[i], rows.x[i], 1e-10 * size_of(rows.x[i])); !problem.empty()) {
      return where(problem);
    }
    const auto problem = follow(stretch, rows.t[i], rows.t[i + 1], rows.x[i], rows.x[i + 1], rtol);
    if (!problem.empty()) return where(problem);
  }
  if (completed && rows.t.back() != result.final.t) return "the last row is not the end";
  return "";
}

}  // namespace saltus::robustness
