// Rows and events of a run, in the columns of the result.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/event_integrator/choices.hpp"
#include "saltus/event_integrator/mode_state.hpp"
#include "saltus/event_integrator/transition.hpp"
#include "saltus/model/system.hpp"
#include "saltus/result/result.hpp"

namespace saltus::event_integrator {

/// States and modes on both sides of an event.
struct Passage {
  const std::vector<double>& x;
  const std::vector<double>& x_after;
  const ModeState& before;
  const ModeState& after;
};

/// One execution of a jump.
struct ExecutedJump {
  int jump = 0;
  std::vector<double> x, x_after;
};

class Recorder {
 public:
  Recorder(const evaluation::ModelKernel& kernel, const model::System& system);

  /// One row; `alpha` over switching functions (the sliding values at this point).
  void row(double t, const std::vector<double>& x, const std::vector<int>& mode, const std::vector<double>& alpha);
  /// A switch, if a listed switching function changes its mode; returns whether it did.
  bool switched(double t, const std::vector<double>& x, const ModeState& before, const Transition& transition);
  /// A start on a surface or in a forced mode; `surfaces` at zero. Returns whether any of them is listed.
  bool started(double t, const std::vector<double>& x, const Transition& transition, const std::vector<int>& surfaces);
  /// An event of [[events]].
  void user(double t, const Passage& passage, int event);
  /// Jumps executed at t one after the other; `transition` is the mode behind the last one, `before` absent at a start.
  void jumped(double t, const std::vector<ExecutedJump>& jumps, const std::optional<ModeState>& before,
              const Transition& transition);
  /// The limit of a sequence of jumps, from the last computed state.
  void accumulated(double t, const std::vector<int>& jumps, const Passage& passage, std::string reason);
  /// The limit of a sequence of switches of these surfaces, from the last computed state; `transition` leads on.
  void spiralled(double t, const std::vector<int>& surfaces, const Passage& passage, const Transition& transition);

  [[nodiscard]] std::vector<result::Event> take_events() { return std::move(events_); }
  [[nodiscard]] result::Trajectory take_trajectory() { return std::move(trajectory_); }
  [[nodiscard]] std::vector<BranchPoint> take_branch_points() { return std::move(branch_points_); }
  [[nodiscard]] bool ends_at(double t) const { return !trajectory_.t.empty() && trajectory_.t.back() == t; }
  [[nodiscard]] long events() const { return static_cast<long>(events_.size()); }
  [[nodiscard]] std::size_t rows() const { return trajectory_.t.size(); }

 private:
  [[nodiscard]] result::Mode mode_columns(const std::vector<int>& mode, const std::vector<double>& alpha) const;
  [[nodiscard]] std::vector<double> alpha_columns(const std::vector<double>& alpha) const;
  [[nodiscard]] std::optional<result::Intersection> intersection(const Meeting& meeting, const ModeState& after) const;
  void add_transition(result::Event event, const Transition& transition);

  const evaluation::ModelKernel& kernel_;
  const model::System& system_;
  result::Trajectory trajectory_;
  std::vector<result::Event> events_;
  std::vector<BranchPoint> branch_points_;
};

}  // namespace saltus::event_integrator
