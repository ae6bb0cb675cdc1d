// The exact time of an event: the step is retaken until the event function is at rounding level.
#pragma once

#include <cmath>
#include <optional>
#include <vector>

#include "saltus/event_integrator/field/mode_field.hpp"
#include "saltus/event_integrator/search/event_search.hpp"
#include "saltus/ode/stepper.hpp"

namespace saltus::event_integrator {

/// Holds everything a step from it needs.
struct StepStart {
  double t = 0.0;
  const double* x = nullptr;
  const double* slope = nullptr;  ///< f(t, x)
};

/// Holds an event reached from a step start: x on the sliding surfaces of the mode, and all functions that vanish
/// there.
struct Located {
  double t = 0.0;
  std::vector<double> x;
  std::vector<std::size_t> functions;  ///< the one located first, then those that vanish together with it
  std::vector<int> signs;              ///< of `functions` before the event
  bool short_of = false;               ///< more than its rounding is left of the first one: no step gets it to zero
};

/// Corrects hits found on the dense output of a step. Owns its work space; allocates only for more functions than
/// before.
class Locator {
 public:
  Locator(int states, ode::Stepper& stepper, ModeField& field, EventSearch& search, const ode::Tolerances& tolerances);

  /// Locates the event of a hit on the dense output of the step (start, dense.h). The step is retaken to the zero of
  /// the interpolant, so the order of the method is kept. What is then left is moved along the field where it is so
  /// little that two stages are as good as the method; otherwise Newton in t with the slope of the interpolant,
  /// safeguarded by the bracket of signs seen, retakes the step. Of several functions the earliest zero is located;
  /// those that vanish with it to rounding are one event.
  /// @return nullptr if the right-hand side is undefined up to the event, or the function does not get to zero but
  ///         touches it (shorten the step); valid until the next call.
  /// Cost: usually one step and one evaluation of f.
  [[nodiscard]] const Located* locate(const StepStart& start, const ode::DenseStep& dense, Hit hit);

 private:
  /// One event under correction: the state at the end of the retaken step, and the values of all candidates there.
  struct Trial {
    double h = 0.0;
    std::vector<double> x;
    std::vector<double> values;
  };
  void sharpen();
  void evaluate(double t, const double* x, std::vector<double>& values);
  bool take(double h);
  void find_slope();
  bool correct(const Hit& hit);
  bool finish(double slope);
  bool move(double dt);
  void set_hit(const Hit& hit);
  bool has_arrived(double value, double slope);
  [[nodiscard]] bool is_finite_at(const Trial& trial) const { return std::isfinite(trial.values[place_]); }
  double look_back();
  void look_ahead();
  void find_vanishing_with(std::size_t located);
  void find_same_at_start(std::size_t located);
  [[nodiscard]] bool vanishes(double value) const;
  /// Its place among the candidates.
  [[nodiscard]] std::optional<std::size_t> earlier_function(std::size_t located) const;
  [[nodiscard]] int sign(std::size_t function) const {
    return function == hit_.function ? hit_.sign : search_.functions()[function].sign;
  }
  [[nodiscard]] double time_resolution() const;

  ode::Stepper& stepper_;
  ModeField& field_;
  EventSearch& search_;
  const ode::Tolerances& tolerances_;
  std::size_t n_;
  StepStart start_;
  const ode::DenseStep* dense_ = nullptr;
  Hit hit_;
  bool touches_ = false;   ///< the function of the hit is far from zero where the trial ends: it only touches zero
  bool flat_ = false;      ///< a multiple zero
  std::size_t place_ = 0;  ///< of its function among the candidates
  double left_ = 0.0;      ///< its offset, where it has moved away from the zero at the start
  Trial trial_, moved_;
  std::vector<double> slope_, slope_ahead_;  ///< f at the end of the trial, and just ahead of it
  bool has_slope_ = false;                   ///< the first one is known
  std::vector<double> x_, beside_;
  Located located_;
};

}  // namespace saltus::event_integrator
