// Eigenvalues and singular values of dense matrices.
#pragma once

#include <complex>
#include <optional>
#include <vector>

#include "saltus/linalg/matrix.hpp"

namespace saltus::linalg {

struct SingularValues {
  Vector values;  ///< decreasing
  Matrix right;   ///< V of A = U S V', one column per column of A
};

/// By Jacobi's method, with all of V.
[[nodiscard]] SingularValues singular_values(ConstView a);
/// The largest singular value; 0 of nothing.
[[nodiscard]] double spectral_norm(ConstView a);

/// Of a symmetric matrix, increasing.
[[nodiscard]] Vector symmetric_eigenvalues(ConstView a);

/// One eigenvalue alpha / beta of a pencil.
struct PencilValue {
  std::complex<double> alpha;
  double beta;
};

/// Of A v = lambda B v. Empty where the iteration does not converge.
[[nodiscard]] std::optional<std::vector<PencilValue>> pencil_eigenvalues(ConstView a, ConstView b);

}  // namespace saltus::linalg
