#include "saltus/event_integrator/contact/contact_point.hpp"

#include <algorithm>

#include <Eigen/LU>
#include <Eigen/QR>

namespace saltus::event_integrator {

int HeldRows::hold(int row) {
  const auto unknown = static_cast<int>(held.size());
  held.push_back(row);
  columns(row, unknown) = 1.0;
  return unknown;
}

auto HeldRows::solve(const Eigen::MatrixXd& influence, const Eigen::VectorXd& start, Eigen::VectorXd& forces) const
    -> Solution {
  forces = given;
  if (held.empty()) return Solution::one;
  const Eigen::VectorXd before = start + influence * given;
  const auto n = static_cast<Eigen::Index>(held.size());
  if (n == 1) {
    const double row = influence.row(held.front()).dot(columns.col(0)), right = -before(held.front());
    if (row != 0.0) forces += columns.col(0) * (right / row);
    return row != 0.0 || right == 0.0 ? Solution::one : Solution::none;
  }
  const Eigen::MatrixXd rows = rows_of(influence);
  const Eigen::VectorXd right = -before(held);
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> factors;
  factors.setThreshold(dependent);
  factors.compute(rows);
  const Eigen::VectorXd unknowns = factors.solve(right);
  const double size = rows.cwiseAbs().maxCoeff() * unknowns.cwiseAbs().maxCoeff() + right.cwiseAbs().maxCoeff();
  if (!((rows * unknowns - right).cwiseAbs().maxCoeff() <= 1e-8 * size)) return Solution::none;
  forces += columns.leftCols(n) * unknowns;
  return factors.rank() < n ? Solution::open : Solution::one;
}

Eigen::MatrixXd HeldRows::rows_of(const Eigen::MatrixXd& influence) const {
  return influence(held, Eigen::all) * columns.leftCols(static_cast<Eigen::Index>(held.size()));
}

Eigen::MatrixXd HeldRows::open(const Eigen::MatrixXd& influence) const {
  const auto n = static_cast<Eigen::Index>(held.size());
  Eigen::FullPivLU<Eigen::MatrixXd> factors;
  factors.setThreshold(dependent);
  if (n > 0) factors.compute(rows_of(influence));
  if (n == 0 || factors.rank() == n) return Eigen::MatrixXd(columns.rows(), 0);
  return columns.leftCols(n) * factors.kernel();
}

bool find_directions(const ContactPoint& point, const std::vector<int>& free, std::vector<Eigen::Vector2d>& directions,
                     const Eigen::VectorXd& forces, const Eigen::VectorXd& rates, FunctionRef<bool()> solve) {
  // A step along the rate, as long as would turn friction around: one contact without other influences needs one.
  constexpr int most_steps = 500;
  constexpr double settled = 1e-15, found = 1e-9;
  double change = 0.0;
  for (int step = 0; step < most_steps; ++step) {
    if (!solve()) return false;
    change = 0.0;
    for (const int i : free) {
      const int first = point.tangent_row(i, 0), second = point.tangent_row(i, 1);
      const double push = point.friction[static_cast<std::size_t>(i)] * forces(i) *
                          std::max(point.influence(first, first), point.influence(second, second));
      auto& direction = directions[static_cast<std::size_t>(i)];
      const Eigen::Vector2d rate = point.along(rates, i);
      const Eigen::Vector2d next = push > 0.0 ? Eigen::Vector2d(direction + rate / push) : rate;
      if (!(next.norm() > 0.0)) continue;
      change = std::max(change, (next.normalized() - direction).norm());
      direction = next.normalized();
    }
    if (change <= settled) break;
  }
  return change <= found && solve();
}

}  // namespace saltus::event_integrator
