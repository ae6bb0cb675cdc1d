// The vector field of a mode, worked out once more without the engine.
#pragma once

#include <cstddef>
#include <vector>

#include "random_systems.hpp"

namespace saltus::robustness {

/// Everything known at one point of a mode.
struct FieldValue {
  std::vector<double> xdot;
  std::vector<double> alpha;  ///< per switching function
  std::vector<double> psi;    ///< per switching function, with the selections above
  /// One sliding surface: d psi/dt along the fields below and above. Several: zero.
  double below = 0.0, above = 0.0;
  /// Several sliding surfaces: smallest pivot of the linear system, and det(-G) with rows of length 1: positive where
  /// the selections can attract.
  double pivot = 0.0, determinant = 1.0;
  /// Largest |d psi/dt| on a sliding surface with the selections that were guessed, over that along the fields.
  double imbalance = 0.0;
  /// Smallest distance of the argument of an abs or max from its kink, and of a sign read anew from its change.
  double kink_distance = 0.0;
};

class OwnField {
 public:
  /// @param mode  k in {-1, 0, 1}, one per surface
  OwnField(const RandomSystem& system, const std::vector<int>& mode);

  /// @param guess  selections to start from where several surfaces slide
  [[nodiscard]] FieldValue operator()(double t, const std::vector<double>& x, const std::vector<double>& guess) const;
  [[nodiscard]] const std::vector<std::size_t>& sliding() const { return sliding_; }
  /// Whether the sign of a surface is read anew in each region: it holds a sign that slides.
  [[nodiscard]] bool is_read_anew(std::size_t surface) const { return read_anew_[surface]; }

 private:
  FieldValue at_selections(double t, const std::vector<double>& x, const std::vector<double>& alpha) const;
  std::vector<double> psi_rates(double t, const std::vector<double>& x, const FieldValue& value) const;
  FieldValue slide_on_one(double t, const std::vector<double>& x, std::vector<double> alpha) const;
  FieldValue slide_on_several(double t, const std::vector<double>& x, std::vector<double> alpha) const;

  const RandomSystem& system_;
  std::vector<double> selections_;  ///< of the mode, 1/2 where it slides
  std::vector<std::size_t> sliding_;
  std::vector<bool> read_anew_;
};

}  // namespace saltus::robustness
