// The model as plain functions of doubles: fields, switching functions, their derivatives. No CasADi in sight.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/evaluation/native_steps.hpp"
#include "saltus/model/cells.hpp"
#include "saltus/ode/linear_field.hpp"
#include "saltus/ode/sparse/jacobian_pattern.hpp"

namespace saltus::model {
struct Activity;
struct Layout;
struct System;
}  // namespace saltus::model

namespace saltus::evaluation {

struct ContactValues;
struct CompiledModel;
struct FieldStructure;

/// Says whether the functions that every step needs run as native code: compiled C, cached by content. Bit-identical to
/// the interpreter. `automatic`: from the cache, or compiled once a run is long enough that it pays; interpreted where
/// there is no compiler.
enum class NativeCode { automatic, on, off };

/// Holds a guard of a jump whose executions have accumulated: it and its derivative along the motion stay 0, the
/// continuous states that the jump sets absorb what is needed.
struct Hold {
  int jump = 0;
  int function = 0;  ///< event function of the guard g
};

/// Holds rows of the event functions that are affine in (t, x): phi_j = offset_j + rate_j t + sum_k coefficient_k
/// x_(column_k), k = start_j ... start_(j+1) - 1. The others have an empty row and NaN as their offset.
struct AffineRows {
  std::vector<std::size_t> start;
  std::vector<std::size_t> column;
  std::vector<double> coefficient;
  std::vector<double> rate, offset;
};

/// Holds a row that has been computed for one function; a component held fixed is in the offset.
struct AffineRow {
  std::vector<std::size_t> column;  ///< ascending
  std::vector<double> coefficient;  ///< of these states, those of others are 0
  double rate = 0.0;
  double offset = 0.0;
};

/// Holds a state that a mode keeps constant; component -1 = none.
struct FixedState {
  int component = -1;
  double value = 0.0;
};

/// Holds the functions of a group of modes by `indicator` (model::ModeGroup): first, first + 1, …
struct RegionRange {
  int first = 0;
  int count = 0;
  [[nodiscard]] bool holds(int function) const { return first <= function && function < first + count; }
};

/// f as native code: x, constants and xdot are not null and do not overlap.
using DirectField = void (*)(double t, const double* x, const double* constants, double* xdot);

/// Holds the motion in force, free or held, and how often it was evaluated: of a kernel, for its callers' shortcut.
struct FieldUse {
  const void* motion = nullptr;
  long evaluations = 0;
};

/// Holds what a right-hand side needs of its parameters and selections; filled by ModelKernel::prepare_field.
struct FieldConstants {
  std::vector<double> values;
  std::vector<double> alpha;           ///< what they were made of
  const void* motion = nullptr;        ///< free or held
  DirectField direct = nullptr;        ///< of that motion, if there was native code
  const NativeSteps* steps = nullptr;  ///< likewise
  FieldUse* use = nullptr;             ///< of the kernel

  /// Returns whether `steps` are those of the motion in force.
  [[nodiscard]] bool has_steps() const { return steps != nullptr && use->motion == motion; }
};

/// Evaluates the functions of a model, of which event functions are numbered in this order:
/// - psi_0 … psi_{n_psi-1};
/// - the expressions of [[events]];
/// - the comparisons (guards) of their conditions;
/// - the guards of [[jumps]], jump by jump;
/// - two for every cell: its argument less the upper end of the cell it is in, and less the lower end.
///
/// Floor, tables and sampled inputs are smooth in the cells of their arguments. The kernel holds in which cell each is
/// (set_cell), and all functions are those of these cells, also where the argument has left them.
///
/// All functions take t (model time), x (n_x), alpha (n_psi, in [0, 1]) and write to the caller's memory; values that
/// are not finite mark points where the model is undefined. Controls are replaced by their inputs u(t).
///
/// A kernel is a compiled model and the context of one run: parameters, cells, activities of contacts, references of
/// regions, what is held, work space. Who changes the context has a kernel that is not const. One kernel per thread;
/// kernels of one compiled model (share) may run in several threads at a time.
class ModelKernel {
 public:
  /// Compiles the functions that every run needs; derivatives of single functions are compiled when first asked for.
  /// Fails (invalid_model) if the symbolic layer refuses an expression, (not_available) if native code is insisted on
  /// and cannot be had.
  [[nodiscard]] static Expected<ModelKernel> compile(const model::System& system, NativeCode native = NativeCode::off);

  /// Returns another kernel of a compiled model, as if it was just compiled with the parameters of its system: nothing
  /// is differentiated or compiled twice. Others may run meanwhile. Fails (not_available) as compile() does.
  [[nodiscard]] static Expected<ModelKernel> of(std::shared_ptr<CompiledModel> model, NativeCode native);
  [[nodiscard]] std::shared_ptr<CompiledModel> compiled() const;

  /// Takes values and names of a system with the same structure (model::structure), as if it was just compiled and bit
  /// by bit; what was compiled stays.
  /// @return false, and nothing has changed, where expressions depend on values (roots) or on what was before.
  [[nodiscard]] bool set_values(const model::System& system);

  ModelKernel(ModelKernel&&) noexcept;
  ModelKernel& operator=(ModelKernel&&) noexcept;
  ~ModelKernel();

  [[nodiscard]] int states() const;
  [[nodiscard]] int switching_functions() const;
  [[nodiscard]] int event_functions() const;  ///< psi, event expressions and guards together
  [[nodiscard]] int outputs() const;
  [[nodiscard]] int controls() const;
  /// Returns what of the system is no expression. Stays where it is until set_values().
  [[nodiscard]] const model::Layout& layout() const;
  /// Returns the system whose values it has, for words in messages. Stays where it is until set_values().
  [[nodiscard]] const model::System& stated() const;
  /// Returns where a run begins: that of the system, unless it was set (n_x).
  [[nodiscard]] const std::vector<double>& initial_state() const;
  void set_initial_state(std::vector<double> x);

  /// Evaluates xdot = f(t, x, u(t), p, alpha).
  void field(double t, const double* x, const double* alpha, double* xdot) const;
  /// Does the same in two parts, bit for bit: what f makes of p and alpha alone, kept by the caller for as long as the
  /// selections stay, and the rest. However many selections f sums up, an evaluation pays for none of them (for all
  /// where hold() has changed the motion since).
  void prepare_field(const double* alpha, FieldConstants& constants) const;
  void prepared_field(double t, const double* x, const FieldConstants& constants, double* xdot) const {
    if (constants.direct == nullptr || constants.use->motion != constants.motion) {
      return prepared_field_anyhow(t, x, constants, xdot);
    }
    ++constants.use->evaluations;
    constants.direct(t, x, constants.values.data(), xdot);
  }
  /// Evaluates one row of it, bit for bit; only where there is a field_structure(). Counts as no evaluation. Cost: that
  /// of the row, interpreted.
  [[nodiscard]] double field_row(std::size_t row, double t, const double* x, const double* alpha) const;
  /// Returns what depends on what in f, null where its rows cannot be evaluated one by one. Stays where it is. Cost:
  /// the operations of all rows, the first time.
  [[nodiscard]] const FieldStructure* field_structure() const;
  /// Returns the linear part of f for these selections, null where f is not affine in t and x (by its operations,
  /// whatever the selections are). Where the selections or cells change it, it is put into `own`; otherwise it stays as
  /// it is as long as the kernel and the motion. Cost: the first call makes an expression.
  [[nodiscard]] const ode::LinearField* linear_field(const double* alpha, ode::LinearField& own) const;
  /// Returns the pattern of the Jacobian of f, selections of sliding surfaces being functions of x; null where a dense
  /// matrix is as good, with guards held and with regions by `indicator`. Stays where it is. Cost: the first call finds
  /// it.
  [[nodiscard]] const ode::JacobianPattern* jacobian_pattern() const;
  /// Evaluates d f / d x with selections held, in the order of jacobian_pattern() or column by column; discrete states,
  /// which do not move, have columns of 0. False where it is not finite, or too large for an expression. Cost: the
  /// first call makes the expression.
  [[nodiscard]] bool field_jacobian(double t, const double* x, const double* alpha, double* entries) const;
  /// Evaluates all event functions.
  void functions(double t, const double* x, const double* alpha, double* values) const;
  /// Bounds event functions that are not affine: phi_j is within radius_j of middle_j, up to rounding, wherever t and x
  /// differ from these by `radii` at most (1 + n_x: that of t first). Of functions that are affine both are 0.
  void ranges(double t, const double* x, const double* alpha, const double* radii, double* middle,
              double* radius) const;
  /// Evaluates magnitudes from which rounding and tolerances of event functions follow, each over all event functions:
  ///   magnitude_j = sum_i |d_i phi_j x_i| + |d_t phi_j t|,   slope_j = sum_i |d_i phi_j|.
  void scales(double t, const double* x, const double* alpha, double* magnitude, double* slope) const;
  /// Evaluates the gradient row d phi_j / d x (n_x) and d phi_j / d t.
  void gradient(int function, double t, const double* x, const double* alpha, double* row, double* rate) const;
  /// Does the same for the states that phi_j reads alone; the offset is not set. Cost: that of the row, where it is
  /// constant.
  void gradient(int function, double t, const double* x, const double* alpha, AffineRow& row) const;
  /// Returns grad phi_j . f + d phi_j/dt where phi_j is affine and holds no selections. Cost: the rows of f that this
  /// needs, or all of them where these are not more.
  [[nodiscard]] double rate(int function, double t, const double* x, const double* alpha) const;
  /// Returns the number, for lie_derivative() and lie_gradient() only (of order 0, too), of phi_j with its roots of
  /// what is 0 with a switching function 0 there, to rounding: where x is held at 0, with selections of 1/2, and beside
  /// it, v + sqrt(abs(x))*sign(x) is v. Cost: an expression, once.
  [[nodiscard]] int with_limited_roots(int function) const;
  /// Returns whether phi_function has a root of psi_surface, or of what is 0 with it. Cost: that of
  /// with_limited_roots().
  [[nodiscard]] bool has_root_inside(int function, int surface) const;
  /// Returns L^order phi_j along f(., alpha) with alpha held, e.g. order 1: grad phi . f + d phi/dt. order >= 1.
  [[nodiscard]] double lie_derivative(int function, int order, double t, const double* x, const double* alpha) const;
  /// Evaluates its gradient (n_x) and derivative with respect to t.
  void lie_gradient(int function, int order, double t, const double* x, const double* alpha, double* row,
                    double* rate) const;
  void outputs(double t, const double* x, const double* alpha, double* values) const;
  /// Evaluates u(t) during the simulation.
  void inputs(double t, const double* alpha, double* values) const;
  /// Returns the truth (0 or 1) of the condition of [[events]] entry `event` from the steps of its guards.
  [[nodiscard]] bool condition(int event, double t, const double* x, const double* alpha,
                               const double* guard_alpha) const;

  /// Returns whether an event function is an expression or a guard of [[events]]: nothing of the motion depends on it.
  [[nodiscard]] bool is_listed_only(int function) const;
  /// Returns the event function of guard `guard` of jump `jump`.
  [[nodiscard]] int jump_guard(int jump, int guard) const;
  /// Returns the truth (0 or 1) of the condition of a jump from the steps of its guards.
  [[nodiscard]] bool jump_condition(int jump, double t, const double* x, const double* alpha,
                                    const double* guard_alpha) const;
  /// Evaluates right-hand sides of `set`, one per target.
  void jump_values(int jump, double t, const double* x, const double* alpha, double* values) const;
  [[nodiscard]] double jump_priority(int jump, double t, const double* x, const double* alpha) const;
  [[nodiscard]] double jump_delay(int jump, double t, const double* x, const double* alpha) const;

  /// Evaluates gaps, velocities and what moves them; only for systems with contacts.
  void contacts(double t, const double* x, const double* alpha, ContactValues& values) const;
  /// Returns how contacts take part in the mode, which forces and guards depend on; all are open at first.
  [[nodiscard]] const std::vector<model::Activity>& activities() const;
  void set_activity(int contact, const model::Activity& activity);
  void set_activities(const std::vector<model::Activity>& activities);

  /// Makes field(), lie_derivative() and depends() those of the held system
  ///   xdot = f + D mu,  d_k = (d set_k/dx - I) w_k,  w_k = d/dx (d g_k/dt) restricted to the continuous states that
  ///   jump k sets (and those of rate 0 that are in d g_k/dt),
  ///   mu from d^2 g/dt^2 = 0 for all held guards.
  /// An empty list releases all. Fails (outside_class's message) where d g/dt does not hold the states the jump sets;
  /// the motion then is what it was. Cost: expressions and functions are made once per list.
  [[nodiscard]] Expected<void> hold(const std::vector<Hold>& holds);
  /// Evaluates -M_kk mu_k with M_ik = d/dx (d g_i/dt) d_k, in the order of hold(): d^2 g_k/dt^2 without the hold if it
  /// is the only one, and in general of its sign while the guard is pressed on; release where it passes 0. Only while
  /// holding.
  void hold_pressure(double t, const double* x, const double* alpha, double* pressure) const;

  /// Returns whether phi_j is affine in (t, x) for fixed alpha: by its operations, so floor or a comparison never is.
  [[nodiscard]] bool is_affine(int function) const;
  /// Fills rows of all affine event functions for these selections. Allocates the first time `rows` is filled.
  void affine_rows(const double* alpha, AffineRows& rows) const;
  /// Returns L phi_j along f(., alpha) as a row, if it is affine in t and the states that are not fixed; false if it is
  /// not.
  [[nodiscard]] bool lie_row(int function, FixedState fixed, const double* alpha, AffineRow& row) const;
  /// Returns whether it is a guard of a jump that depends on discrete states and constants only.
  [[nodiscard]] bool is_discrete_guard(int function) const;
  /// Returns switching functions whose alpha occurs in phi_j (after inputs are put in), ascending.
  [[nodiscard]] const std::vector<int>& inner(int function) const;
  /// Returns whether the normal component grad psi_i . f + d psi_i/dt depends on alpha_j (structurally).
  [[nodiscard]] bool depends(int surface, int alpha) const;
  /// Returns surfaces other than psi_i of which one depends(.) on the other, or psi_i on it; ascending.
  [[nodiscard]] const std::vector<int>& neighbours(int surface) const;

  /// Returns whether f has a root of psi_j, or of what is 0 with it, so that its derivative is infinite beside the
  /// surface. On the surface, to the rounding of psi_j, the root is 0 and so are its derivatives: field() and
  /// lie_derivative() are those of everything else.
  [[nodiscard]] bool has_root(int surface) const;
  /// Returns whether it is 0 beyond the surface of its region, too: if d psi_j/dt jumps there, from no side that is
  /// always 0. Otherwise it is NaN.
  [[nodiscard]] bool root_is_continued(int surface) const;

  /// Returns whether functions hold the same constants in all modes: no cells, activities of contacts or references of
  /// regions change them.
  [[nodiscard]] bool has_fixed_constants() const;
  [[nodiscard]] int cells() const;
  /// Returns the event function of a cell's upper end (argument - end, negative inside); that of the lower one follows
  /// it.
  [[nodiscard]] int cell_function(int cell) const;
  [[nodiscard]] const model::CellTable& cell_table(int cell) const;
  [[nodiscard]] long cell(int cell) const;
  /// Moves one argument to another cell. Part of where a run is, like t and x.
  void set_cell(int cell, long index);
  [[nodiscard]] double cell_argument(int cell, double t, const double* x, const double* alpha) const;
  /// Returns whether phi_j holds constants of this cell.
  [[nodiscard]] bool depends_on_cell(int function, int cell) const;

  /// Returns the groups of modes by `indicator`.
  [[nodiscard]] const std::vector<RegionRange>& region_groups() const;
  /// Returns the region whose indicator the others of its group are measured against; -1 before it is first set.
  [[nodiscard]] int reference(std::size_t group) const;
  /// Sets a part of where a run is, like cells. f does not depend on it if the weights of all regions are in alpha.
  void set_reference(std::size_t group, int function);

  [[nodiscard]] long field_evaluations() const;
  /// Returns which motion is in force, free or held: the same address, the same motion.
  [[nodiscard]] const void* motion() const;

 private:
  [[nodiscard]] double derivative_by_differences(int function, int order, double t, const double* x,
                                                 const double* alpha) const;
  void prepared_field_anyhow(double t, const double* x, const FieldConstants& constants, double* xdot) const;

  struct Implementation;
  explicit ModelKernel(std::unique_ptr<Implementation> implementation);
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace saltus::evaluation
