#include "saltus/event_integrator/region_ties.hpp"

#include <algorithm>

#include <Eigen/Cholesky>

#include "saltus/base/at.hpp"
#include "saltus/switching/independent_rows.hpp"

namespace saltus::event_integrator {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

MatrixXd rows_of(const RegionBasis& basis, const MatrixXd& rows) {
  MatrixXd spanning(static_cast<Index>(basis.base.size()), rows.cols());
  for (std::size_t k = 0; k < basis.base.size(); ++k) spanning.row(static_cast<Index>(k)) = rows.row(basis.base[k]);
  return spanning;
}

}  // namespace

RegionBasis basis_of(const MatrixXd& rows) {
  MatrixXd rest = rows;
  for (Index i = 0; i < rest.rows(); ++i) {
    if (const double length = rest.row(i).norm(); length > 0.0) rest.row(i) /= length;
  }
  RegionBasis basis;
  while (basis.base.size() < static_cast<std::size_t>(std::min(rest.rows(), rest.cols()))) {
    Index best = 0;
    if (!(rest.rowwise().norm().maxCoeff(&best) > switching::dependent_part)) break;
    const Eigen::RowVectorXd direction = rest.row(best).normalized();
    rest -= (rest * direction.transpose()) * direction;
    basis.base.push_back(best);
  }
  std::sort(basis.base.begin(), basis.base.end());
  return basis;
}

RegionCoordinates coordinates_in(const RegionBasis& basis, const MatrixXd& rows) {
  const auto m = static_cast<Index>(basis.base.size());
  RegionCoordinates coordinates = RegionCoordinates::Zero(rows.rows() + 1, m);
  if (m == 0) return coordinates;
  RegionCoordinates normal(m, m), right(m, rows.rows());
  for (Index k = 0; k < m; ++k) {
    const auto row = rows.row(basis.base[at(k)]);
    for (Index l = 0; l < m; ++l) normal(k, l) = row.dot(rows.row(basis.base[at(l)]));
    for (Index i = 0; i < rows.rows(); ++i) right(k, i) = row.dot(rows.row(i));
  }
  const Eigen::LDLT<RegionCoordinates> factors(normal);
  coordinates.bottomRows(rows.rows()) = factors.solve(right).transpose();
  for (Index k = 0; k < m; ++k) {  // exactly what they are
    coordinates.row(basis.base[at(k)] + 1).setZero();
    coordinates(basis.base[at(k)] + 1, k) = 1.0;
  }
  return coordinates;
}

double remainder(const RegionBasis& basis, const MatrixXd& rows) {
  if (basis.base.empty()) return rows.size() > 0 ? 1.0 : 0.0;
  const MatrixXd rest = rows - coordinates_in(basis, rows).bottomRows(rows.rows()) * rows_of(basis, rows);
  double largest = 0.0;
  for (Index i = 0; i < rows.rows(); ++i) {
    const double length = rows.row(i).norm();
    if (length > 0.0) largest = std::max(largest, rest.row(i).norm() / length);
  }
  return largest;
}

}  // namespace saltus::event_integrator
