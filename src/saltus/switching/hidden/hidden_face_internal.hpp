// The hidden dynamics in one zone: which selections vary, and the velocities there.
#pragma once

#include <cstddef>
#include <vector>

#include "saltus/base/at.hpp"
#include "saltus/switching/table/multi_affine.hpp"
#include "saltus/switching/table/projected_field.hpp"

namespace saltus::switching {

/// Evaluates v = kappa o g(pi(u)) on one of the 3^m zones of the cube: zone_j = 0 where u_j is in [0, 1] and its
/// selection varies, -1 and +1 below and above. In a zone v is a smooth function of the free components, continued
/// outside it.
class HiddenFace {
 public:
  /// Tables of up to 2^8 corners are restricted to a zone once; larger groups call g.
  static constexpr int largest_table = 8;

  HiddenFace(int surfaces, ProjectedField g, Interpolation interpolation);
  void set_scaling(const std::vector<double>& scaling);  ///< m positive factors of kappa

  void enter(const std::vector<int>& zone);
  void velocity(const double* u, double* v) const;  ///< m doubles each
  /// Evaluates d v_j / d u_p for all j and the free p: surfaces x free, row by row, from v = v(u).
  void derivatives(const double* u, const double* v, double* result) const;

  [[nodiscard]] int surfaces() const { return surfaces_; }
  [[nodiscard]] const std::vector<int>& free() const { return free_; }
  [[nodiscard]] double speed(int j) const { return speed_[at(j)]; }  ///< max |v_j| at corners
  [[nodiscard]] long evaluations() const { return evaluations_; }

 private:
  int surfaces_;
  ProjectedField g_;
  Interpolation interpolation_;
  bool tabulated_;
  std::vector<double> kappa_, speed_;
  std::vector<int> free_;
  MultiAffine table_;  ///< g at all corners
  MultiAffine face_;   ///< kappa g at the corners of the zone
  mutable std::vector<double> alpha_, selections_, here_, there_;
  mutable long evaluations_ = 0;
};

}  // namespace saltus::switching
