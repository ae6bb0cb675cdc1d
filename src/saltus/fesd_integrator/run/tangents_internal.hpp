// What sensitivities are told of a run, where somebody asks for them.
#pragma once

#include <cstddef>
#include <optional>
#include <utility>

#include "saltus/fesd_integrator/run/chain_internal.hpp"
#include "saltus/fesd_integrator/run/context_internal.hpp"
#include "saltus/fesd_integrator/run/position_internal.hpp"
#include "saltus/fesd_integrator/tangent/sensitivities.hpp"

namespace saltus::fesd_integrator {

/// Tells SensitivityPropagation what closes the elements that are accepted: a condition, a time event or a fixed end.
/// Without one it does nothing.
class Tangents {
 public:
  /// All must outlive it; nullptr if nobody asks for sensitivities.
  Tangents(const RunContext& context, const Position& position, SensitivityPropagation* propagation)
      : context_(context), position_(position), propagation_(propagation) {}

  [[nodiscard]] bool asked() const { return propagation_ != nullptr; }
  /// Notes what is held, if its change ends the part of a simulation step that is under way.
  void set_time_event(double t, std::optional<std::size_t> changing);

  /// Follows a chain of elements. `closing`: the condition that is zero at the end of the elements; nullptr if the end
  /// is fixed.
  void chain(Chain& chain, std::size_t count, double end, const Condition* closing);
  /// Notes a switch right where the last chain ended.
  void switched_here(const Condition& condition);
  void begin_fixed_steps(int count, double end);
  void fixed_step(const Element& element, std::span<const ActiveSet> sets, double part);
  void held_changed(const double* before);

 private:
  [[nodiscard]] std::optional<std::size_t> changing_at(double end) const {
    return event_ == end ? changing_ : std::nullopt;
  }

  const RunContext& context_;
  const Position& position_;
  SensitivityPropagation* propagation_;
  double event_ = 0.0;
  std::optional<std::size_t> changing_;
  bool ends_fixed_ = false;  ///< the last chain, neither by a switch nor by a time event
};

}  // namespace saltus::fesd_integrator
