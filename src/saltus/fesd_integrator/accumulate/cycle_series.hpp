// Sequences of switches with a limit: infinitely many in finite time (spirals).
#pragma once

#include <array>
#include <cstddef>
#include <deque>
#include <optional>
#include <vector>

namespace saltus::fesd_integrator {

/// Watches switches for cycles of active sets of at most eight switches, whose durations T_k shrink
/// geometrically: with r = T_k / T_(k-1) < 1 what remains is T_k r / (1 - r). States are extrapolated component by
/// component by Aitken's delta-squared process, which is exact for geometric sequences of any ratio.
class CycleSeries {
 public:
  struct Switch {
    double t = 0.0;
    std::vector<int> modes;  ///< behind
    std::vector<double> x;
    double resolution = 0.0;  ///< of t: the rounding level of what is zero there, divided by its rate
  };
  struct Limit {
    double t = 0.0;
    std::vector<double> x;
    std::vector<std::vector<int>> modes;  ///< of one cycle
  };
  void add(Switch next);
  /// Says when a limit is wanted. It is resolved once the last two extrapolations agree to a fiftieth of what remains
  /// and the end is near. Near is 1e-8 of the time that the sequence has taken, or cycles that are not much longer than
  /// they are resolved.
  enum class Wanted {
    resolved,
    soon,  ///< nobody can follow the cycles any further: whatever remains
  };
  [[nodiscard]] std::optional<Limit> limit(Wanted wanted) const;
  /// Returns whether the last two cycles of some period have shrunk.
  [[nodiscard]] bool shrinks() const;
  /// Returns the time to the next switch, if it is to the last one what that was to the one before; nullopt if that is
  /// not shorter.
  [[nodiscard]] std::optional<double> next_switch() const;
  [[nodiscard]] double last_time() const { return switches_.empty() ? 0.0 : back(0).t; }
  /// Returns the largest change of a state in the last cycle of the shortest sequence that shrinks; 0 without one.
  [[nodiscard]] double last_change() const;
  void clear();

 private:
  static constexpr std::size_t longest_period = 8;
  static constexpr std::size_t cycles = 4;  ///< that must shrink before a limit is believed in
  [[nodiscard]] const Switch& back(std::size_t steps) const { return switches_[switches_.size() - 1 - steps]; }
  [[nodiscard]] std::optional<Limit> limit_of(std::size_t period, Wanted wanted) const;

  std::deque<Switch> switches_;
  std::array<double, longest_period + 1> start_{};       ///< of the shrinking sequence of each period
  std::array<std::size_t, longest_period + 1> count_{};  ///< of switches in it
};

}  // namespace saltus::fesd_integrator
