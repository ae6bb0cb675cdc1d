// A step of the hidden dynamics by its Taylor series, where two selections vary.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "saltus/switching/table/multi_affine.hpp"

namespace saltus::switching {

/// Takes a step of u_j' = v_j, all v_j bilinear in the two free components. From the coefficients up to k those of k +
/// 1 follow by one product of the two free series and one linear combination: an order costs about as much as one
/// evaluation of v, and the step's length is known before it is taken.
///
/// Source: [jorba2005] for the series and the length.
class PairSeries {
 public:
  explicit PairSeries(int surfaces) : coefficients_(static_cast<std::size_t>(surfaces)) {}

  /// Takes the step from u with v = v(u), as long as its last two terms remain below the tolerance (absolute and
  /// relative), at most `longest`. No allocation.
  /// @param face  v at the four corners of the free components
  /// @param free  which two components those are
  void take(const MultiAffine& face, const std::vector<int>& free, const std::vector<double>& u,
            const std::vector<double>& v, double tolerance, double longest);

  [[nodiscard]] double h() const { return h_; }
  void evaluate(double theta, double* u) const;  ///< at the share theta of the step: m doubles
  void bounds(double* low, double* high) const;  ///< of u within the step, not sharp: m doubles each

 private:
  /// Events are searched on interpolants of degree 8: at a tolerance of 1e-6 the terms beyond it change those by 1e-9.
  static constexpr std::size_t order = 12;
  using Coefficients = std::array<double, order + 1>;  ///< of powers of theta

  [[nodiscard]] double length(double tolerance, double longest) const;

  std::vector<Coefficients> coefficients_;
  double h_ = 0.0;
};

}  // namespace saltus::switching
