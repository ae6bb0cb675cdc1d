// A point of a zone where its free components rest.
#pragma once

#include <span>
#include <vector>

#include "saltus/base/at.hpp"
#include "saltus/switching/hidden/hidden_face_internal.hpp"

namespace saltus::switching {

/// Holds the root that find() found last, with what belongs to it: velocities of all components, their derivatives by
/// the free ones, and of these the square part J.
class RestPoint {
 public:
  /// The face must outlive it.
  explicit RestPoint(HiddenFace& face);

  /// Applies Newton's method to the free components of the current zone, from u.
  [[nodiscard]] bool find(const std::vector<double>& u);
  /// Returns whether the free components decay to the root from a point near by with jacobian_here(). With e = root -
  /// u, e' = (J + D) e where |D| is at most the change of J over e: it decays if J + 10 |D| I is stable. The factor 10
  /// stands for the non-normality of J.
  [[nodiscard]] bool attracts();

  [[nodiscard]] std::vector<double>& root() { return root_; }
  [[nodiscard]] const std::vector<double>& root() const { return root_; }
  [[nodiscard]] const std::vector<double>& velocity() const { return velocity_; }
  [[nodiscard]] const std::vector<double>& derivatives() const { return derivatives_; }
  /// Returns J, row by row: of attracts() the shifted one.
  [[nodiscard]] std::span<const double> jacobian() const;
  [[nodiscard]] std::vector<double>& jacobian_here() { return jacobian_here_; }

 private:
  HiddenFace& face_;
  std::vector<double> root_, velocity_, derivatives_, jacobian_, jacobian_here_, step_;
};

}  // namespace saltus::switching
