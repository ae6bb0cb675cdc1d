// The step to start a piece of the solution with: the one that was right when its mode was last entered.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "saltus/event_integrator/mode/mode_change.hpp"

namespace saltus::event_integrator {

/// Remembers for the last few modes which step their first accepted one proposed. Solutions come back to their modes
/// (cycles of sticking and slipping, of gene activity), and the step of the mode before says little about the new one:
/// without this a switch costs several rejected steps. Cost: O(n_psi) per switch.
class StepMemory {
 public:
  /// Goes on in `mode` from t; any mode before ends here.
  /// @param change  that has led to it
  /// @return the step to start with: the remembered one, or `proposed`
  [[nodiscard]] double change(const std::vector<int>& mode, double t, double proposed, const ModeChange& change = {});
  /// Returns a mark of the mode that differs from the one that lasts in this surface: different modes rarely have the
  /// same.
  [[nodiscard]] std::size_t mark_with(std::size_t surface, int mode) const;
  /// Notes, behind each accepted step, what the step control proposes for the next one.
  void accepted(double proposed);
  /// Returns whether the next step is the first one of its mode as far as is remembered: its length comes from another
  /// field.
  [[nodiscard]] bool is_guess() const { return is_new_ && !first_accepted_; }

 private:
  static constexpr std::size_t capacity = 32;
  struct Entry {
    std::size_t mark = 0;  ///< of the mode: different modes rarely have the same
    std::vector<int> mode;
    double step = 0.0;
  };
  void end(double t);
  double begin(const std::vector<int>& mode, std::size_t mark, double t, double proposed);

  std::array<Entry, capacity> entries_;
  std::size_t used_ = 0;         ///< 0: no mode lasts yet
  std::size_t next_ = 0;         ///< to be overwritten
  std::size_t current_ = 0;      ///< of the mode that lasts
  bool first_accepted_ = false;  ///< in it
  bool is_new_ = true;           ///< no step of it is remembered
  double proposed_ = 0.0;        ///< behind its first accepted step
  double start_ = 0.0;
};

}  // namespace saltus::event_integrator
