// A run in progress: the state of the engine between its sources. integrate.cpp begins and ends it, run_steps.cpp takes
// the steps, run_events.cpp handles what they meet.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "saltus/event_integrator/event_search.hpp"
#include "saltus/event_integrator/integrate.hpp"
#include "saltus/event_integrator/locate.hpp"
#include "saltus/event_integrator/mode_field.hpp"
#include "saltus/event_integrator/recorder.hpp"
#include "saltus/event_integrator/single_surface.hpp"
#include "saltus/event_integrator/small_internal.hpp"
#include "saltus/event_integrator/switch_series.hpp"
#include "saltus/event_integrator/transition.hpp"
#include "saltus/event_integrator/user_events.hpp"
#include "saltus/ode/step_control.hpp"

namespace saltus::event_integrator {

/// The run in progress: where it is, and the work spaces of its parts. One object per call of integrate().
class Run {
 public:
  Run(const evaluation::ModelKernel& kernel, const model::System& system, const IntegrationOptions& options,
      const StepObserver& observer);

  Integration to_end();

 private:
  enum class Step { taken, shortened, failed };

  bool begin();
  Step attempt();
  Step undefined_step();
  Step accept(double t_new);
  Step handle(const Located& located);
  bool change_mode(const Located& located);
  bool enter(const Transition& transition);
  bool fire_user_events(const ModeState& before);
  void flip_user_functions(const Located& located);
  bool too_many_events();
  void accumulates();
  bool stopped_by_two_fold();
  bool stopped_by_singularity();
  bool shorten(double factor);
  void rows_until(double t_end);
  void row(double t, const std::vector<double>& x);
  void fail(result::Termination termination, std::string message);
  /// Below this a step is no longer seen in t.
  [[nodiscard]] double smallest_step() const {
    return std::max(4.0 * rounding_unit * std::abs(t_), std::numeric_limits<double>::min());
  }
  [[nodiscard]] double span() const { return options_.until - options_.from; }
  [[nodiscard]] std::string where() const;

  auto right_hand_side() {
    return [this](double t, const double* x, double* xdot) { field_(t, x, xdot); };
  }

  const evaluation::ModelKernel& kernel_;
  const IntegrationOptions& options_;
  const StepObserver& observer_;
  Surroundings surroundings_;
  ModeField field_;
  ode::Stepper stepper_;
  ode::StepControl control_;
  ode::StiffnessWatch stiffness_;
  ode::Tolerances tolerances_;  ///< of a step
  ode::DenseStep dense_;
  EventSearch search_;
  Locator locator_;
  SingleSurface single_surface_;
  UserEvents user_events_;
  Recorder recorder_;

  double t_;
  std::vector<double> x_, slope_;
  std::vector<double> row_x_, row_slope_;
  ModeState state_;
  ModeState before_;  ///< of the event being handled, as are the next three
  std::vector<double> x_before_;
  Occasion occasion_;
  Transition transition_;
  std::optional<double> stiff_at_;  ///< where the explicit method first looked out of place
  double h_ = 0.0;                  ///< proposed step
  double h_try_ = 0.0;              ///< step under trial
  double h_scale_ = 0.0;            ///< of the last full step: time scale of the second-order sign tests
  std::size_t next_output_ = 0;
  double last_event_time_ = -std::numeric_limits<double>::infinity();
  SwitchSeries series_;
  Integration result_;
  bool running_ = true;
};

}  // namespace saltus::event_integrator
