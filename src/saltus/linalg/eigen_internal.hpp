// Our views as Eigen's. Only sources of this module include it.
#pragma once

#include <Eigen/Core>

#include "saltus/linalg/matrix.hpp"

namespace saltus::linalg {

using EigenSteps = Eigen::Stride<Eigen::Dynamic, Eigen::Dynamic>;

[[nodiscard]] inline Eigen::Map<const Eigen::MatrixXd, 0, EigenSteps> eigen(ConstView a) {
  return {a.data(), a.rows(), a.cols(), EigenSteps(a.column_step(), a.row_step())};
}

[[nodiscard]] inline Eigen::Map<Eigen::MatrixXd, 0, EigenSteps> eigen(View a) {
  return {a.data(), a.rows(), a.cols(), EigenSteps(a.column_step(), a.row_step())};
}

[[nodiscard]] inline Matrix matrix_of(const Eigen::MatrixXd& a) { return ConstView(a.data(), a.rows(), a.cols()); }

}  // namespace saltus::linalg
