// Functions that are near zero where a step cannot say so: the field has a root of them, or is undefined behind them.
#pragma once

#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "saltus/event_integrator/decide/transition.hpp"
#include "saltus/event_integrator/field/mode_field.hpp"
#include "saltus/event_integrator/mode/field_rates.hpp"
#include "saltus/event_integrator/search/event_search.hpp"
#include "saltus/event_integrator/search/locate.hpp"

namespace saltus::event_integrator {

/// ZeroApproach asks for the functions of the mode at the position itself, where steps get too short to be searched.
class ZeroApproach {
 public:
  ZeroApproach(const SwitchingContext& switching_context, const Position& here, ModeField& field, EventSearch& search);

  /// Returns the values of all functions that are searched; valid until the next call of anything here.
  const std::vector<double>& functions(double t, const double* x);
  /// Returns whether there are surfaces whose regions' fields have a root of them. The fields of some go on beyond
  /// them, those of others end there.
  [[nodiscard]] bool any_continued() const { return !continued_.empty(); }
  [[nodiscard]] bool any_ending() const { return !ending_.empty(); }
  [[nodiscard]] bool ends_at(int surface) const;
  /// Returns what errors of a step of length h may be beside roots, as parts of those of the mode.
  /// @param cycle  the duration of the last cycle of switches while these contract
  [[nodiscard]] ode::Tolerances bearable(double h, std::optional<double> cycle, const ode::Tolerances& mode);
  /// Returns a surface that the state cannot come nearer to, as its next digit is on it or behind it.
  [[nodiscard]] std::optional<Located> within_rounding();
  /// Returns a surface before `until` that psi, of terms far larger than it is, has a few roundings left to: the root
  /// of what rounding makes of these says nothing any more, and steps that stay on this side may change nothing.
  [[nodiscard]] std::optional<Located> ahead(double until);
  /// Returns what is reached where the right-hand side is undefined however short the step.
  [[nodiscard]] std::optional<Located> beside_undefined();
  /// Returns whether a surface that no step gets to is one that its own field leads away from: beside a root of psi a
  /// dense output dips below zero where the solution only comes near.
  [[nodiscard]] bool is_repelled(const Located& located);
  /// Returns a surface that is at zero here, beside which the field has an infinite derivative; -1 if there is none.
  [[nodiscard]] int root_here();
  /// Does the same at most once at each time.
  [[nodiscard]] int root_here_once();
  /// Returns whether no function but that of `surface` changes its sign between the position and (t, x).
  [[nodiscard]] bool keep_their_signs(int surface, double t, const double* x);
  /// Returns the surfaces that are zero here, as far as the tolerances tell; with their signs before.
  [[nodiscard]] std::vector<const EventFunction*> unresolved();
  /// Forgets what was asked: something has happened, or a search has found the roundings of functions anew.
  void forget() { none_at_.reset(); }

 private:
  template <class Take>
  void each_near(double roundings, Take take);
  [[nodiscard]] Located onto(std::size_t function, double left) const;

  const SwitchingContext& switching_context_;
  const evaluation::ModelKernel& kernel_;
  const Position& here_;
  ModeField& field_;
  EventSearch& search_;
  FieldRates rates_;
  std::vector<int> continued_, ending_;
  std::vector<std::size_t> all_;       ///< the numbers of all functions that are searched
  std::vector<double> values_;         ///< of these
  std::vector<double> kernel_values_;  ///< of event functions
  std::optional<double> none_at_;      ///< where within_rounding() has found none
  double root_asked_at_ = -INFINITY;
};

}  // namespace saltus::event_integrator
