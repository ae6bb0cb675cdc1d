// Rows of a matrix that do not depend on each other.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

namespace saltus::event_integrator {

/// Collects rows that do not depend on each other: those that may be held at once.
class RowBasis {
 public:
  explicit RowBasis(const Eigen::MatrixXd& rows) : rows_(rows) {}
  [[nodiscard]] bool holds(int row) const { return !part_beside(row); }
  /// Adds a row unless it depends on those that were taken.
  bool takes(int row) {
    const auto part = part_beside(row);
    if (part) basis_.push_back(part->normalized());
    return part.has_value();
  }

 private:
  [[nodiscard]] std::optional<Eigen::VectorXd> part_beside(int row) const {
    Eigen::VectorXd e = rows_.row(row).transpose();
    const double size = e.norm();
    for (const auto& b : basis_) e -= b.dot(e) * b;
    for (const auto& b : basis_) e -= b.dot(e) * b;
    if (!(e.norm() > 1e-9 * size)) return std::nullopt;
    return e;
  }

  const Eigen::MatrixXd& rows_;
  std::vector<Eigen::VectorXd> basis_;
};

}  // namespace saltus::event_integrator
