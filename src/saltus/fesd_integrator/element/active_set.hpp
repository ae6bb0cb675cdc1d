// Which selections are fixed, and which slide: all that an element needs to be a smooth system of equations.
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "saltus/base/at.hpp"
#include "saltus/switching/selections/selection_balances.hpp"

namespace saltus::fesd_integrator {

/// Names selections first to first + count - 1, which belong together (reformulation::DcsPart, without its CasADi).
struct Part {
  bool simplex = false;  ///< Stewart's form: they sum up to 1; else each is a step selection by itself
  int first = 0;
  int count = 0;
  /// Of a simplex whose regions are all sign patterns of so many surfaces, + before -, the last one fastest; else 0.
  int surfaces = 0;

  /// Returns the side of a surface on which such a region is: 1 or -1.
  [[nodiscard]] int side(int region, int surface) const {
    return ((region - first) >> (surfaces - 1 - surface) & 1) != 0 ? -1 : 1;
  }
};

/// Names what is zero on a surface: an indicator, or what the one of a reference region is above it.
struct Surface {
  int indicator = 0;
  int reference = -1;  ///< -1: none

  /// Returns the value of that, also of rows of derivatives (`stride` apart).
  [[nodiscard]] double value(const double* indicators, std::size_t stride = 1) const {
    const double own = indicators[static_cast<std::size_t>(indicator) * stride];
    return reference < 0 ? own : indicators[static_cast<std::size_t>(reference) * stride] - own;
  }
  [[nodiscard]] bool operator==(const Surface&) const = default;
};

/// Holds a selection that the state keeps between its bounds: an unknown of the element.
struct Sliding {
  int selection = 0;
  int reference = -1;  ///< of a simplex: the active region whose weight is 1 less the others; -1 for a step selection
  Surface surface{};   ///< what it keeps: its own, but for ActiveSet::hold
};

/// Holds a sign that holds as long as the active set does: value >= 0.
struct Condition {
  enum class Kind {
    side,   ///< the indicator of a selection that is fixed, on its side
    lower,  ///< a sliding selection is not below 0
    upper,  ///< a sliding step selection is not above 1
  };
  Kind kind = Kind::side;
  int selection = 0;
};

/// Holds the active set of an element, see (25) and (29) of [nurkanovic2024]: of a step selection the sign of its
/// switching function, or 0 while it slides; of a region 0 while it is active, and -1.
class ActiveSet {
 public:
  ActiveSet() = default;
  /// Makes the set of these modes: one per selection; every simplex has an active region.
  ActiveSet(std::span<const Part> parts, std::vector<int> modes);

  [[nodiscard]] const std::vector<int>& modes() const { return modes_; }
  [[nodiscard]] const std::vector<Sliding>& sliding() const { return sliding_; }
  [[nodiscard]] const std::vector<Condition>& conditions() const { return conditions_; }
  /// Returns the balances of surfaces that slide and have gradients that depend on each other. Those of one balance
  /// have selections that share their conditions, fewer than these are (numbers in sliding()). Such a selection is not
  /// determined; its conditions `lower` and `upper` are SelectionMargins::value. They belong to a place, not to the
  /// modes.
  [[nodiscard]] const std::vector<switching::Balance>& balances() const { return balances_; }
  void set_balances(std::vector<switching::Balance> balances);
  [[nodiscard]] bool is_determined(int selection) const { return balances_.empty() || !undetermined_[at(selection)]; }
  /// Returns what stays zero while these surfaces slide, without a selection that keeps it there (a gap whose rate is
  /// held at zero). It belongs to a place, too.
  [[nodiscard]] const std::vector<Surface>& resting() const { return resting_; }
  /// Sets it; nothing asks for the sides of these selections, which it keeps at zero.
  void set_resting(std::vector<Surface> surfaces, const std::vector<int>& unasked);
  /// Lets a selection that slides keep another surface. A step selection of its own stays in the middle: both would be
  /// two selections for one equation.
  void hold(int selection, Surface surface);
  [[nodiscard]] bool operator==(const ActiveSet& other) const { return modes_ == other.modes_; }

  /// Finds all selections from the unknown ones (one per entry of sliding()).
  void selections(const double* unknown, double* all) const;
  /// Takes the unknown ones out of all.
  void unknowns(const double* all, double* unknown) const;
  /// Returns unknown selections in the middle of their range; of a simplex equal parts.
  [[nodiscard]] std::vector<double> middle() const;
  /// Returns what is zero while entry k of sliding() slides: psi_j, or g_r - g_i; also for rows of derivatives
  /// (`stride` apart).
  [[nodiscard]] double surface(std::size_t k, const double* indicator, std::size_t stride = 1) const {
    return sliding_[k].surface.value(indicator, stride);
  }
  /// Returns the value of a condition of kind `side`: positive on the side of this set; also for rates of the
  /// indicators.
  [[nodiscard]] double side(int selection, const double* indicator) const;
  /// Returns the active region that a region is compared with; -1 for a step selection.
  [[nodiscard]] int reference(int selection) const { return references_[at(selection)]; }
  /// Returns the value of any condition, of a selection that is determined.
  [[nodiscard]] double value(const Condition& condition, const double* indicator, const double* selections) const {
    const auto j = static_cast<std::size_t>(condition.selection);
    switch (condition.kind) {
      case Condition::Kind::side:
        return side(condition.selection, indicator);
      case Condition::Kind::lower:
        return selections[j];
      case Condition::Kind::upper:
        return 1.0 - selections[j];
    }
    __builtin_unreachable();
  }

 private:
  std::vector<int> modes_;
  std::vector<double> fixed_;    ///< selections where all unknown ones are 0
  std::vector<int> references_;  ///< per selection: the reference of its simplex, -1 for a step selection
  std::vector<Sliding> sliding_;
  std::vector<Condition> conditions_;
  std::vector<switching::Balance> balances_;
  std::vector<Surface> resting_;
  std::vector<bool> undetermined_;  ///< per selection; empty without balances
};

}  // namespace saltus::fesd_integrator
