#include "saltus/event_integrator/contact/contact_point.hpp"

#include <Eigen/QR>

namespace saltus::event_integrator {

int HeldRows::hold(int row) {
  const auto unknown = static_cast<int>(held.size());
  held.push_back(row);
  columns.conservativeResize(Eigen::NoChange, unknown + 1);
  columns.col(unknown).setZero();
  columns(row, unknown) = 1.0;
  return unknown;
}

bool HeldRows::solve(const Eigen::MatrixXd& influence, const Eigen::VectorXd& start, Eigen::VectorXd& forces) const {
  forces = given;
  if (held.empty()) return true;
  const Eigen::VectorXd before = start + influence * given;
  const Eigen::MatrixXd response = influence * columns;
  const auto n = static_cast<Eigen::Index>(held.size());
  Eigen::MatrixXd rows(n, n);
  Eigen::VectorXd right(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    rows.row(k) = response.row(held[static_cast<std::size_t>(k)]);
    right(k) = -before(held[static_cast<std::size_t>(k)]);
  }
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> factors;
  factors.setThreshold(1e-11);  // rows that depend on each other to rounding
  factors.compute(rows);
  const Eigen::VectorXd unknowns = factors.solve(right);
  const double size = rows.cwiseAbs().maxCoeff() * unknowns.cwiseAbs().maxCoeff() + right.cwiseAbs().maxCoeff();
  if (!((rows * unknowns - right).cwiseAbs().maxCoeff() <= 1e-8 * size)) return false;
  forces += columns * unknowns;
  return true;
}

}  // namespace saltus::event_integrator
