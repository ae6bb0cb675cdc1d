// What a ModelKernel holds: a compiled model, which kernels in any threads share, functions of it with work space of
// their own, and the context of a run.
#pragma once

#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <casadi/core/sx.hpp>

#include "saltus/evaluation/affine_functions_internal.hpp"
#include "saltus/evaluation/cell_functions_internal.hpp"
#include "saltus/evaluation/contacts/contact_solve_internal.hpp"
#include "saltus/evaluation/field_rows_internal.hpp"
#include "saltus/evaluation/held_motion_internal.hpp"
#include "saltus/evaluation/jump_functions_internal.hpp"
#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/evaluation/native_functions.hpp"
#include "saltus/evaluation/region_constants_internal.hpp"
#include "saltus/evaluation/sparse/used_symbols_internal.hpp"
#include "saltus/model/graph/model_function.hpp"
#include "saltus/model/layout.hpp"

namespace saltus::evaluation {

using model::ModelFunction;

/// Holds xdot = f, free or with guards held, and what follows from it. What is not there yet is made under the symbolic
/// lock.
struct CompiledMotion {
  casadi::SX f;
  ModelFunction field;                       ///< of t, x and the constants
  ModelFunction constants;                   ///< of p and alpha
  ModelFunction pressure;                    ///< of the holds; null without
  std::vector<std::vector<int>> depends;     ///< of every switching function: selections in its normal component
  std::vector<std::vector<int>> neighbours;  ///< of every switching function, those that influence it or the reverse
  std::map<std::pair<int, int>, casadi::SX> lie_expressions;
  /// Of a function: how many orders of its derivatives were asked for, and whether forces move the last of these.
  std::map<int, std::pair<int, bool>> turned;
  std::map<std::pair<int, int>, ModelFunction> lie_derivatives, lie_gradients;
  std::map<std::pair<int, int>, AffineRowFunction> lie_rows;  ///< by function and fixed component
  std::optional<LinearFieldFunction> linear;
  std::optional<ModelFunction> jacobian;                 ///< null where it is too large
  std::optional<std::shared_ptr<const FieldRows>> rows;  ///< once they were asked for; null where there are none
};

/// Holds a motion of one kernel: the functions that it has called, with its own work space.
struct Motion {
  Motion() = default;
  explicit Motion(CompiledMotion& motion)
      : compiled(&motion), field(motion.field), constants(motion.constants), pressure(motion.pressure) {}

  CompiledMotion* compiled = nullptr;  ///< of the kernel's compiled model
  ModelFunction field, constants, pressure;
  DirectField direct = nullptr;      ///< the field as native code, once there is some
  std::optional<NativeSteps> steps;  ///< likewise, where the field is small
  std::map<std::pair<int, int>, ModelFunction> lie_derivatives, lie_gradients;
  std::map<std::pair<int, int>, AffineRowFunction> lie_rows;
  std::optional<LinearFieldFunction> linear;
  std::optional<ode::LinearField> linear_always;  ///< if it is the same in all modes
  std::optional<ModelFunction> jacobian;          ///< null where it is too large
  std::optional<std::shared_ptr<const FieldRows>> rows;
  FieldRows::Work row_work;
};

/// Returns on which of the variables each row of an expression depends, ascending.
[[nodiscard]] std::vector<std::vector<int>> dependencies_of_rows(const casadi::SX& expression,
                                                                 const casadi::SX& variables);
[[nodiscard]] std::vector<std::vector<int>> neighbours_in(const std::vector<std::vector<int>>& depends);

/// Holds the model's symbols and expressions; they never change.
struct KernelSymbols {
  explicit KernelSymbols(const model::System& system);

  /// p: parameters, then constants, upper and lower ends of cells, then activities, then forces that no expression says
  casadi::SX t, x, p, alpha;
  casadi::SX phi, outputs, input;
  casadi::SX forces;           ///< the last of p
  std::vector<bool> discrete;  ///< n_x
  int n_psi = 0;
};

/// Holds what the expressions say without values; found once.
struct KernelStructure {
  std::vector<std::vector<bool>> on_cells;  ///< by event function
  std::vector<bool> affine;
  std::vector<bool> discrete_guards;          ///< by event function: guards of jumps that jumps alone change
  std::vector<bool> rooted, continued_roots;  ///< n_psi
  std::vector<std::vector<int>> inner;
  SymbolPlaces places;
  std::size_t fixed_parameters = 0;    ///< the first of `parameters`: changed by set_parameters() only
  std::size_t first_activity = 0;      ///< among `parameters`: constants of the first contact
  bool by_values = false;              ///< expressions may depend on their values
  std::vector<HeldGuard> jump_guards;  ///< by event function, from first_jump_guard on
  int first_jump_guard = 0;
  struct ContactSizes {
    casadi_int contacts = 0, rows = 0, velocities = 0;
  };
  ContactSizes contact_sizes;
};

/// Holds the functions that were made of the expressions.
struct KernelFunctions {
  ModelFunction functions, scales, output_function, input_function;
  std::vector<ModelFunction> conditions;  ///< one per [[events]] entry; null for expressions
  JumpFunctions jumps;
  ModelFunction contact_function;  ///< null without contacts
  ContactSolve contact_solve;
  AffineRowFunctions affine_rows;
  ModelFunction ranges;                  ///< of those that are not affine; null where all are
  std::vector<ModelFunction> gradients;  ///< d phi_j / d (x, t); null before they are first asked for
};

/// Holds an event function without its roots of what is 0 on a surface.
struct LimitedFunction {
  int number = 0;            ///< its negative one
  std::vector<bool> rooted;  ///< by switching function
};

/// Says where a run begins beside t, x and alpha.
struct KernelValues {
  std::vector<double> parameters;           ///< values of p
  RegionConstants regions;                  ///< their references
  CellFunctions cells;                      ///< in which each argument is
  std::vector<model::Activity> activities;  ///< of all contacts
  std::vector<double> initial_state;        ///< x where a run begins
  std::shared_ptr<const model::System>
      system;  ///< stated with these values; copied and dropped under the symbolic lock
  std::shared_ptr<const model::Layout> layout;  ///< its own: names and times are no part of what is compiled

  [[nodiscard]] bool has_fixed_constants() const {
    return cells.size() == 0 && activities.empty() && regions.groups().empty();
  }
  /// @param first  place of the constants of contact 0
  void set_activity(std::size_t first, std::size_t contact, const model::Activity& activity) {
    activities[contact] = activity;
    const auto values = activity.values();
    std::copy(values.begin(), values.end(), parameters.begin() + index(first + contact * values.size()));
  }
};

/// Holds a model as compiled functions, for kernels in any threads. Nothing of it changes but what is made when it is
/// first asked for, by its functions that are not const: under the symbolic lock.
struct CompiledModel : KernelSymbols, KernelStructure {
  explicit CompiledModel(const model::System& system);

  /// Returns the row of an event function or, by a negative number, of one with limited roots.
  [[nodiscard]] casadi::SX phi_row(int j) const { return j < 0 ? rootless[at(-1 - j)] : casadi::SX(phi(j)); }
  [[nodiscard]] ModelSymbols symbols() const { return {t, x, p, alpha}; }

  [[nodiscard]] const ModelFunction& gradient(int function);
  [[nodiscard]] bool is_turned_below(CompiledMotion& motion, int function, int order);
  [[nodiscard]] const ModelFunction& lie_derivative(CompiledMotion& motion, int function, int order);
  [[nodiscard]] const ModelFunction& lie_gradient(CompiledMotion& motion, int function, int order);
  [[nodiscard]] const AffineRowFunction& lie_row(CompiledMotion& motion, int function, int fixed_component);
  [[nodiscard]] const LinearFieldFunction& linear(CompiledMotion& motion);
  [[nodiscard]] const std::shared_ptr<const FieldRows>& rows(CompiledMotion& motion);
  [[nodiscard]] const LimitedFunction& limited(int function, const std::vector<double>& fixed_values);
  [[nodiscard]] const std::optional<ode::JacobianPattern>& jacobian_pattern();
  [[nodiscard]] const ModelFunction& jacobian(CompiledMotion& motion, const ode::JacobianPattern* pattern);
  [[nodiscard]] Expected<CompiledMotion*> held(const std::vector<int>& guards);
  /// Returns the layout of a system with the same structure, with what is known from the expressions.
  [[nodiscard]] model::Layout layout_with_parts(const model::System& system) const;

  KernelFunctions functions;
  KernelValues start;
  CompiledMotion free;

 private:
  casadi::SX lie_expression(CompiledMotion& motion, int j, int order);
  void compile_field(CompiledMotion& target, const std::string& name) const;
  void compile_contacts(const model::System& system);
  [[nodiscard]] casadi::SX sizes_of_contact_guards(const model::System& system) const;
  [[nodiscard]] casadi::SX with_what_forces_read(const casadi::SX& expression, const model::System& system) const;
  void compile_functions(const model::System& system);
  [[nodiscard]] ModelFunction range_function() const;
  void find_structure(const model::System& system);
  void find_layout(const model::System& system);
  [[nodiscard]] std::vector<std::vector<int>> normal_dependencies(const casadi::SX& f) const;
  void compile_conditions(const model::System& system);

  std::map<std::vector<int>, CompiledMotion> held_;  ///< by event functions
  /// Of the free motion, once it was asked for.
  std::optional<std::optional<ode::JacobianPattern>> pattern_;
  std::vector<casadi::SX> rootless;  ///< event functions with limited roots
  std::map<std::pair<int, std::vector<double>>, LimitedFunction> limited_;
};

/// Holds the last scales: where something happens they are asked for again and again at the same point.
struct LastScales {
  LastPoint point;
  std::vector<double> magnitude, slope;
};

/// Holds what the user of a kernel changes, and its work space.
struct KernelContext : KernelValues {
  LastScales last_scales;
  FieldConstants constants;          ///< work space of field()
  std::vector<double> slope;         ///< work space of rate()
  std::vector<double> gradient_row;  ///< work space of gradient()
  std::vector<double> moving;        ///< likewise of field(): x and forces
  /// Of functions that are affine and do not hold selections gradients are constants: these rows, once known.
  std::optional<AffineRows> constant_gradients;
  std::map<int, LimitedFunction> limited;                   ///< by event function
  std::optional<const ode::JacobianPattern*> free_pattern;  ///< null where a dense matrix is as good
  Motion free;
  std::map<std::vector<int>, Motion> held;  ///< by event functions
  Motion* motion = nullptr;                 ///< the free one, or a held one
  FieldUse field_use;                       ///< its motion is `motion`
};

struct ModelKernel::Implementation : KernelFunctions, KernelContext {
  explicit Implementation(std::shared_ptr<CompiledModel> model, NativeCode native_code);

  [[nodiscard]] Expected<void> start_native();
  void take_native_field();
  [[nodiscard]] bool has_small_field() const;
  [[nodiscard]] const FieldRows* rows();
  [[nodiscard]] PointArguments point(const double* t, const double* x, const double* alpha) const;
  /// Returns the values of p at a point, with forces.
  [[nodiscard]] const double* parameters_at(double t, const double* x, const double* alpha) {
    if (contact_solve.is_needed()) contact_solve.solve(point(&t, x, alpha), activities, parameters);
    return parameters.data();
  }
  /// Returns x and the forces behind each other, which field() is made of.
  [[nodiscard]] const double* with_forces(double t, const double* x, const double* alpha);
  void scale_forces(double t, const double* x, const double* alpha);
  void gradient_at(int function, double t, const double* x, const double* alpha, double* row, double* rate);
  [[nodiscard]] const AffineRows& gradients_of_affine();
  /// Counts an interpreted call that is about to be made.
  void count(const ModelFunction& function) {
    if (native.count(function)) take_native_field();
  }

  std::shared_ptr<CompiledModel> compiled;
  NativeCode wanted;
  NativeFunctions native;  ///< the functions that every step needs
};

}  // namespace saltus::evaluation
