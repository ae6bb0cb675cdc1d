// Sequences of jumps, or of switches, with a limit: infinitely many in finite time (Zeno, spirals).
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <utility>
#include <vector>

namespace saltus::event_integrator {

/// The limit of a sequence of events: of jumps, or of switches.
struct SeriesLimit {
  double t = 0.0;
  std::vector<double> x;
  std::vector<int> events;  ///< numbers of those of one lap, ascending, each once
  double lap = 0.0;         ///< duration of the last one
  bool rattling = false;    ///< no laps: jumps in any order, faster than their guards are resolved
};

/// Watches the times and states of jumps (or of switches, which are numbered likewise) for laps whose durations shrink
/// geometrically. A lap is a cycle of jumps that repeats, of up to eight times.
///
/// With the duration T of the last lap and the ratio r < 1 of successive durations, T r / (1 - r) is what remains. The
/// limit is announced once that is below 1e-8 of the time that the sequence has taken, or can no longer be told apart
/// in t, and the extrapolations of the last laps agree. The state is extrapolated component by component (Aitken's
/// delta-squared process), which is exact for geometric sequences of any ratio.
class EventSeries {
 public:
  /// Jumps executed at t in this order, and the state behind them.
  void add(double t, std::vector<int> jumps, const std::vector<double>& x);
  /// @param shortest  by jump: laps not longer than this drown in the rounding of its guard; their sequence is
  ///                  extrapolated when it gets near, whatever remains. Jumps that follow each other faster than a
  ///                  hundredth of it, in any order, have their limit where they are.
  [[nodiscard]] std::optional<SeriesLimit> limit(const std::vector<double>& shortest) const;
  /// Where the last event is, if its lap was less than a hundredth of the one before and as much less again would be
  /// 1e-7 of the time taken: too few laps to believe in a limit, unless there is something else that says so.
  [[nodiscard]] std::optional<SeriesLimit> nearly() const;
  /// How long the shortest lap is that the last event closes; nullopt if none of its like is among the last eight.
  [[nodiscard]] std::optional<double> closed_lap() const;
  /// How long the last lap of a shrinking sequence was; nullopt outside of one.
  [[nodiscard]] std::optional<double> last_lap() const;
  /// Behind a limit, or where guards came to rest: laps start anew. Rattling is followed through such rests.
  void clear_laps();
  void clear();
  [[nodiscard]] bool empty() const { return entries_.empty(); }

 private:
  struct Entry {
    double t = 0.0;
    std::vector<int> jumps;
    std::vector<double> x;
  };
  static constexpr std::size_t longest_period = 8;
  [[nodiscard]] const Entry& back(std::size_t steps) const { return entries_[entries_.size() - 1 - steps]; }
  [[nodiscard]] std::optional<SeriesLimit> limit_of(std::size_t period, const std::vector<double>& shortest) const;
  [[nodiscard]] std::optional<SeriesLimit> end_of_rattling(const std::vector<double>& shortest) const;
  [[nodiscard]] std::vector<double> extrapolated(std::size_t period, double ratio) const;
  [[nodiscard]] std::vector<int> last_jumps(std::size_t entries) const;
  /// Durations of the laps behind the entry `skipped` laps ago, the last one first, as far as jumps repeat.
  [[nodiscard]] std::vector<double> durations(std::size_t period, std::size_t skipped) const;

  std::deque<Entry> entries_;
  std::deque<std::pair<double, std::vector<int>>> recent_;  ///< times and jumps of the last events, for rattling
  double start_[longest_period + 1] = {};                   ///< of the shrinking sequence of each period
  std::size_t laps_[longest_period + 1] = {};               ///< in it
};

}  // namespace saltus::event_integrator
