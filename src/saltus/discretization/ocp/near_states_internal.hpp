// The states of a point that a motion of its controls stays near.
#pragma once

#include <optional>
#include <vector>

#include "saltus/discretization/ocp/element_trial_internal.hpp"

namespace saltus::discretization {

/// Motions that are not stable leave the states they are meant to have, and then have other modes. So a motion begins
/// each interval at the states of the point again, wherever both are in the same mode.
class NearStates {
 public:
  /// @param parameters  all of System::p
  NearStates(const OcpStructure& made, mpcc::ConstVectorView w, std::vector<double> parameters);

  /// Returns what is left of interval k > 0 at the states of the point, on the surfaces that `left` is on; nothing
  /// where both are not on the same sides.
  /// Cost: a few small linear systems.
  [[nodiscard]] std::optional<std::vector<double>> at_begin_of(std::size_t k, const std::vector<double>& left) const;

 private:
  [[nodiscard]] linalg::Vector psi(std::size_t k, const std::vector<double>& left) const;
  [[nodiscard]] linalg::Matrix jacobian(std::size_t k, const std::vector<double>& left) const;
  [[nodiscard]] std::vector<casadi::DM> inputs(std::size_t k, const std::vector<double>& left) const;
  [[nodiscard]] std::vector<bool> zeros(const linalg::Vector& lambda) const;
  [[nodiscard]] linalg::Matrix held(const std::vector<bool>& is_zero) const;
  [[nodiscard]] int part_of(int selection) const;

  const OcpStructure& made_;
  mpcc::ConstVectorView w_;
  std::vector<double> parameters_;
  casadi::Function jacobian_;                ///< of psi with respect to x
  std::vector<std::vector<double>> begins_;  ///< what is left of each interval
  linalg::Vector scale_;                     ///< of each selection's psi
};

}  // namespace saltus::discretization
