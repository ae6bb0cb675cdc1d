// What a ModelKernel holds: the model's expressions, and the functions that were made of them.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <casadi/core/sx.hpp>

#include "saltus/evaluation/affine_functions_internal.hpp"
#include "saltus/evaluation/cell_functions_internal.hpp"
#include "saltus/evaluation/held_motion_internal.hpp"
#include "saltus/evaluation/jump_functions_internal.hpp"
#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/evaluation/native_functions.hpp"
#include "saltus/evaluation/region_constants_internal.hpp"
#include "saltus/evaluation/sparse/used_symbols_internal.hpp"
#include "saltus/model/graph/model_function.hpp"

namespace saltus::evaluation {

using model::ModelFunction;

/// xdot = f, free or with guards held, and what follows from it.
struct Motion {
  casadi::SX f;
  ModelFunction field;               ///< of t, x and the constants
  ModelFunction constants;           ///< of p and alpha
  DirectField direct = nullptr;      ///< the field as native code, once there is some
  std::optional<NativeSteps> steps;  ///< likewise, where the field is small
  ModelFunction pressure;            ///< of the holds; null without
  std::vector<std::vector<bool>> depends;
  std::vector<std::vector<int>> neighbours;  ///< of every switching function, those that influence it or the reverse
  std::map<std::pair<int, int>, ModelFunction> lie_derivatives;
  std::map<std::pair<int, int>, ModelFunction> lie_gradients;
  std::map<std::pair<int, int>, casadi::SX> lie_expressions;
  std::map<std::pair<int, int>, AffineRowFunction> lie_rows;  ///< by function and fixed component
  std::optional<LinearFieldFunction> linear;                  ///< once it was asked for
  std::optional<ode::LinearField> linear_always;              ///< if it is the same in all modes
};

[[nodiscard]] std::vector<std::vector<int>> neighbours_in(const std::vector<std::vector<bool>>& depends);

/// The model's symbols and expressions; they never change.
struct KernelSymbols {
  explicit KernelSymbols(const model::System& system);

  casadi::SX t, x, p, alpha;  ///< p: parameters, then constants, upper and lower ends of cells
  casadi::SX phi, outputs, input;
  std::vector<bool> discrete;  ///< n_x
  int n_psi = 0;
};

/// What the expressions say without values; found once, that of limited roots when it is first asked for.
struct KernelStructure {
  std::vector<std::vector<bool>> on_cells;  ///< by event function
  std::vector<bool> affine, time_only;
  std::vector<bool> rooted, continued_roots;  ///< n_psi
  std::vector<std::vector<int>> inner;
  SymbolPlaces places;
  /// Of the free motion, once it was asked for.
  std::optional<std::optional<ode::JacobianPattern>> pattern;
  std::vector<casadi::SX> rootless;             ///< event functions with limited roots
  std::vector<std::vector<bool>> roots_inside;  ///< of these, by switching function
  std::map<int, int> rootless_numbers;          ///< of these, by event function
  std::size_t fixed_parameters = 0;             ///< the first of `parameters`: changed by set_parameters() only
  bool by_values = false;                       ///< expressions may depend on their values
  std::vector<HeldGuard> jump_guards;           ///< by event function, from first_jump_guard on
  int first_jump_guard = 0;
};

/// The functions that were made of the expressions; some when they are first called.
struct KernelFunctions {
  ModelFunction functions, scales, output_function, input_function;
  std::vector<ModelFunction> conditions;  ///< one per [[events]] entry; null for expressions
  JumpFunctions jumps;
  ModelFunction contact_function;  ///< null without contacts
  AffineRowFunctions affine_rows;
  std::vector<ModelFunction> gradients;  ///< d phi_j / d (x, t)
  Motion free;
  std::map<std::vector<int>, Motion> held;  ///< by event functions
  NativeFunctions native;                   ///< the functions that every step needs
};

/// Where a run is beside t, x and alpha, and its work space: the part of a kernel that its user changes.
struct KernelContext {
  std::vector<double> parameters;  ///< values of p
  RegionConstants regions;         ///< their references
  CellFunctions cells;             ///< in which each argument is
  FieldConstants constants;        ///< work space of field()
  /// Of functions that are affine and do not hold selections gradients are constants: these rows, once known.
  std::optional<AffineRows> constant_gradients;
  Motion* motion = nullptr;  ///< the free one, or a held one
  FieldUse field_use;        ///< its motion is `motion`
};

struct ModelKernel::Implementation : KernelSymbols, KernelStructure, KernelFunctions, KernelContext {
  explicit Implementation(const model::System& system);
  /// Of an event function or, by a negative number, one with limited roots.
  casadi::SX phi_row(int j) const { return j < 0 ? rootless[at(-1 - j)] : casadi::SX(phi(j)); }
  ModelSymbols symbols() const { return {t, x, p, alpha}; }
  casadi::SX lie_expression(int j, int order);
  void compile_field(Motion& target, const std::string& name) const;
  void find_structure();
  [[nodiscard]] std::vector<std::vector<bool>> normal_dependencies(const casadi::SX& f) const;
  [[nodiscard]] Expected<Motion> compile_held(const std::vector<int>& functions) const;
  void compile_conditions(const model::System& system);

  [[nodiscard]] Expected<void> start_native(NativeCode wanted);
  void take_native_field();
  [[nodiscard]] bool has_small_field() const;
  /// An interpreted call is about to be made.
  void count(const ModelFunction& function) {
    if (native.count(function)) take_native_field();
  }
};

}  // namespace saltus::evaluation
