// Sequences of jumps, or of switches, with a limit: infinitely many in finite time (Zeno, spirals).
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <vector>

namespace saltus::event_integrator {

/// Says how the events of a sequence with a limit follow each other.
enum class SeriesKind {
  cycles,      ///< one and the same list of events again and again
  chattering,  ///< jumps in any order, faster than their guards are resolved
  unresolved   ///< functions that are zero together, as far as they are resolved
};

/// Holds the limit of a sequence of events: of jumps, or of switches.
struct SeriesLimit {
  double t = 0.0;
  std::vector<double> x;
  std::vector<int> events;  ///< numbers of those of one cycle, ascending, each once
  double cycle = 0.0;       ///< duration of the last one
  SeriesKind kind = SeriesKind::cycles;
};

/// Holds the last items of a sequence, at most `capacity`. The storage of those that are gone is used again.
template <class Item, std::size_t capacity>
class LastItems {
 public:
  static constexpr std::size_t first_items = 32;  ///< room for them is made at once: most sequences are shorter
  /// Returns a new last item; its members hold what an earlier one has left there.
  Item& append() {
    last_ = last_ + 1 == capacity ? 0 : last_ + 1;
    if (items_.empty()) items_.reserve(std::min(capacity, first_items));
    if (last_ == items_.size()) items_.emplace_back();
    size_ = std::min(size_ + 1, capacity);
    return items_[last_];
  }
  /// Returns the item `steps` before the last one, less than size().
  [[nodiscard]] const Item& back(std::size_t steps) const {
    return items_[steps <= last_ ? last_ - steps : last_ + capacity - steps];
  }
  [[nodiscard]] const Item& front() const { return back(size_ - 1); }
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] bool empty() const { return size_ == 0; }
  void clear() {
    size_ = 0;
    last_ = capacity - 1;
  }

 private:
  std::vector<Item> items_;
  std::size_t size_ = 0;
  std::size_t last_ = capacity - 1;
};

/// Watches the times and states of jumps (or of switches, which are numbered likewise) for cycles whose durations
/// shrink geometrically. A cycle is a list of at most eight jumps that repeats.
///
/// With the duration T of the last cycle and the ratio r < 1 of successive durations, T r / (1 - r) is what remains.
/// The limit is announced once the extrapolations of the last cycles agree and that is small. Small is 1e-8 of the time
/// that the sequence has taken, or what can no longer be told apart in t. The state is extrapolated component by
/// component (Aitken's delta-squared process), which is exact for geometric sequences of any ratio.
class EventSeries {
 public:
  /// Notes the jumps executed at t in this order, and the state behind them.
  void add(double t, const std::vector<int>& jumps, const std::vector<double>& x);
  /// Returns whether the last event has closed a cycle that was shorter than the one before: only then there may be a
  /// limit, but for chattering.
  [[nodiscard]] bool shrinks() const { return shrinks_; }
  /// Returns the limit of a sequence, once it can be told.
  /// @param shortest  by jump: cycles not longer than this are lost in the rounding of its guard; their sequence is
  ///                  extrapolated when it gets near, whatever remains. Jumps that follow each other faster than a
  ///                  hundredth of it, in any order, have their limit where they are.
  [[nodiscard]] std::optional<SeriesLimit> limit(const std::vector<double>& shortest) const;
  /// Returns where the last event is, if its cycle was less than a hundredth of the one before. As much less again has
  /// to be 1e-7 of the time taken at most. These are too few cycles to believe in a limit, unless something else says
  /// so.
  [[nodiscard]] std::optional<SeriesLimit> nearly() const;
  /// Returns how long the shortest cycle is that the last event closes; nullopt if none of its like is among the last
  /// eight.
  [[nodiscard]] std::optional<double> closed_cycle() const;
  /// Returns how long the last cycle of a shrinking sequence was; nullopt outside of one.
  [[nodiscard]] std::optional<double> last_cycle() const;
  /// Starts cycles anew, behind a limit, or where guards came to rest. Chattering is followed through such rests.
  void clear_cycles();
  void clear();
  [[nodiscard]] bool empty() const { return entries_.empty(); }

 private:
  /// Jumps executed at one time: the usual one alone without a list.
  struct Executed {
    static constexpr int several = -1;
    int only = several;
    std::vector<int> jumps;  ///< if they are several, or none

    void set(const std::vector<int>& executed);
    [[nodiscard]] bool operator==(const Executed& other) const {
      return only == other.only && (only != several || jumps == other.jumps);
    }
    void append_to(std::vector<int>& list) const;
    /// The largest of the values that belong to them, at least 0.
    [[nodiscard]] double largest(const std::vector<double>& values) const;
  };
  struct Entry {
    double t = 0.0;
    Executed executed;
    std::optional<std::size_t> place;  ///< of the state in states_
  };
  static constexpr std::size_t longest_period = 8;
  struct Recent {
    double t = 0.0;
    Executed executed;
  };
  /// Jumps without a pattern that are looked at together.
  static constexpr std::size_t many = 64;
  /// Cycles whose durations give the ratio, at most: more average out the rounding of t where the ratio is near 1.
  static constexpr std::size_t most_cycles = 48;
  [[nodiscard]] const Entry& back(std::size_t steps) const { return entries_.back(steps); }
  [[nodiscard]] const double* state(std::size_t steps) const { return states_.data() + *back(steps).place; }
  [[nodiscard]] std::vector<double> last_state() const { return {state(0), state(0) + n_x_}; }
  /// Whether the entries so many steps before the last one are of the same jumps.
  [[nodiscard]] bool repeats(std::size_t steps, std::size_t earlier) const {
    return back(steps).executed == back(earlier).executed;
  }
  [[nodiscard]] bool is_far_from_limit(std::size_t period, double resolved_to) const;
  [[nodiscard]] std::optional<SeriesLimit> limit_of(std::size_t period, double resolved_to) const;
  [[nodiscard]] std::optional<SeriesLimit> end_of_chattering(const std::vector<double>& shortest) const;
  [[nodiscard]] std::vector<double> extrapolated(std::size_t period, double ratio) const;
  [[nodiscard]] std::vector<int> last_jumps(std::size_t entries) const;
  /// Cycles that must shrink before a sequence is believed to have a limit.
  static constexpr std::size_t fewest_cycles = 4;
  struct Durations {
    std::array<double, most_cycles> of;  ///< cycles, the last one first
    std::size_t count = 0;
  };
  /// Of the cycles behind the entry `skipped` cycles ago, at most so many, as far as jumps repeat and cycles shrink.
  [[nodiscard]] Durations durations(std::size_t period, std::size_t skipped, std::size_t most) const;
  /// Of successive durations, at least two of which there are, over as many cycles as it takes to shrink to a third:
  /// the rounding of t is divided by their number.
  [[nodiscard]] double ratio(std::size_t period, std::size_t skipped) const;

  LastItems<Entry, longest_period*(most_cycles + 2)> entries_;
  std::size_t n_x_ = 0;
  std::vector<double> states_;                    ///< behind the entries, n_x_ numbers each
  LastItems<Recent, many> recent_;                ///< for chattering
  std::array<int, longest_period + 1> lately_{};  ///< Executed::only of the last entries, the last one first
  double start_[longest_period + 1] = {};         ///< of the shrinking sequence of each period
  std::size_t cycles_[longest_period + 1] = {};   ///< in it
  std::size_t shortest_repeated_ = 0;             ///< the shortest period that the last event closes, 0 = none
  bool shrinks_ = false;                          ///< see shrinks()
  bool is_sequence_ = false;                      ///< some period has shrunk as often as limit() asks for
};

}  // namespace saltus::event_integrator
