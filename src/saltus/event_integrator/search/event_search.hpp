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
#include "saltus/event_integrator/search/affine_forms.hpp"
#include "saltus/ode/bernstein.hpp"
#include "saltus/ode/stepper.hpp"

namespace saltus::event_integrator {

enum class FunctionKind {
  surface,      ///< psi_j of a surface that is not in the mode
  nested,       ///< psi_j nested around sliding surfaces, in one of the regions that meet there
  exit_below,   ///< the lower field of a sliding surface stops arriving: alpha = 0
  exit_above,   ///< … the upper one: alpha = 1
  loss,         ///< the sliding selection ceases to exist: its root and another one coalesce
  instability,  ///< the sliding selections of coupled surfaces lose their stability, (4.12) of [guglielmi2022]
  user,         ///< expression or guard of [[events]], guard of [[jumps]]
  release,      ///< what presses a held guard of [[jumps]]
  cell_upper,   ///< argument of floor, a table or a sampled input less the upper end of its cell
  cell_lower,   ///< … less the lower end
};

struct EventFunction {
  FunctionKind kind = FunctionKind::surface;
  int index = 0;  ///< event function of the kernel; the surface for exits
  int row = 0;   ///< exits: position in the sliding set; releases: in the list of held guards; ends of cells: the cell;
                 ///< nested functions: their region
  int sign = 1;  ///< while the mode lasts; 0 = not known yet (user functions that start at zero)
  int zero_order = 0;   ///< of the zero at the start of the next step (left behind by an event), 0 = none
  double offset = 0.0;  ///< value left at that zero by rounding; subtracted until the function has moved away

  /// Whether a value, less the offset, is far enough from that zero not to be mistaken for it.
  [[nodiscard]] bool has_left(double value) const { return sign * value > 2.0 * std::abs(offset); }
};

/// A sign change along a step of length h: function, place and slope to start the correction with.
struct Hit {
  std::size_t function = 0;
  double theta = 0.0;
  double slope = 0.0;  ///< d phi / dt there
  int sign = 1;        ///< of the function before
};

enum class SearchOutcome {
  none,
  hit,
  unresolved,  ///< an event function is too wild for its interpolants, or undefined: shorten the step
};

/// Searches one step after the other, in two stages. First bounds of the states over the step show that almost no
/// function can vanish: those that are affine in (t, x), which includes the exits of sliding modes with affine fields.
/// The exact search is left with the others, and with functions that are not affine.
/// Owns the work space; allocates in enter() only.
class EventSearch {
 public:
  EventSearch(const evaluation::ModelKernel& kernel, ModeField& field, ode::Method method,
              const ode::Tolerances& tolerances);

  /// Sets up the functions of a mode at (t, x). `zero_order` (n_psi): zeros that surfaces have at this point.
  void enter(const ModeState& state, const std::vector<int>& zero_order, double t, const double* x);
  /// The same, in a model without nesting, cells, regions, user functions and jumps: modes that slide on what one of
  /// the last modes has slid on need their signs only.
  void enter_again(const ModeState& state, const std::vector<int>& zero_order, double t, const double* x);
  /// The same where one surface was crossed since, with no sliding before and behind; only while crosses(). Cost: O(1),
  /// and the thresholds of the same state.
  void cross(std::size_t surface, const ModeState& state, double t, const double* x);
  /// The same where one surface was crossed since while the solution slides on one other, behind an evaluation of the
  /// field here. Returns false where the mode has to be entered afresh.
  [[nodiscard]] bool pass(std::size_t surface, const ModeState& state, double t, const double* x);
  /// Whether crossings change signs of surfaces only.
  [[nodiscard]] bool crosses() const { return flips_ && state_.sliding.empty() && held_.empty(); }
  /// Whether the last attempt of the stepper has to be searched: false only where search() would find nothing.
  [[nodiscard]] bool may_vanish(const ode::Stepper& stepper);
  /// The first sign change in (0, 1] of any function.
  SearchOutcome search(const ode::DenseStep& step, Hit& hit);
  /// Behind a hit: the functions that may vanish within the step, or close by; ascending.
  [[nodiscard]] const std::vector<std::size_t>& candidates() const { return candidates_; }
  /// Values of some functions at one point, less their offsets.
  void evaluate(double t, const double* x, const std::vector<std::size_t>& which, std::vector<double>& values);

  [[nodiscard]] const std::vector<EventFunction>& functions() const { return functions_; }
  /// Rounding of a candidate: at the start of the step, or where rescale() was called last.
  void rescale(double t, const double* x) { rescale(t, x, candidates_); }
  [[nodiscard]] double noise(std::size_t function) const { return noise_[function]; }
  /// d phi / dt of an exit along f (n_x), the field of its side; nullopt where it has no affine form, or is no more
  /// than its rounding. Cost: the terms of the form.
  [[nodiscard]] std::optional<double> exit_rate(std::size_t function, const std::vector<double>& f) const {
    return forms_.has(function) ? forms_.rate_along(function, f.data()) : std::nullopt;
  }
  /// What the tolerances leave of it, at least its rounding.
  [[nodiscard]] double accuracy(std::size_t function) const { return accuracy_[function]; }
  /// Signs of the user functions in force, 0 where not known yet.
  [[nodiscard]] const std::vector<int>& user_signs() const { return user_sign_; }
  /// Which of them vanish at the start of the next step.
  [[nodiscard]] const std::vector<bool>& user_zeros() const { return user_vanishes_; }
  /// Behind an accepted step that ends at (t, x): zeros at its start are history, unknown signs are read. Returns
  /// whether there were such signs.
  bool settle(double t, const double* x);
  /// Behind a jump: the signs of all user functions, 0 = not known, whether they vanish here, and with which orders (in
  /// t; 1 without). Takes effect with the next enter().
  void set_user_signs(const std::vector<int>& signs, const std::vector<bool>& vanish,
                      const std::vector<int>& orders = {});
  /// Time has passed since the user functions were at zero, or they have jumped.
  void forget_user_zeros() { user_vanishes_.assign(user_vanishes_.size(), false); }
  /// Held guards of jumps are not searched, their releases are. Takes effect with the next enter().
  void set_held(std::vector<HeldGuard> held, std::vector<HeldGuard> followers) {
    held_ = std::move(held);
    followers_ = std::move(followers);
  }
  /// The next enter() is at the end of a cell that was just entered there.
  void entered_cell(const EventFunction& reached);
  /// Sets the sign of a user function that vanishes at (t, x); it is kept there whatever is left of its value.
  void set_user_sign(std::size_t function, int sign, double t, const double* x);

 private:
  struct Finding {
    bool resolved = true;
    std::optional<Hit> hit;
  };
  /// What values of some functions are made of: event functions of the kernel, in the regions of nested ones, exits,
  /// and what presses held guards. The others are thresholds.
  struct Parts {
    bool phi = false;
    bool nested = false;
    bool exits = false;
    bool pressure = false;
  };

  /// The functions of a mode, as a later one with the same sliding set can use them: see the members.
  struct Kept {
    ModeState state;
    std::vector<EventFunction> functions;
    std::vector<ExitValues> exits;
    AffineForms forms;
    std::vector<std::size_t> curved, of_surface;
    Parts curved_parts;
    std::size_t first_exit = 0, users = 0, users_end = 0;
    bool flips = false;
    std::vector<bool> prefilter;
  };

  void exchange(Kept& kept);
  void keep();
  void start_at(double t);
  [[nodiscard]] bool specials_leave(const ode::Stepper& stepper);
  void enter_surfaces(const ModeState& state, const std::vector<int>& zero_order);
  void enter_exits(const ModeState& state, double t, const double* x);
  void enter_users();
  void size_work();
  void enter_nested(const ModeState& state, const std::vector<int>& zero_order);
  void load_rows();
  void set_forms(const double* x);
  void sort_functions();
  void rescale(double t, const double* x, const std::vector<std::size_t>& which) {
    rescale(t, x, which, parts_of(which));
  }
  void rescale(double t, const double* x, const std::vector<std::size_t>& which, const Parts& parts);
  void set_noise(std::size_t i, const double* x);
  /// Whether a form of one state stands for function i wherever it is evaluated.
  [[nodiscard]] bool is_threshold(std::size_t i) const {
    const auto kind = functions_[i].kind;
    return (kind == FunctionKind::surface || kind == FunctionKind::user) && forms_.is_threshold(i);
  }
  [[nodiscard]] Parts parts_of(const std::vector<std::size_t>& which) const;
  void evaluate_parts(double t, const double* x, const Parts& parts);
  [[nodiscard]] double value(std::size_t i, const double* x) const;
  [[nodiscard]] std::size_t exit_function(std::size_t row) const { return first_exit_ + 2 * row; }
  bool turn_exits(const double* x);
  void forget_specials();
  void turn(std::size_t surface, const ModeState& state, int zero_order);
  [[nodiscard]] bool has_same_functions(const ModeState& state) const;
  void renew(const std::vector<int>& zero_order, double t, const double* x);
  [[nodiscard]] bool may_flip(const ModeState& state) const;
  bool flip(const ModeState& state, const std::vector<int>& zero_order, double t, const double* x);
  void begin_flipped(const ModeState& state, double t, const double* x);
  void read_start(double t, const double* x);
  void read_values(double t, const double* x, const std::vector<std::size_t>& which);
  void sort(std::size_t i);
  void find_candidates();
  SearchOutcome search_interval(const ode::DenseStep& step, double from, double to, int depth, Hit& hit);
  [[nodiscard]] Finding find_along(const ode::DenseStep& step, std::size_t i) const;
  Finding find(const ode::DenseStep& step, double from, double to, std::size_t i);
  static Finding not_finite(const EventFunction& function, double at_start);
  [[nodiscard]] Finding find_in_series(const ode::DenseStep& step, double from, double to, std::size_t i) const;
  bool misses(const ode::DenseStep& step, double from, double to, std::size_t i,
              const ode::BernsteinCoefficients& coefficients, double accuracy);
  [[nodiscard]] bool is_far(std::size_t i) const;
  void find_suspects(const ode::DenseStep& step);
  /// Every so many from the first one on.
  struct Nodes {
    std::size_t first = 0;
    std::size_t stride = 1;
  };
  void sample(const ode::DenseStep& step, double from, double to, const std::vector<std::size_t>& which, Nodes nodes);
  [[nodiscard]] double node_theta(double from, double to, std::size_t node) const;
  void bear_tangency(std::size_t i, double t, const double* x);
  void read_user_signs();
  void find_pressure(double t, const double* x);
  void enter_cells();

  const evaluation::ModelKernel& kernel_;
  ModeField& field_;
  bool five_nodes_suffice_;  ///< the dense output has degree 4: five samples determine an affine function
  ode::Tolerances tolerances_;
  ModeState state_;
  std::vector<EventFunction> functions_;
  std::vector<int> user_sign_;       ///< kept over changes of mode
  std::vector<bool> user_vanishes_;  ///< at the start of the next step
  std::vector<int> user_order_;      ///< of those zeros; all 1 if it is empty
  std::optional<double> zeros_at_;   ///< time of that start; nullopt: that of the next enter()
  std::vector<int> entered_;         ///< by cell: event function of the end at which it was entered, or -1
  std::vector<double> phi_, magnitude_, slope_;
  /// One of the regions that meet at the sliding surfaces inside nested functions.
  struct Corner {
    std::vector<double> alpha;  ///< its selections
    std::vector<double> phi;
    evaluation::AffineRows rows;
  };
  std::vector<Corner> corners_;  ///< of the mode
  std::vector<ExitValues> exits_;
  std::vector<HeldGuard> held_, followers_;
  std::vector<double> pressure_;
  std::vector<double> x_, point_;
  std::vector<double> samples_;  ///< node by node
  std::vector<double> noise_, accuracy_;
  std::vector<double> low_, high_;            ///< of the states over the step
  std::vector<double> wide_low_, wide_high_;  ///< around it
  StepBounds bounds_;
  bool bounds_known_ = false;  ///< may_vanish() has found those of the dense output
  AffineForms forms_;
  std::vector<bool> nesting_;         ///< functions of the kernel that hold selections
  evaluation::AffineRows rows_;       ///< at the selections of the mode
  std::vector<std::size_t> special_;  ///< functions with an unknown sign, or a zero at the start of the next step
  std::vector<std::size_t> curved_;   ///< functions without an affine form
  Parts curved_parts_;
  std::vector<std::size_t> suspects_;    ///< of this step, ascending
  std::vector<std::size_t> sampled_;     ///< of the suspects those without a form
  std::vector<std::size_t> candidates_;  ///< of this step, ascending
  std::vector<std::size_t> inspected_;   ///< at the start of a mode: those whose values matter there
  std::size_t first_exit_ = 0;           ///< where the exits of sliding surfaces begin in functions_
  std::size_t users_ = 0;                ///< the user functions among functions_, and their end
  std::size_t users_end_ = 0;
  std::vector<std::size_t> of_surface_;  ///< n_psi: function of a surface outside the mode
  bool any_nesting_ = false;             ///< some functions of the kernel hold selections
  bool flips_ = false;                   ///< surfaces and plain exits only: crossings change little
  bool only_signs_change_ = false;       ///< where the mode that was entered last begins anew
  std::vector<Kept> kept_;               ///< the last ones, with different sliding sets
  std::size_t next_kept_ = 0;
  std::vector<bool> prefilter_;  ///< five samples may show that the function stays away from zero
};

}  // namespace saltus::event_integrator
