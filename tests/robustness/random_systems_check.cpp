#include "random_systems_check.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "random_systems_field.hpp"
#include "states.hpp"
#include "unresolved_events.hpp"

namespace saltus::robustness {
namespace {

using result::Event;
using result::Result;

/// One mode's checks at points and over stretches.
class ModeCheck {
 public:
  ModeCheck(const RandomSystem& system, const std::vector<bool>& listed, const result::Mode& mode, double rtol)
      : listed_(listed), mode_(mode), field_(system, mode_), rtol_(rtol) {}

  /// A row of the result: on its surfaces to rounding, with the selections of its own field.
  [[nodiscard]] std::string row(double t, const State& x, const State& alpha) const {
    if (has_null(alpha)) return undetermined(t, x);
    const FieldValue value = field_(t, x, alpha);
    const bool at_kink = slides_at_kink(t, x, alpha);
    for (std::size_t j = 0; j < mode_.size(); ++j) {
      if (!listed_[j]) continue;
      if (mode_[j] == 0 && !(std::abs(value.psi[j]) <= 1e-12 * size_of(x))) {
        return fmt::format("slides on s{} with psi = {}", j, value.psi[j]);
      }
      if (!(alpha[j] >= -1e-9 && alpha[j] <= 1.0 + 1e-9)) return fmt::format("selection {} of s{}", alpha[j], j);
      if (mode_[j] != 0 && !field_.is_read_anew(j) && alpha[j] != (mode_[j] > 0 ? 1.0 : 0.0)) {
        return fmt::format("selection {} of s{} in mode {}", alpha[j], j, mode_[j]);
      }
    }
    if (!at_kink && !(value.imbalance <= 1e-9)) {
      return fmt::format("the selections leave d psi/dt = {} of the fields", value.imbalance);
    }
    return at_kink ? "" : inequalities(x, value, 1e-12);
  }

  /// From one row to the next by Runge-Kutta steps of one length, halved until two lengths agree.
  [[nodiscard]] std::string stretch(double t, double t_next, const State& x, const State& x_next,
                                    const State& alpha) const {
    if (slides_at_kink(t, x, alpha) || slides_at_kink(t_next, x_next, alpha)) return "";
    const double size = std::max(size_of(x), size_of(x_next));
    // The engine keeps its error of a step to a tenth of rtol, by an estimate.
    const double tolerance = (10.0 * rtol_ + 1e-9) * size;
    constexpr int most_steps = 4096;
    Path path = follow(t, t_next, x, alpha, 1);
    for (int steps = 2; steps <= most_steps; steps *= 2) {
      const Path finer = follow(t, t_next, x, alpha, steps);
      const State coarse = path.end;
      const double change = distance(coarse, finer.end);
      path = finer;
      if (!path.is_defined) return path.problem;
      if (!(change <= 0.5 * tolerance)) continue;
      // Order 4: a fifteenth of the difference is left.
      for (std::size_t i = 0; i < coarse.size(); ++i) path.end[i] += (path.end[i] - coarse[i]) / 15.0;
      if (!path.problem.empty()) return path.problem;
      const double error = distance(path.end, x_next);
      if (error <= tolerance) return "";
      // Two lengths may agree by chance. A complaint needs to be sure.
      if (!(change <= 0.01 * tolerance) && 2 * steps <= most_steps) continue;
      return fmt::format("the next row (t = {}) is {} off, that is {} rtol", t_next, error, error / (size * rtol_));
    }
    return path.is_determined ? "fixed steps do not converge" : "";
  }

 private:
  [[nodiscard]] bool has_null(const State& alpha) const {
    const auto& sliding = field_.sliding();
    return sliding.size() > 1 &&
           std::any_of(sliding.begin(), sliding.end(), [&](std::size_t j) { return std::isnan(alpha[j]); });
  }

  /// Selections are null: some balance the fields, and these are not the only ones (G is singular). Stretches of such
  /// rows are not followed.
  [[nodiscard]] std::string undetermined(double t, const State& x) const {
    const State found = field_(t, x, State(mode_.size(), 0.5)).alpha;
    const FieldValue value = field_(t, x, found);
    if (!(value.imbalance <= 1e-9))
      return fmt::format("null selections where {} is left of the fields", value.imbalance);
    if (!(value.pivot <= 1e-9)) return fmt::format("null selections that are determined (pivot {})", value.pivot);
    for (const auto j : field_.sliding()) {
      if (!(std::abs(value.psi[j]) <= 1e-12 * size_of(x))) return fmt::format("slides on s{} with {}", j, value.psi[j]);
      if (!(found[j] >= -1e-9 && found[j] <= 1.0 + 1e-9)) return fmt::format("null selection {} of s{}", found[j], j);
    }
    return inequalities(x, value, 1e-12);
  }

  struct Path {
    State end;
    std::string problem;  ///< an inequality that fails on the way
    bool is_determined = true;
    /// The selection is not 0/0, nor that of a kink that is touched, nor a double root: what derivatives of psi hold
    /// cannot be followed here.
    bool is_defined = true;
  };

  /// Classical Runge-Kutta steps of one length; inequalities are looked at where they begin.
  [[nodiscard]] Path follow(double t, double t_next, const State& x, State alpha, int steps) const {
    const double h = (t_next - t) / steps;
    // Where the path is not exact yet, an inequality may fail by its error.
    const double slack = 10.0 * rtol_;
    Path path{x, ""};
    State& y = path.end;
    for (int step = 0; step < steps; ++step) {
      const double now = t + step * h;
      const FieldValue k1 = field_(now, y, alpha);
      path.is_determined = path.is_determined && determined(k1);
      path.is_defined = std::isfinite(k1.xdot.front()) && !slides_at_kink(k1) && !at_double_root(k1);
      if (!path.is_defined) return path;
      alpha = k1.alpha;
      const FieldValue k2 = field_(now + 0.5 * h, moved(y, 0.5 * h, k1.xdot), alpha);
      const FieldValue k3 = field_(now + 0.5 * h, moved(y, 0.5 * h, k2.xdot), alpha);
      const FieldValue k4 = field_(now + h, moved(y, h, k3.xdot), alpha);
      if (path.problem.empty()) {
        path.problem = inequalities(y, k1, slack);
        if (!path.problem.empty()) path.problem += fmt::format(" at t = {}", now);
      }
      for (std::size_t i = 0; i < y.size(); ++i) {
        y[i] += h / 6.0 * (k1.xdot[i] + 2.0 * (k2.xdot[i] + k3.xdot[i]) + k4.xdot[i]);
      }
    }
    return path;
  }

  /// At a kink of psi the sliding selection jumps: which side counts there is a matter of rounding.
  [[nodiscard]] bool slides_at_kink(double t, const State& x, const State& alpha) const {
    return !field_.sliding().empty() && slides_at_kink(field_(t, x, alpha));
  }
  [[nodiscard]] bool slides_at_kink(const FieldValue& value) const {
    return !field_.sliding().empty() && value.kink_distance < 1e-5;
  }

  /// Where two roots meet they are known to the square root of rounding, 1e-8, and Newton's method may lead anywhere.
  [[nodiscard]] bool at_double_root(const FieldValue& value) const {
    return field_.sliding().size() > 1 && value.pivot < 1e-7;
  }

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
      // Where two roots meet det G is 0 to the square root of rounding; where a gradient vanishes its sign means
      // nothing.
      if (!(value.determinant >= -1e-6) && value.pivot > bound)
        return fmt::format("slides where det(-G) is {}", value.determinant);
      if (at_double_root(value)) return "";
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
  const result::Mode mode_;
  OwnField field_;
  double rtol_;
};

std::string text(const result::Mode& mode) { return fmt::format("[{}]", fmt::join(mode, " ")); }

bool same_state(const State& a, const State& b, double tolerance) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!(std::abs(a[i] - b[i]) <= tolerance * size_of(a))) return false;
  }
  return true;
}

/// The same state to the rounding that projection onto a new sliding surface leaves.
bool same_state(const State& a, const State& b) { return same_state(a, b, 1e-13); }

/// A result with its events as a list: those of a result are made one by one.
struct ListedResult {
  explicit ListedResult(const Result& result)
      : whole(result), events(result.events), trajectory(result.trajectory), status(result.status) {}

  const Result& whole;
  const std::vector<Event> events;
  const result::Trajectory& trajectory;
  const result::Status& status;
};

/// Rows at an event's time: one with the mode before and one with the mode after it, both with its state.
std::string rows_of(const Event& event, const ListedResult& result) {
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

std::string surfaces_of(const Event& event, const ListedResult& result, const std::vector<bool>& listed) {
  if (!event.mode_before) return "";
  for (std::size_t j = 0; j < listed.size(); ++j) {
    const auto& names = event.surfaces;
    const bool named = std::find(names.begin(), names.end(), result.whole.switching_functions[j]) != names.end();
    const bool changes = listed[j] && (*event.mode_before)[j] != (*event.mode_after)[j];
    if (named != changes) return fmt::format("the event at t = {} is not about s{}", event.t, j);
  }
  return "";
}

/// Where a surface is met tangentially its cycles are resolved to the square root of rounding: a run may go on from the
/// limit of what it has seen this long before it.
constexpr double before_limit = 1e-5;

bool same_change(const Event& a, const Event& b) {
  return a.mode_before == b.mode_before && a.mode_after == b.mode_after;
}

/// What the last two cycles leave to their limit, as far as they shrink geometrically.
struct Remaining {
  double t = 0.0;
  double x = 0.0;  ///< the largest component
};

/// Between the last event before limit number k and the limit; 0 if the limit is elsewhere than where the cycles lead.
/// A surface that is met tangentially at the limit ends the cycles of a slow sequence long before it.
Remaining remaining_before(const std::vector<Event>& events, std::size_t k) {
  std::vector<const Event*> last;
  for (std::size_t i = k; i-- > 0 && last.size() < 3;) {
    if (same_change(events[i], events[k - 1])) last.push_back(&events[i]);
  }
  if (last.size() < 3) return {};
  const double cycle = last[0]->t - last[1]->t;
  const double ratio = cycle / (last[1]->t - last[2]->t);
  if (!(ratio < 1.0)) return {};
  const double cycles = ratio / (1.0 - ratio);
  const double stretch = events[k].t - last[0]->t;
  if (!(std::abs(stretch - cycle * cycles) <= 0.05 * cycle * cycles)) return {};
  return {stretch, distance(last[0]->x, last[1]->x) * cycles};
}

/// The limit of a sequence of switches at t, where they do follow each other faster than any bound.
bool has_limit(const ListedResult& result, double t) {
  return std::any_of(result.events.begin(), result.events.end(),
                     [&](const Event& event) { return event.kind == result::EventKind::accumulation && event.t == t; });
}

/// The same near t, or behind it by what has been extrapolated.
bool is_near_limit(const ListedResult& result, double t) {
  for (std::size_t k = 1; k < result.events.size(); ++k) {
    if (result.events[k].kind != result::EventKind::accumulation) continue;
    const double after = result.events[k].t - t;
    if (std::abs(after) <= before_limit) return true;
    if (after > 0.0 && after <= remaining_before(result.events, k).t) return true;
  }
  return false;
}

/// The first cycle of a solution that spirals out of an intersection is passed in one step, from its closed form.
bool begins_to_spiral(const ListedResult& result, double t) {
  const auto& events = result.events;
  const auto first =
      std::lower_bound(events.begin(), events.end(), t, [](const Event& e, double at) { return e.t < at; });
  for (auto event = first; event != events.end() && event->t == t; ++event) {
    if (event->reason.find("spirals out") != std::string::npos) return true;
  }
  return false;
}

/// Whether the switches of a surface at t are part of an accumulation that the run passes, or in which it ends. One
/// whose cycles shrink fast is over where two surfaces are met together: sliding on both.
bool in_accumulation(const ListedResult& result, double t, std::size_t surface) {
  if (is_near_limit(result, t)) return true;
  const auto ends_it = [&](const Event& event) {
    if (!event.mode_after || event.t < t || event.t - t > 1e-9 || (*event.mode_after)[surface] != 0) return false;
    return std::count(event.mode_after->begin(), event.mode_after->end(), 0) > 1;
  };
  if (std::any_of(result.events.begin(), result.events.end(), ends_it)) return true;
  return result.status.termination == result::Termination::outside_class &&
         result.status.message.starts_with("switches accumulate") && result.status.time_reached - t < 1e-6;
}

/// Whether events i < k that follow each other are those of cycles that shrink: the same two changes have followed each
/// other twice before, each time in less time. A stretch of sliding that ends where a second surface is met shrinks
/// like the square of its cycle, so that it is this short long before the limit.
bool shrinks_from_cycle_to_cycle(const std::vector<Event>& events, std::size_t i, std::size_t k) {
  double shorter = events[k].t - events[i].t;
  int cycles = 0;
  for (std::size_t first = i; first-- > 0 && cycles < 2;) {
    const std::size_t second = first + (k - i);
    if (!same_change(events[first], events[i]) || !same_change(events[second], events[k])) continue;
    const double duration = events[second].t - events[first].t;
    // Four times, each known to the two units of t to which events are located (Locator::time_resolution): what t does
    // not resolve cannot shrink any more.
    constexpr double resolution = 2.0 * std::numeric_limits<double>::epsilon();
    if (!(duration > shorter - 4.0 * resolution * events[k].t)) return false;
    shorter = duration;
    ++cycles;
  }
  return cycles == 2;
}

/// The same change of the same surfaces twice at one time. A limit is not one of the switches that it is the limit of.
std::string repetition(const std::vector<Event>& events, std::size_t i) {
  for (std::size_t k = i; k-- > 0 && events[k].t == events[i].t;) {
    if (same_change(events[k], events[i]) && events[k].kind != result::EventKind::accumulation) {
      return fmt::format("the event at t = {} is found twice", events[i].t);
    }
  }
  return "";
}

std::string events_of(const RandomSystem& system, const ListedResult& result, const std::vector<bool>& listed) {
  const auto& events = result.events;
  std::vector<std::optional<std::size_t>> last(listed.size());
  for (std::size_t i = 0; i < events.size(); ++i) {
    const Event& event = events[i];
    if (auto problem = rows_of(event, result); !problem.empty()) return problem;
    if (auto problem = surfaces_of(event, result, listed); !problem.empty()) return problem;
    if (auto problem = repetition(events, i); !problem.empty()) return problem;
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
      if (last[j] && event.t - events[*last[j]].t < 1e-9 && !in_accumulation(result, event.t, j) &&
          !shrinks_from_cycle_to_cycle(events, *last[j], i) &&
          !is_unresolved(system, listed, result.whole, *last[j], i)) {
        const bool back = *events[*last[j]].mode_before == *event.mode_after;
        return fmt::format("s{} changes {} at t = {}", j, back ? "there and back" : "twice", event.t);
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

/// What the state may move by at a time: nothing, or from the last computed cycle to the limit that is extrapolated.
double step_at(const ListedResult& result, double t) {
  double step = 1e-13;
  for (std::size_t k = 1; k < result.events.size(); ++k) {
    if (result.events[k].kind != result::EventKind::accumulation || result.events[k].t != t) continue;
    step = std::max(1e-6, 1.05 * remaining_before(result.events, k).x);
  }
  return step;
}

std::string trajectory_of(const RandomSystem& system, const std::vector<bool>& listed, const ListedResult& result,
                          double rtol) {
  const auto& rows = result.trajectory;
  // Once for all rows: there may be a hundred thousand events.
  const bool any_limit = std::any_of(result.events.begin(), result.events.end(),
                                     [](const Event& event) { return event.kind == result::EventKind::accumulation; });
  for (std::size_t i = 0; i < rows.t.size(); ++i) {
    const bool last = i + 1 == rows.t.size();
    // Behind a stop the last row may stand where no mode goes on.
    if (last && result.status.termination != result::Termination::completed) break;
    const ModeCheck check(system, listed, rows.mode[i], rtol);
    // The last cycles before a limit are smaller than what the tolerances leave of psi.
    const bool behind_limit = any_limit && has_limit(result, rows.t[i]) && (last || rows.t[i + 1] > rows.t[i]);
    const bool in_last_cycles = any_limit && is_near_limit(result, rows.t[i]) && !behind_limit;
    std::string problem = in_last_cycles ? "" : check.row(rows.t[i], rows.x[i], rows.alpha[i]);
    if (problem.empty() && !last) {
      const bool later = rows.t[i + 1] > rows.t[i];
      if (later && in_last_cycles && has_limit(result, rows.t[i + 1])) {
        // What is left of the cycles is extrapolated: no single mode leads there.
        if (!same_state(rows.x[i], rows.x[i + 1], 1e-5)) problem = "the limit is far from the last cycle";
      } else if (later && begins_to_spiral(result, rows.t[i])) {
        // All four modes of the cycle: the fields are constant to a millionth over it.
        if (!same_state(rows.x[i], rows.x[i + 1], 1e-5)) problem = "the first cycle of a spiral is long";
      } else if (later) {
        if (!same_where_listed(rows.mode[i], rows.mode[i + 1], listed)) problem = "the mode changes between rows";
        if (problem.empty()) {
          problem = check.stretch(rows.t[i], rows.t[i + 1], rows.x[i], rows.x[i + 1], rows.alpha[i]);
        }
      } else if (rows.t[i + 1] < rows.t[i] ||
                 !same_state(rows.x[i], rows.x[i + 1], any_limit ? step_at(result, rows.t[i]) : 1e-13)) {
        problem = "the next row is not later, or jumps";
      }
    }
    if (!problem.empty()) {
      return fmt::format("row {} (t = {:.17g}, mode {}): {}", i, rows.t[i], text(rows.mode[i]), problem);
    }
  }
  return "";
}

/// Whether a run has ended with max_events in cycles that shrink like a power of their number, each of the same
/// changes, and says so: that many events are its solution. With intervals like k^-p a quarter of the events takes less
/// time than the one before, by (3/4)^p or so for the last two; p is 1/4 or more, or nobody speaks of cycles that
/// shrink.
bool ends_in_shrinking_cycles(const Result& result) {
  if (result.status.termination != result::Termination::iteration_limit) return false;
  if (result.status.message.find("shrink like the power") == std::string::npos) return false;
  const std::vector<Event> events = result.events;
  const std::size_t quarter = events.size() / 4;
  const auto taken = [&](std::size_t last) { return events[last].t - events[last - quarter].t; };
  const std::size_t end = events.size() - 1;
  const auto repeats = [&](std::size_t cycle) {
    for (std::size_t k = events.size() - quarter; k <= end; ++k) {
      if (!same_change(events[k], events[k - cycle])) return false;
    }
    return true;
  };
  constexpr std::size_t cycles[] = {1, 2, 3, 4, 5, 6, 7, 8};
  return std::any_of(std::begin(cycles), std::end(cycles), repeats) && taken(end) < 0.95 * taken(end - quarter) &&
         taken(end - quarter) < 0.95 * taken(end - 2 * quarter);
}

}  // namespace

std::string complaint(const RandomSystem& system, const std::vector<bool>& listed, const Result& result, double rtol) {
  using result::Termination;
  const bool accepted = result.status.termination == Termination::completed ||
                        (result.status.termination == Termination::outside_class && !result.status.message.empty()) ||
                        ends_in_shrinking_cycles(result);
  if (!accepted) return fmt::format("{}: {}", result::name(result.status.termination), result.status.message);
  if (result.status.termination == Termination::completed && result.trajectory.t.back() != result.final.t) {
    return "the last row is not the end";
  }
  const ListedResult run(result);
  if (auto problem = events_of(system, run, listed); !problem.empty()) return problem;
  return trajectory_of(system, listed, run, rtol);
}

}  // namespace saltus::robustness
