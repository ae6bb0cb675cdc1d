// The event functions of a mode, and their first zero along a step: none is missed, none is found twice.
#pragma once

#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/event_integrator/field/mode_field.hpp"
#include "saltus/event_integrator/jumps/holding.hpp"
#include "saltus/event_integrator/mode/mode_state.hpp"
#include "saltus/event_integrator/mode/position.hpp"
#include "saltus/event_integrator/point/ledger.hpp"
#include "saltus/event_integrator/search/mode_functions.hpp"
#include "saltus/event_integrator/search/search_values.hpp"
#include "saltus/event_integrator/search/step_errors.hpp"
#include "saltus/ode/bernstein.hpp"
#include "saltus/ode/stepper.hpp"

namespace saltus::event_integrator {

/// Holds a sign change along a step of length h: function, place and slope to start the correction with.
struct Hit {
  std::size_t function = 0;
  double theta = 0.0;
  double slope = 0.0;  ///< d phi / dt there
  int sign = 1;        ///< of the function before
  int doubts = 0;      ///< so many steps, each half as long, have to show it, too, as it may be an error of the step
};

enum class SearchOutcome {
  none,
  hit,
  unresolved,  ///< an event function is too wild for its interpolants, or undefined: shorten the step
};

/// Searches one step after the other, in two stages. First bounds of the states over the step show that almost no
/// function can vanish: those that are affine in (t, x), which includes the exits of sliding modes with affine fields.
/// Of functions that are not affine their ranges over these bounds do. The exact search is left with the others.
/// Owns the work space; allocates in enter() only.
class EventSearch {
 public:
  EventSearch(const evaluation::ModelKernel& kernel, ModeField& field, Ledger& ledger, ode::Method method,
              const ode::Tolerances& tolerances);  ///< those of the steps, kept as a reference

  /// Goes on with dense outputs of another method.
  void follow(ode::Method method) { five_nodes_suffice_ = ode::dense_degree(method) <= 4; }
  /// Sets up the functions of a mode at (t, x), after an evaluation of the field there. `zero_order` (n_psi): zeros
  /// that surfaces have at this point; those of user functions, and their signs, are in the ledger.
  void enter(const ModeState& state, const std::vector<int>& zero_order, double t, const double* x);
  /// Does the same at the position, where a mode begins behind a change. Cost: O(1) where one surface is crossed while
  /// nothing is slid on, and the thresholds of the same state.
  void begin(const ModeChange& change, const Position& here);
  /// Returns whether crossings change signs of surfaces only.
  [[nodiscard]] bool crosses() const { return mode_.plain && mode_.state.sliding.empty() && held_.guards.empty(); }
  /// Returns whether the last attempt of the stepper has to be searched: false only where search() would find nothing.
  [[nodiscard]] bool may_vanish(const ode::Stepper& stepper);
  /// Says how a hit is located: by steps of other lengths, or along this dense output.
  enum class Location { retaken, along };
  /// Finds the first sign change in (0, 1] of any function.
  SearchOutcome search(const ode::DenseStep& step, Location location, Hit& hit);
  /// Returns, behind a hit, the functions that may vanish within the step, or close by; ascending.
  [[nodiscard]] const std::vector<std::size_t>& candidates() const { return candidates_; }
  /// Evaluates some functions at one point, less their offsets.
  void evaluate(double t, const double* x, const std::vector<std::size_t>& which, std::vector<double>& values);

  [[nodiscard]] const std::vector<EventFunction>& functions() const { return mode_.functions; }
  /// Returns whether a function belongs to [[events]]: nothing of the motion depends on it.
  [[nodiscard]] bool is_listed_only(std::size_t function) const {
    const auto& entry = mode_.functions[function];
    return entry.kind == FunctionKind::user && kernel_.is_listed_only(entry.index);
  }
  /// Finds the rounding of a candidate: at the start of the step, or where rescale() was called last.
  void rescale(double t, const double* x) { rescale(t, x, candidates_); }
  [[nodiscard]] double noise(std::size_t function) const { return levels_.noise[function]; }
  /// Returns d phi / dt of an exit along f (n_x), the field of its side; nullopt where it has no affine form, or is no
  /// more than its rounding. Cost: the terms of the form.
  [[nodiscard]] std::optional<double> exit_rate(std::size_t function, const std::vector<double>& f) const {
    return mode_.forms.has(function) ? mode_.forms.rate_along(function, f.data()) : std::nullopt;
  }
  /// Returns what the tolerances leave of it, at least its rounding.
  [[nodiscard]] double accuracy(std::size_t function) const { return levels_.accuracy[function]; }
  /// Returns whether a value of an expression or guard of [[events]] is no more than the errors of steps, so that its
  /// sign says nothing; false for other functions of the kernel.
  [[nodiscard]] bool is_within_errors(int function, double value, double t, const double* x);
  /// Settles an accepted step that ends at (t, x): zeros at its start are history, unknown signs are read. Returns
  /// whether there were such signs.
  bool settle(double t, const double* x);
  /// Takes over zeros of user functions at (t, x), and their signs, from the ledger: the mode goes on with them. What
  /// is left of a value at its zero is subtracted.
  void turn_users(double t, const double* x);
  /// Holds guards of jumps: they are not searched, their releases are. Takes effect with the next enter().
  void set_held(HeldGuards held) { held_ = std::move(held); }
  /// Tells that the next enter() is at the end of a cell that was just entered there.
  void entered_cell(const EventFunction& reached);

 private:
  struct Finding {
    bool resolved = true;
    std::optional<Hit> hit;
  };
  void start_at(double t);
  [[nodiscard]] bool specials_leave(const ode::Stepper& stepper);
  void enter_surfaces(const ModeState& state, const std::vector<int>& zero_order);
  void enter_exits(const ModeState& state, double t, const double* x);
  void enter_plain_exits(const double* x);
  void enter_users();
  void size_work();
  void enter_nested(const ModeState& state, const std::vector<int>& zero_order);
  void load_rows();
  void set_forms(const double* x);
  void sort_functions();
  void rescale(double t, const double* x, const std::vector<std::size_t>& which) {
    rescale(t, x, which, mode_.parts_of(which));
  }
  void rescale(double t, const double* x, const std::vector<std::size_t>& which, const FunctionParts& parts);
  void set_noise(std::size_t i, const double* x);
  void evaluate_parts(double t, const double* x, const FunctionParts& parts);
  [[nodiscard]] double value(std::size_t i, const double* x) const;
  [[nodiscard]] bool has_same_functions(const ModeState& state) const;
  void renew(const std::vector<int>& zero_order, double t, const double* x);
  [[nodiscard]] bool is_plain(const ModeState& state) const;
  bool move(const ModeState& state, const std::vector<int>& zero_order, double t, const double* x);
  void turn(std::size_t surface, const ModeState& state, int zero_order);
  void finish_move(const ModeState& state, double t, const double* x);
  void move_exits(double t, const double* x);
  [[nodiscard]] bool exits_change(std::size_t row, const double* x) const;
  void renew_exits(std::size_t row, const double* x);
  void read_start(double t, const double* x);
  void read_values(double t, const double* x, const std::vector<std::size_t>& which);
  void sort(std::size_t i);
  void find_candidates();
  SearchOutcome search_interval(const ode::DenseStep& step, double from, double to, int depth, Hit& hit);
  [[nodiscard]] Finding find_along(const ode::DenseStep& step, std::size_t i) const;
  Finding find(const ode::DenseStep& step, double from, double to, std::size_t i);
  [[nodiscard]] bool may_be_an_error(const ode::DenseStep& step, const Hit& hit) const;
  [[nodiscard]] bool is_rounding(const ode::DenseStep& step, const Hit& hit);
  [[nodiscard]] bool is_confirmed(const ode::DenseStep& step, const Hit& hit);
  Finding find_clear(const ode::DenseStep& step, double from, double to, std::size_t i);
  template <class Take>
  void take_coefficients(const ode::DenseStep& step, double from, double to, std::size_t i, Take take) const;
  /// Of one function over an interval, known to be of `sign` at its start.
  struct Interpolant {
    const std::array<double, ode::event_nodes>& values;
    const ode::BernsteinCoefficients& coefficients;
    int sign;
    double size;  ///< of the largest coefficient
  };
  bool is_resolved(const ode::DenseStep& step, double from, double to, std::size_t i, const Interpolant& interpolant);
  static Finding not_finite(const EventFunction& function, double at_start);
  [[nodiscard]] Finding find_in_series(const ode::DenseStep& step, double from, double to, std::size_t i) const;
  bool misses(const ode::DenseStep& step, double from, double to, std::size_t i,
              const ode::BernsteinCoefficients& coefficients, double accuracy);
  [[nodiscard]] bool is_far(std::size_t i) const;
  [[nodiscard]] bool are_away_at_start() const;
  [[nodiscard]] bool clearly_keeps_sign(const ode::DenseStep& step, std::size_t i);
  bool find_near();
  [[nodiscard]] bool stays_away(std::size_t i) const;
  void find_suspects(const ode::DenseStep& step);
  /// Every so many from the first one on.
  struct Nodes {
    std::size_t first = 0;
    std::size_t stride = 1;
  };
  void sample(const ode::DenseStep& step, double from, double to, const std::vector<std::size_t>& which, Nodes nodes);
  [[nodiscard]] double node_theta(double from, double to, std::size_t node) const;
  void limit_by_tangency(std::size_t i, double t, const double* x);
  void read_user_signs(double t, const double* x);
  void find_pressure(double t, const double* x);
  void enter_cells();

  const evaluation::ModelKernel& kernel_;
  ModeField& field_;
  bool five_nodes_suffice_;  ///< the dense output has degree 4: five samples determine an affine function
  StepErrors errors_;
  ModeFunctions mode_;  ///< of the mode that was entered last
  Ledger& ledger_;
  HeldGuards held_;
  KernelValues values_;
  std::vector<int> entered_;  ///< by cell: event function of the end at which it was entered, or -1
  std::vector<double> x_, point_;
  std::array<std::vector<double>, 3>
      checks_;                   ///< values between the nodes, of an interval; empty before they are asked for
  std::vector<double> samples_;  ///< node by node
  FunctionLevels levels_;
  StepRange range_;
  std::vector<bool> nesting_;          ///< functions of the kernel that hold selections
  evaluation::AffineRows rows_;        ///< at the selections of the mode
  std::vector<std::size_t> special_;   ///< functions with an unknown sign, or a zero at the start of the next step
  std::vector<std::size_t> suspects_;  ///< of this step, ascending
  std::vector<std::size_t> sampled_;   ///< functions without a form that may vanish in this step; of them the suspects
  std::vector<std::size_t> candidates_;  ///< of this step, ascending
  std::vector<std::size_t> inspected_;   ///< at the start of a mode: those whose values matter there
  TurnedSurfaces turned_;                ///< likewise
  bool any_nesting_ = false;             ///< some functions of the kernel hold selections
  bool only_signs_change_ = false;       ///< where the mode that was entered last begins anew
};

}  // namespace saltus::event_integrator
