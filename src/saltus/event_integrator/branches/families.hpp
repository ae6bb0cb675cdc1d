// Families of other solutions: those that leave the mode of a run at a later time, and spirals of other phases.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "saltus/base/function_ref.hpp"
#include "saltus/event_integrator/decide/transition.hpp"
#include "saltus/event_integrator/record/recording.hpp"
#include "saltus/switching/hidden/group_modes.hpp"

namespace saltus::event_integrator {

/// Watches the mode of a run for other modes that its surfaces admit, in the sense of Definition 2.1 of
/// [guglielmi2022], as long as they do:
///   - a surface that repels on both sides and is slid on alone, to either side (f_below < 0 < f_above, which holds
///     until the mode ends);
///   - two or three that influence each other, into every other mode of admissible_modes(), other roots among them.
/// Other surfaces (four and more that influence each other, borders of regions, selections that enter other than
/// affinely) are not watched.
class Families {
 public:
  /// Holds a family that may be left now.
  struct Open {
    std::vector<GivenMode> given;  ///< modes of its surfaces
    std::size_t number = 0;        ///< in the run
  };
  /// Holds what is looked at: a point of the run.
  struct Point {
    double t = 0.0;
    const double* x = nullptr;
    double time_scale = 1.0;
  };

  explicit Families(const SwitchingContext& switching_context);

  /// Enters a mode, or another root of it, that begins at the last event; `unique` says that no single surface of it
  /// can repel.
  void enter(const Point& point, const ModeState& state, std::size_t event, std::optional<bool> unique);
  /// Returns whether the mode of the last enter() has to be looked at step by step.
  [[nodiscard]] bool watches() const { return !groups_.empty(); }
  /// Returns whether a change of mode is nothing to it.
  [[nodiscard]] bool idle() const { return open_.empty() && groups_.empty(); }
  /// Finds, behind a step from t_begin, what can be left now, and what no more. `state_at` gives the states in between.
  void look(const Point& point, double t_begin, FunctionRef<void(double t, double* x)> state_at);
  /// Adds the spirals from an event that is recorded next.
  void add_spirals(double t, std::size_t event, const Transition& transition);
  /// Closes all that are open, at the end of a run.
  void close(double t);

  [[nodiscard]] std::size_t count() const { return recorded_.size(); }
  [[nodiscard]] const std::vector<Open>& open() const { return open_; }
  /// Returns whether this is the mode that is watched, with the root that is slid on.
  [[nodiscard]] bool is_on(const ModeState& state) const;
  /// Hands over the families in the order of their numbers.
  [[nodiscard]] std::vector<Recording::Family> take() { return std::move(recorded_); }

 private:
  using Modes = std::vector<switching::GroupMode>;
  enum class Root { any, other };  ///< that a mode begins with: of a new mode, or the other one of the same mode
  /// Surfaces that influence each other, ascending, and no others.
  struct Group {
    std::vector<int> surfaces;
    std::vector<double> alpha;  ///< of the root that is slid on, as it was last
    std::vector<std::vector<int>> refused;
  };

  [[nodiscard]] bool is_watched(int surface) const;
  [[nodiscard]] bool is_alone(int surface) const;
  void find_groups();
  void close_those_that_ended(double t, Root root);
  void add(const Point& point, std::vector<GivenMode> given, double from);
  void watch_singles(const Point& point);
  void watch(const Point& point, Group& group, double t_begin, FunctionRef<void(double t, double* x)> state_at);
  [[nodiscard]] Modes modes_at(double t, const double* x, const std::vector<int>& surfaces);
  [[nodiscard]] Modes others_at(double t, const double* x, Group& group);
  double change(double t_begin, double t_end, const Group& group, const std::vector<int>& mode,
                FunctionRef<void(double t, double* x)> state_at);

  const SwitchingContext& s_;
  ModeState state_;
  std::size_t event_ = 0;
  std::vector<Group> groups_;
  std::vector<Open> open_;
  std::vector<Recording::Family> recorded_;
  std::vector<double> alpha_, f_, row_, x_;
  switching::CornerTable table_;
};

}  // namespace saltus::event_integrator
