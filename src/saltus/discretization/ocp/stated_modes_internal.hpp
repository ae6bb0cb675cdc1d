// The mode sequence of states that somebody states: where they are on which side of which surface.
#pragma once

#include <functional>
#include <utility>
#include <vector>

#include "saltus/discretization/ocp/element_sides_internal.hpp"
#include "saltus/discretization/ocp/mode_sequence_internal.hpp"
#include "saltus/discretization/ocp/surface_states_internal.hpp"

namespace saltus::discretization {

/// Gives the elements of a start the modes of its states: elements end where these change, and a contact that closes
/// gets elements in which time stands still.
class StatedModes {
 public:
  using Modes = ElementSides::Sides;
  /// Returns psi of all selections at a share of interval k.
  using Indicator = std::function<linalg::Vector(std::size_t k, double share, const linalg::Vector& x)>;
  StatedModes(const OcpStructure& made, const OcpGuessValues& guess, Indicator indicator, linalg::Vector& w)
      : made_(made), guess_(guess), indicator_(std::move(indicator)), w_(w) {}

  void write();

 private:
  struct Sample {
    double share = 0.0;  ///< of the interval
    linalg::Vector x, psi;
  };
  [[nodiscard]] std::vector<Sample> samples(std::size_t k) const;
  [[nodiscard]] Modes modes_between(const Sample& a, const Sample& b) const;
  [[nodiscard]] Stretches stretches(const std::vector<Sample>& samples);
  void add_collisions(const Modes& before, const Modes& behind, Stretches& stretches) const;
  void write_element(std::size_t e, const Modes& modes, std::size_t k, const std::vector<Sample>& known, double share,
                     double passes);
  [[nodiscard]] static linalg::Vector state_at(const std::vector<Sample>& known, double share);
  void write_selections(std::size_t e, const Modes& modes, int stage);
  void write_multipliers(std::size_t e, const Modes& modes, int point, const linalg::Vector& psi);

  const OcpStructure& made_;
  const OcpGuessValues& guess_;
  Indicator indicator_;
  linalg::Vector& w_;
  Modes last_{};  ///< of the interval before
};

}  // namespace saltus::discretization
