// Functions that are affine in each of several selections, from their values at the corners of the unit cube.
#pragma once

#include <cstddef>
#include <vector>

#include "saltus/switching/table/group_decision.hpp"
#include "saltus/switching/table/projected_field.hpp"

namespace saltus::switching {

/// Holds `rows` functions of n selections: value(j, corner) at the corner whose bit i is alpha_i. A value; evaluation
/// uses a workspace inside it and does not allocate.
class MultiAffine {
 public:
  MultiAffine() = default;
  MultiAffine(int rows, int selections);
  /// Takes the velocities of a table (eq. (2.6) of [guglielmi2022]).
  explicit MultiAffine(const CornerTable& table);
  /// Samples g at the 2^m corners: m 2^m numbers.
  MultiAffine(int surfaces, ProjectedField g);

  /// Makes room for `rows` functions of n selections; values become undefined. Allocates only where they do not fit.
  void resize(int rows, int selections);

  [[nodiscard]] int rows() const { return rows_; }
  [[nodiscard]] int selections() const { return selections_; }
  [[nodiscard]] std::size_t corners() const { return std::size_t{1} << selections_; }
  [[nodiscard]] double value(int row, std::size_t corner) const { return values_[index(row, corner)]; }
  void set_value(int row, std::size_t corner, double value) { values_[index(row, corner)] = value; }

  /// Evaluates all functions at alpha (n), which may lie outside the cube: exact at its corners. Successive
  /// contraction, about 3 rows 2^n operations.
  void evaluate(const double* alpha, double* result) const {
    if (selections_ != 2 || rows_ != 2) return contract(alpha, result);
    // Two surfaces: what nearly every evaluation is, in a handful of instructions.
    const PairWeights weights(alpha);
    const double first = weights.value(values_.data());
    const double second = weights.value(values_.data() + 4);
    result[0] = first;
    result[1] = second;
  }

 private:
  /// Of the four corners of two selections. Read at once: results might be the selections, for all the compiler knows.
  struct PairWeights {
    explicit PairWeights(const double* alpha) : above{alpha[0], alpha[1]}, below{1.0 - above[0], 1.0 - above[1]} {}
    [[nodiscard]] double value(const double* corner) const {
      const double low = below[0] * corner[0] + above[0] * corner[1];
      const double high = below[0] * corner[2] + above[0] * corner[3];
      return below[1] * low + above[1] * high;
    }
    double above[2], below[2];
  };
  void contract(const double* alpha, double* result) const;
  [[nodiscard]] std::size_t index(int row, std::size_t corner) const {
    return static_cast<std::size_t>(row) * corners() + corner;
  }

  int rows_ = 0;
  int selections_ = 0;
  std::vector<double> values_;  ///< row by row
  mutable std::vector<double> work_;
};

/// Returns the other end of the difference over alpha_p from `here`: the farther of 0 and 1, at which a multi-affine g
/// gives the derivative up to rounding; for general g 1e-6 away (errors of 1e-6 and 1e-10 of g from truncation and
/// rounding).
[[nodiscard]] constexpr double difference_end(double here, Interpolation interpolation) {
  if (interpolation == Interpolation::multi_affine) return here < 0.5 ? 1.0 : 0.0;
  return here < 0.5 ? here + 1e-6 : here - 1e-6;
}

/// Finds G_jp = d g_j / d alpha_p at alpha, m x m row by row, from g = g(alpha) and m further evaluations: the
/// differences to difference_end.
/// @param alpha  m selections; changed during the call and put back
/// @param shifted  workspace of m doubles
void selection_jacobian(ProjectedField field, Interpolation interpolation, int surfaces, double* alpha, const double* g,
                        double* jacobian, double* shifted);

}  // namespace saltus::switching
