#include "saltus/linalg/spectra.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>

#include "saltus/linalg/eigen_internal.hpp"

namespace saltus::linalg {

SingularValues singular_values(ConstView a) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(eigen(a), Eigen::ComputeFullV);
  return {Vector(matrix_of(svd.singularValues())), matrix_of(svd.matrixV())};
}

double spectral_norm(ConstView a) {
  if (a.empty()) return 0.0;
  return Eigen::JacobiSVD<Eigen::MatrixXd>(eigen(a)).singularValues()(0);
}

SymmetricSpectrum symmetric_spectrum(ConstView a) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(eigen(a));
  return {Vector(matrix_of(solver.eigenvalues())), matrix_of(solver.eigenvectors())};
}

Vector symmetric_eigenvalues(ConstView a) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(eigen(a), Eigen::EigenvaluesOnly);
  return matrix_of(solver.eigenvalues());
}

std::optional<std::vector<std::complex<double>>> eigenvalues(ConstView a) {
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(eigen(a), false);
  if (solver.info() != Eigen::Success) return std::nullopt;
  return std::vector<std::complex<double>>(solver.eigenvalues().begin(), solver.eigenvalues().end());
}

std::optional<std::vector<PencilValue>> pencil_eigenvalues(ConstView a, ConstView b) {
  const Eigen::GeneralizedEigenSolver<Eigen::MatrixXd> solver(eigen(a), eigen(b), false);
  if (solver.info() != Eigen::Success) return std::nullopt;
  std::vector<PencilValue> values;
  for (Index i = 0; i < a.rows(); ++i) values.push_back({solver.alphas()[i], solver.betas()[i]});
  return values;
}

}  // namespace saltus::linalg
