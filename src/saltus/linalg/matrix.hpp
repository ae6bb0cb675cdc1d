// Matrices and vectors of doubles that own their memory.
#pragma once

#include <array>
#include <initializer_list>
#include <memory>

#include "saltus/linalg/views.hpp"

namespace saltus::linalg {

/// A matrix that owns its entries, column by column. Up to `inside` of them lie in the object itself, so that small
/// ones allocate nothing; larger ones keep their memory when they shrink. Entries of a new one are not set. Views of it
/// are void behind a resize and behind the assignment of a result, whose memory it takes.
class Matrix : public Writable<Matrix> {
 public:
  Matrix() : Matrix(0, 0) {}
  Matrix(Index rows, Index columns);
  Matrix(ConstView other);
  Matrix(const View& other) : Matrix(static_cast<const ConstView&>(other)) {}
  /// Row by row.
  Matrix(std::initializer_list<std::initializer_list<double>> rows);
  Matrix(const Matrix& other) : Matrix(static_cast<const ConstView&>(other)) {}
  Matrix(Matrix&& other) noexcept;
  ~Matrix() = default;
  /// Takes the other's shape, too.
  Matrix& operator=(ConstView other);
  Matrix& operator=(const View& other) { return *this = static_cast<const ConstView&>(other); }
  Matrix& operator=(const Matrix& other) { return *this = static_cast<const ConstView&>(other); }
  Matrix& operator=(Matrix&& other) noexcept;

  [[nodiscard]] static Matrix zero(Index rows, Index columns) { return constant(rows, columns, 0.0); }
  [[nodiscard]] static Matrix constant(Index rows, Index columns, double value);
  [[nodiscard]] static Matrix identity(Index rows, Index columns);
  [[nodiscard]] static Matrix diagonal_of(ConstView entries);

  using Writable::set_zero;
  void set_zero(Index rows, Index columns);
  using Writable::set_constant;
  void set_constant(Index rows, Index columns, double value);
  /// Entries are not kept.
  void resize(Index rows, Index columns);
  /// Entries at places that exist before and after are kept, the others not set.
  void resize_and_keep(Index rows, Index columns);
  void swap(Matrix& other) noexcept;

  [[nodiscard]] double* begin() { return data_; }
  [[nodiscard]] double* end() { return data_ + size(); }
  [[nodiscard]] const double* begin() const { return data_; }
  [[nodiscard]] const double* end() const { return data_ + size(); }

 protected:
  static constexpr Index inside = 16;

 private:
  void take(Matrix& other) noexcept;

  std::array<double, inside> own_;
  std::unique_ptr<double[]> memory_;
  Index capacity_ = inside;
};

/// A matrix of one column. What has one row becomes a column.
class Vector : public Matrix {
 public:
  Vector() : Matrix(0, 1) {}
  explicit Vector(Index size) : Matrix(size, 1) {}
  Vector(ConstView other);
  Vector(const View& other) : Vector(static_cast<const ConstView&>(other)) {}
  Vector(const Matrix& other) : Vector(static_cast<const ConstView&>(other)) {}
  Vector(Matrix&& other) noexcept;
  Vector(std::initializer_list<double> values);
  Vector(const Vector& other) = default;
  Vector(Vector&& other) noexcept = default;
  ~Vector() = default;
  Vector& operator=(ConstView other);
  Vector& operator=(const View& other) { return *this = static_cast<const ConstView&>(other); }
  Vector& operator=(const Matrix& other) { return *this = static_cast<const ConstView&>(other); }
  Vector& operator=(Matrix&& other) noexcept;
  Vector& operator=(const Vector& other) { return *this = static_cast<const ConstView&>(other); }
  Vector& operator=(Vector&& other) noexcept;

  [[nodiscard]] static Vector zero(Index size) { return constant(size, 0.0); }
  [[nodiscard]] static Vector ones(Index size) { return constant(size, 1.0); }
  [[nodiscard]] static Vector constant(Index size, double value);
  [[nodiscard]] static Vector unit(Index size, Index place);

  using Writable<Matrix>::set_zero;
  void set_zero(Index size) { set_constant(size, 0.0); }
  using Writable<Matrix>::set_constant;
  void set_constant(Index size, double value);
  void resize(Index size) { Matrix::resize(size, 1); }
  void resize_and_keep(Index size) { Matrix::resize_and_keep(size, 1); }
};

inline View::View(Matrix& matrix) : Writable(matrix.data(), matrix.rows(), matrix.cols()) {}

// Each of these makes a new matrix; views into temporaries must not outlive them.
[[nodiscard]] Matrix operator+(ConstView a, ConstView b);
[[nodiscard]] Matrix operator-(ConstView a, ConstView b);
[[nodiscard]] Matrix operator-(ConstView a);
[[nodiscard]] Matrix operator*(double factor, ConstView a);
[[nodiscard]] inline Matrix operator*(ConstView a, double factor) { return factor * a; }
[[nodiscard]] Matrix operator/(ConstView a, double divisor);
/// The product of matrices: rows x k times k x columns. Cost: rows k columns.
[[nodiscard]] Matrix operator*(ConstView a, ConstView b);
[[nodiscard]] bool operator==(ConstView a, ConstView b);

/// out = a b, for out of the right shape that shares no memory with a and b.
void multiply(ConstView a, ConstView b, View out);
/// diag(factors) a, and a diag(factors).
[[nodiscard]] Matrix scaled_rows(ConstView factors, ConstView a);
[[nodiscard]] Matrix scaled_cols(ConstView a, ConstView factors);
/// a + summand in every column; in every row.
[[nodiscard]] Matrix plus_column(ConstView a, ConstView summand);
[[nodiscard]] Matrix plus_row(ConstView a, ConstView summand);
/// Returns whether some |a| is larger than its bound; both of one shape.
[[nodiscard]] bool any_beyond(ConstView a, ConstView bounds);
/// Of x and y behind each other.
[[nodiscard]] Vector joined(std::initializer_list<ConstView> parts);

}  // namespace saltus::linalg
