#include "random_systems_check.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "random_systems_field.hpp"

namespace saltus::robustness {
namespace {

using result::Event;
using result::Result;
using State = std::vector<double>;

double size_of(const State& x) {
  double size = 1.0;
  for (const double value : x) size = std::max(size, std::abs(value));
  return size;
}

State moved(const State& x, double h, const State& slope) {
  State y = x;
  for (std::size_t i = 0; i < y.size(); ++i) y[i] += h * slope[i];
  return y;
}

/// One mode's checks at points and over stretches.
class ModeCheck {
 public:
  ModeCheck(const RandomSystem& system, const std::vector<bool>& listed, const result::Mode& mode, double rtol)
      : listed_(listed), mode_(mode), field_(system, mode), rtol_(rtol) {}

  /// A row of the result: on its surfaces to rounding, with the selections of its own field.
  [[nodiscard]] std::string row(double t, const State& x, const State& alpha) const {
    const FieldValue value = field_(t, x, alpha);
    for (std::size_t j = 0; j < mode_.size(); ++j) {
      if (!listed_[j]) continue;
      if (mode_[j] == 0 && !(std::abs(value.psi[j]) <= 1e-12 * size_of(x))) {
        return fmt::format("slides on s{} with psi = {}", j, value.psi[j]);
      }
      if (!(alpha[j] >= -1e-9 && alpha[j] <= 1.0 + 1e-9)) return fmt::format("selection {} of s{}", alpha[j], j);
      if (mode_[j] != 0 && !field_.is_read_anew(j) && alpha[j] != (mode_[j] > 0 ? 1.0 : 0.0)) {
        return fmt::format("selection {} of s{} in mode {}", alpha[j], j, mode_[j]);
      }
      const double conditioning = field_.sliding().size() == 1 ? value.below - value.above : value.pivot;
      if (mode_[j] == 0 && std::abs(conditioning) > 1e-3 && !(std::abs(alpha[j] - value.alpha[j]) <= 1e-9)) {
        return fmt::format("selection {} of s{}, should be {}", alpha[j], j, value.alpha[j]);
      }
    }
    return inequalities(x, value, 1e-12);
  }

  /// From one row to the next by fixed steps of at most 0.02.
  [[nodiscard]] std::string stretch(double t, double t_next, State x, const State& x_next, State alpha) const {
    const double size = std::max(size_of(x), size_of(x_next));
    // The engine's error of a step, and ours: (0.02 L)^5 / 120 of the state per step with L up to 4.
    const double tolerance = 100.0 * rtol_ * size + 1e-7 * size;
    const int steps = 1 + static_cast<int>((t_next - t) / 0.02);
    const double h = (t_next - t) / steps;
    bool near_kink = false;
    for (int step = 0; step < steps; ++step) {
      const double now = t + step * h;
      const FieldValue k1 = field_(now, x, alpha);
      alpha = k1.alpha;
      const FieldValue k2 = field_(now + 0.5 * h, moved(x, 0.5 * h, k1.xdot), alpha);
      const FieldValue k3 = field_(now + 0.5 * h, moved(x, 0.5 * h, k2.xdot), alpha);
      const FieldValue k4 = field_(now + h, moved(x, h, k3.xdot), alpha);
      near_kink = near_kink || std::min(k1.kink_distance, k4.kink_distance) < 1e-6;
      if (!determined(k1)) return "";
      if (auto text = inequalities(x, k1, tolerance); !text.empty()) return fmt::format("at t = {}: {}", now, text);
      for (std::size_t i = 0; i < x.size(); ++i) {
        x[i] += h / 6.0 * (k1.xdot[i] + 2.0 * (k2.xdot[i] + k3.xdot[i]) + k4.xdot[i]);
      }
    }
    // At a kink of psi the sliding selection jumps: which side the first stage takes is a matter of rounding.
    if (near_kink && !field_.sliding().empty()) return "";
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (!(std::abs(x[i] - x_next[i]) <= tolerance)) {
        return fmt::format("x{} = {} at t = {}, fixed steps give {}", i, x_next[i], t_next, x[i]);
      }
    }
    return "";
  }

 private:
  /// The sliding field is a quotient: near 0/0 it cannot be computed twice with the same result.
  [[nodiscard]] bool determined(const FieldValue& value) const {
    if (field_.sliding().empty()) return true;
    return field_.sliding().size() == 1 ? std::abs(value.below - value.above) > 1e-3 : value.pivot > 1e-3;
  }

  [[nodiscard]] std::string inequalities(const State& x, const FieldValue& value, double tolerance) const {
    const double bound = 10.0 * tolerance * size_of(x);  // |grad psi| up to 3
    for (std::size_t j = 0; j < mode_.size(); ++j) {
      if (!listed_[j] || field_.is_read_anew(j)) continue;
      if (!(mode_[j] * value.psi[j] >= -bound)) return fmt::format("s{} = {} in mode {}", j, value.psi[j], mode_[j]);
    }
    if (field_.sliding().size() == 1) {
      const double speed = std::max(bound, 1e-9) * (1.0 + std::abs(value.below) + std::abs(value.above));
      if (!(value.below >= -speed && value.above <= speed)) {
        return fmt::format("slides on s{} with fields {} below and {} above", field_.sliding().front(), value.below,
                           value.above);
      }
    } else {
      for (const auto j : field_.sliding()) {
        const double slack = std::max(bound, 1e-9) / std::max(1e-12, value.pivot);
        if (!(value.alpha[j] >= -slack && value.alpha[j] <= 1.0 + slack)) {
          return fmt::format("slides on s{} with the selection {}", j, value.alpha[j]);
        }
      }
    }
    return "";
  }

  const std::vector<bool>& listed_;
  const result::Mode& mode_;
  OwnField field_;
  double rtol_;
};

std::string text(const result::Mode& mode) { return fmt::format("[{}]", fmt::join(mode, " ")); }

/// The same state to the rounding that projection onto a new sliding surface leaves.
bool same_state(const State& a, const State& b) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!(std::abs(a[i] - b[i]) <= 1e-13 * size_of(a))) return false;
  }
  return true;
}

/// Rows at an event's time: one with the mode before and one with the mode after it, both with its state.
std::string rows_of(const Event& event, const Result& result) {
  const auto& rows = result.trajectory;
  bool before = !event.mode_before;
  bool after = false;
  auto row = std::lower_bound(rows.t.begin(), rows.t.end(), event.t);
  for (; row != rows.t.end() && *row == event.t; ++row) {
    const auto i = static_cast<std::size_t>(row - rows.t.begin());
    before = before || (rows.mode[i] == *event.mode_before && same_state(rows.x[i], event.x));
    after = after || (event.mode_after && rows.mode[i] == *event.mode_after && same_state(rows.x[i], event.x_after));
  }
  return before && after ? "" : fmt::format("the event at t = {} has no rows of its modes", event.t);
}

std::string surfaces_of(const Event& event, const Result& result, const std::vector<bool>& listed) {
  if (!event.mode_before) return "";
  for (std::size_t j = 0; j < listed.size(); ++j) {
    const auto& names = event.surfaces;
    const bool named = std::find(names.begin(), names.end(), result.switching_functions[j]) != names.end();
    const bool changes = listed[j] && (*event.mode_before)[j] != (*event.mode_after)[j];
    if (named != changes) return fmt::format("the event at t = {} is not about s{}", event.t, j);
  }
  return "";
}

std::string events_of(const Result& result, const std::vector<bool>& listed) {
  const auto& events = result.events;
  std::vector<std::optional<std::size_t>> last(listed.size());
  for (std::size_t i = 0; i < events.size(); ++i) {
    const Event& event = events[i];
    if (auto problem = rows_of(event, result); !problem.empty()) return problem;
    if (auto problem = surfaces_of(event, result, listed); !problem.empty()) return problem;
    if (!event.mode_before) continue;
    for (std::size_t j = 0; j < listed.size(); ++j) {
      if (!listed[j]) continue;
      const int from = (*event.mode_before)[j];
      const int to = (*event.mode_after)[j];
      if (i > 0 && (*events[i - 1].mode_after)[j] != from) {
        return fmt::format("s{} changes from {} to {} between the events at t = {} and {}", j,
                           (*events[i - 1].mode_after)[j], from, events[i - 1].t, event.t);
      }
      if (from == to) continue;
      if (last[j] && event.t - events[*last[j]].t < 1e-9) {
        const Event& other = events[*last[j]];
        const bool same = (*other.mode_before)[j] == from && (*other.mode_after)[j] == to;
        if (same) return fmt::format("s{} changes from {} to {} twice at t = {}", j, from, to, event.t);
        if ((*other.mode_before)[j] == to) return fmt::format("s{} changes there and back at t = {}", j, event.t);
      }
      last[j] = i;
    }
  }
  return "";
}

bool same_where_listed(const result::Mode& a, const result::Mode& b, const std::vector<bool>& listed) {
  for (std::size_t j = 0; j < listed.size(); ++j) {
    if (listed[j] && a[j] != b[j]) return false;
  }
  return true;
}

std::string trajectory_of(const RandomSystem& system, const std::vector<bool>& listed, const Result& result,
                          double rtol) {
  const auto& rows = result.trajectory;
  for (std::size_t i = 0; i < rows.t.size(); ++i) {
    const bool last = i + 1 == rows.t.size();
    // Behind a stop the last row may stand where no mode goes on.
    if (last && result.status.termination != result::Termination::completed) break;
    const ModeCheck check(system, listed, rows.mode[i], rtol);
    std::string problem = check.row(rows.t[i], rows.x[i], rows.alpha[i]);
    if (problem.empty() && !last) {
      if (rows.t[i + 1] > rows.t[i]) {
        if (!same_where_listed(rows.mode[i], rows.mode[i + 1], listed)) problem = "the mode changes between rows";
        if (problem.empty()) {
          problem = check.stretch(rows.t[i], rows.t[i + 1], rows.x[i], rows.x[i + 1], rows.alpha[i]);
        }
      } else if (rows.t[i + 1] < rows.t[i] || !same_state(rows.x[i], rows.x[i + 1])) {
        problem = "the next row is not later, or jumps";
      }
    }
    if (!problem.empty()) {
      return fmt::format("row {} (t = {:.17g}, mode {}): {}", i, rows.t[i], text(rows.mode[i]), problem);
    }
  }
  return "";
}

}  // namespace

std::string complaint(const RandomSystem& system, const std::vector<bool>& listed, const Result& result, double rtol) {
  using result::Termination;
  const bool accepted = result.status.termination == Termination::completed ||
                        (result.status.termination == Termination::outside_class && !result.status.message.empty());
  if (!accepted) return fmt::format("{}: {}", result::name(result.status.termination), result.status.message);
  if (result.status.termination == Termination::completed && result.trajectory.t.back() != result.final.t) {
    return "the last row is not the end";
  }
  if (auto problem = events_of(result, listed); !problem.empty()) return problem;
  return trajectory_of(system, listed, result, rtol);
}

}  // namespace saltus::robustness
