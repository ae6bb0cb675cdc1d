// The modes of a run, one after the other, as what changes from each to the next.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace saltus::event_integrator {

/// Holds modes with their selections in the order of time. Two that follow each other differ in a surface or two,
/// however many there are: kept is the first one and the differences.
class ModeLog {
 public:
  /// Appends a mode (n_psi) with its selections (n_psi), unless it is the last one, bit for bit.
  /// @return its number
  /// Cost: one comparison of all, memory for the differences only.
  std::size_t append(const std::vector<int>& mode, const std::vector<double>& alpha);
  /// Appends the last mode with one function changed, unless that is no change, bit for bit. Cost: O(1).
  /// @return its number
  std::size_t append_change(std::size_t function, int mode, double alpha);
  /// Says what one function is in a mode.
  struct Selected {
    std::size_t function = 0;
    int mode = 0;
    double alpha = 0.0;
  };
  /// Appends the last mode with two functions changed, at least one of them in its bits.
  std::size_t append_changes(const std::array<Selected, 2>& selected);
  /// Makes room for so many modes that each differ in one function from the one before.
  void reserve(std::size_t modes) {
    changes_.reserve(modes);
    ends_.reserve(modes);
  }
  /// Forgets all but the last mode, whose number is then 0.
  void restart();
  /// Returns what one function has in the last mode.
  [[nodiscard]] int last_mode(std::size_t function) const { return last_mode_[function]; }
  [[nodiscard]] std::size_t size() const { return ends_.size(); }
  /// Appends to `functions` those whose mode differs between the last two, ascending.
  void append_changed(std::vector<std::size_t>& functions) const;

  /// Expands one mode after the other.
  class Reader {
   public:
    explicit Reader(const ModeLog& log) : log_(&log) {}
    /// Goes to a mode, and calls visit(function) for those that differ from the last one at most; some twice. Cost: the
    /// differences on the way from the last one; from the beginning if it lies before that.
    template <class Visit>
    void seek(std::size_t number, Visit visit) {
      if (begin_before(number)) {
        for (std::size_t j = 0; j < mode_.size(); ++j) visit(j);
      }
      for (std::size_t k = log_->ends_[next_ - 1]; k < log_->ends_[number]; ++k) {
        const auto& change = log_->changes_[k];
        mode_[change.function] = change.mode;
        alpha_[change.function] = change.alpha;
        visit(change.function);
      }
      next_ = number + 1;
    }
    void seek(std::size_t number) {
      seek(number, [](std::size_t) {});
    }
    [[nodiscard]] const std::vector<int>& mode() const { return mode_; }
    [[nodiscard]] const std::vector<double>& alpha() const { return alpha_; }

   private:
    /// Goes to the first mode if there is none yet, or this one lies before it; returns whether.
    bool begin_before(std::size_t number);
    const ModeLog* log_;
    std::size_t next_ = 0;  ///< the number behind the one expanded; 0 = none yet
    std::vector<int> mode_;
    std::vector<double> alpha_;
  };

 private:
  struct Change {
    std::size_t function;
    int mode_before;
    int mode;
    double alpha;
  };
  std::vector<int> first_mode_, last_mode_;
  std::vector<double> first_alpha_, last_alpha_;
  std::vector<Change> changes_;
  std::vector<std::size_t> ends_;  ///< by number: end of its changes
};

}  // namespace saltus::event_integrator
