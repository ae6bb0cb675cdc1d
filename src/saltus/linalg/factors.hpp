// Factorisations of dense matrices of doubles, compiled once.
#pragma once

#include <memory>
#include <vector>

#include "saltus/linalg/matrix.hpp"

namespace saltus::linalg {

/// A member that is copied with its owner and whose type only the source knows. What is left behind a move begins
/// anew where it is used or copied.
template <class Part>
class Hidden {
 public:
  Hidden();
  Hidden(const Hidden& other);
  Hidden(Hidden&& other) noexcept;
  Hidden& operator=(const Hidden& other);
  Hidden& operator=(Hidden&& other) noexcept;
  ~Hidden();
  Part* operator->();
  const Part* operator->() const { return part_.get(); }

 private:
  std::unique_ptr<Part> part_;
};

/// P A = L U of a square matrix, with pivots by columns. A singular one gives solutions that are not finite. One that
/// is kept allocates nothing where a matrix comes that is no larger than the last. Cost: n^3 / 3.
class Lu {
 public:
  Lu() = default;
  explicit Lu(ConstView a) { compute(a); }
  void compute(ConstView a);
  [[nodiscard]] Matrix solve(ConstView right) const;
  void solve_in_place(View right) const;
  [[nodiscard]] double determinant() const;

 private:
  Matrix factors_;
  std::vector<Index> pivots_;
};

/// P A Q = L U of any matrix, with pivots from all entries. Entries below threshold() of the largest pivot are 0.
class FullLu {
 public:
  FullLu() = default;
  explicit FullLu(ConstView a) { compute(a); }
  void set_threshold(double threshold);
  void compute(ConstView a);
  [[nodiscard]] Index rank() const;
  [[nodiscard]] bool is_invertible() const;
  [[nodiscard]] Index dimension_of_kernel() const;
  [[nodiscard]] Matrix kernel() const;      ///< one zero column where the dimension is 0
  [[nodiscard]] double last_pivot() const;  ///< |U_nn| of a square matrix
  [[nodiscard]] Matrix inverse() const;
  [[nodiscard]] Matrix solve(ConstView right) const;
  struct Parts;

 private:
  Hidden<Parts> parts_;
};

/// A P = Q R of any matrix, with pivots by the norms of columns.
class PivotedQr {
 public:
  PivotedQr() = default;
  explicit PivotedQr(ConstView a) { compute(a); }
  void set_threshold(double threshold);
  void compute(ConstView a);
  [[nodiscard]] Index rank() const;
  /// In the sense of least squares.
  [[nodiscard]] Matrix solve(ConstView right) const;
  [[nodiscard]] Matrix times_q(ConstView b) const;  ///< Q b
  [[nodiscard]] std::vector<Index> column_order() const;
  struct Parts;

 private:
  Hidden<Parts> parts_;
};

/// A P = Q [T 0; 0 0] Z of any matrix: least squares of least norm.
class OrthogonalFactors {
 public:
  OrthogonalFactors() = default;
  explicit OrthogonalFactors(ConstView a) { compute(a); }
  void set_threshold(double threshold);
  void compute(ConstView a);
  [[nodiscard]] Index rank() const;
  [[nodiscard]] Matrix solve(ConstView right) const;
  /// An orthonormal basis of what A takes to 0: columns x (columns - rank).
  [[nodiscard]] Matrix null_space() const;
  [[nodiscard]] Matrix pseudo_inverse() const;
  struct Parts;

 private:
  Hidden<Parts> parts_;
};

/// A = L L' of a symmetric positive definite matrix.
class Cholesky {
 public:
  Cholesky() = default;
  explicit Cholesky(ConstView a) { compute(a); }
  void compute(ConstView a);
  [[nodiscard]] bool is_positive() const { return is_positive_; }  ///< false: no factors
  [[nodiscard]] Matrix solve(ConstView right) const;
  void solve_in_place(View right) const;

 private:
  Matrix factors_;  ///< L in the lower triangle
  bool is_positive_ = false;
};

/// P A P' = L D L' of a symmetric semi-definite matrix.
class Ldl {
 public:
  Ldl() = default;
  explicit Ldl(ConstView a) { compute(a); }
  void compute(ConstView a);
  [[nodiscard]] bool is_factorised() const;
  [[nodiscard]] bool is_positive() const;
  [[nodiscard]] Vector pivots() const;  ///< D
  [[nodiscard]] Matrix solve(ConstView right) const;
  void solve_in_place(View right) const;
  struct Parts;

 private:
  Hidden<Parts> parts_;
};

extern template class Hidden<FullLu::Parts>;
extern template class Hidden<PivotedQr::Parts>;
extern template class Hidden<OrthogonalFactors::Parts>;
extern template class Hidden<Ldl::Parts>;

/// The least-squares solution of least norm. Cost: that of OrthogonalFactors.
[[nodiscard]] Matrix least_squares(ConstView a, ConstView right);
/// Of a square matrix.
[[nodiscard]] double determinant(ConstView a);
[[nodiscard]] Matrix inverse(ConstView a);

}  // namespace saltus::linalg
