// The field of a mode in a part of the states, the others being known.
#pragma once

#include <cstddef>
#include <vector>

#include "saltus/evaluation/field_structure.hpp"
#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/event_integrator/mode/mode_state.hpp"
#include "saltus/ode/stepper.hpp"

namespace saltus::event_integrator {

/// Evaluates the field of a mode in a part of the states, which grows around those that a selection moves. Selections
/// of surfaces that are slid on follow from their own states; each of these surfaces has to be alone in that, and
/// affine.
class LocalField {
 public:
  explicit LocalField(const evaluation::ModelKernel& kernel) : kernel_(kernel) {}

  /// Returns whether the system is large, and rows of f can be evaluated one by one. Cost: the first call finds its
  /// structure.
  [[nodiscard]] bool is_known();
  /// Calls visit(state) for the states that a surface is made of.
  template <class Visit>
  void each_state_of(int surface, Visit visit) const {
    const auto [number, begin, end] = slid(static_cast<std::size_t>(surface));
    for (std::size_t k = begin; k < end; ++k) visit(gradients_.column[k]);
  }

  /// Begins with the rows that hold a selection, in a mode. Returns false where that is no part for this, as grow()
  /// does: it has more than a quarter of all states, or none, or surfaces there influence each other.
  [[nodiscard]] bool begin(int surface, const ModeState& mode);
  /// Adds all states that are moved by those of the part.
  [[nodiscard]] bool grow();
  [[nodiscard]] const std::vector<std::size_t>& rows() const { return rows_; }  ///< ascending
  /// Returns those of them that move others.
  [[nodiscard]] const std::vector<std::size_t>& border() const { return border_; }

  /// Evaluates the slopes of the states y of the part at a time of the step that all others are on.
  void operator()(const ode::DenseStep& others, double t, const double* y, double* slope);

 private:
  /// A surface that is slid on: its gradient has the numbers from `begin` to before `end` in gradients_.
  struct Slid {
    std::size_t surface, begin, end;
  };
  void add(std::size_t row);
  void add_what_moves(std::size_t state);
  bool complete();
  bool find_selections();
  [[nodiscard]] bool slides(std::size_t surface) const { return mode_->mode[surface] == 0; }
  [[nodiscard]] Slid slid(std::size_t surface) const {
    return {surface, gradients_.start[surface], gradients_.start[surface + 1]};
  }
  void find_border();
  void find_inputs();
  void select(double t);
  [[nodiscard]] double velocity(const Slid& surface, double t) const;

  const evaluation::ModelKernel& kernel_;
  const evaluation::FieldStructure* structure_ = nullptr;
  evaluation::AffineRows gradients_;                ///< of the switching functions
  std::vector<std::vector<std::size_t>> of_state_;  ///< surfaces whose gradient has it
  const ModeState* mode_ = nullptr;
  std::vector<double> alpha_;            ///< n_psi, of the mode and the last evaluation, where something slides there
  const double* selections_ = nullptr;   ///< these, or those of the mode
  std::vector<bool> inside_, is_input_;  ///< by state
  std::vector<std::size_t> rows_, inputs_, border_;
  std::vector<Slid> selected_;     ///< surfaces whose selections the rows hold
  std::vector<Slid> held_;         ///< those whose states are in the part
  std::vector<double> x_, slope_;  ///< n_x, of which a part is used
};

}  // namespace saltus::event_integrator
