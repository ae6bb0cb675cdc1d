#include "saltus/linalg/spectra.hpp"

#include <cmath>

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>

#include "saltus/linalg/eigen_internal.hpp"

namespace saltus::linalg {
namespace {

/// Of the rows and columns i and i + 1, where T is diagonal: those of S diag(t_11, t_00), over t_00 t_11.
PencilValue first_of_pair(const Eigen::MatrixXd& s, const Eigen::MatrixXd& t, Index i) {
  const double a = t(i, i), b = t(i + 1, i + 1);
  const double s00 = s(i, i) * b, s01 = s(i, i + 1) * a, s10 = s(i + 1, i) * b, s11 = s(i + 1, i + 1) * a;
  const double p = 0.5 * (s00 - s11);
  const double z = std::sqrt(std::abs(p * p + s10 * s01));
  return {{s11 + p, a * b > 0.0 ? -z : z}, a * b};
}

}  // namespace

SingularValues singular_values(ConstView a) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(eigen(a), Eigen::ComputeFullV);
  return {Vector(matrix_of(svd.singularValues())), matrix_of(svd.matrixV())};
}

double spectral_norm(ConstView a) {
  if (a.empty()) return 0.0;
  return Eigen::JacobiSVD<Eigen::MatrixXd>(eigen(a)).singularValues()(0);
}

Vector symmetric_eigenvalues(ConstView a) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(eigen(a), Eigen::EigenvaluesOnly);
  return matrix_of(solver.eigenvalues());
}

std::optional<std::vector<PencilValue>> pencil_eigenvalues(ConstView a, ConstView b) {
  // Eigen's solver is this and its eigenvectors, which nobody asks for and which take long to compile.
  const Eigen::RealQZ<Eigen::MatrixXd> schur(eigen(a), eigen(b), false);
  if (schur.info() != Eigen::Success) return std::nullopt;
  const Eigen::MatrixXd &s = schur.matrixS(), &t = schur.matrixT();
  std::vector<PencilValue> values;
  const Index n = a.rows();
  for (Index i = 0; i < n; ++i) {
    if (i + 1 == n || s(i + 1, i) == 0.0) {
      values.push_back({s(i, i), t(i, i)});
      continue;
    }
    const PencilValue first = first_of_pair(s, t, i++);
    values.push_back(first);
    values.push_back({std::conj(first.alpha), first.beta});
  }
  return values;
}

}  // namespace saltus::linalg
