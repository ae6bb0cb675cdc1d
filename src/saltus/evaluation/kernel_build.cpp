// From a system's expressions to the functions that every run needs, and to their structure.
#include <algorithm>
#include <exception>
#include <functional>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/base/contains.hpp"
#include "saltus/base/contracts.hpp"
#include "saltus/base/preparation.hpp"
#include "saltus/base/symbolic_lock.hpp"
#include "saltus/base/without_repeats.hpp"
#include "saltus/evaluation/field_split_internal.hpp"
#include "saltus/evaluation/kernel_internal.hpp"
#include "saltus/evaluation/root_limits_internal.hpp"
#include "saltus/evaluation/sparse/field_pattern_internal.hpp"
#include "saltus/model/graph/ranges.hpp"
#include "saltus/model/system.hpp"

namespace saltus::evaluation {

using casadi::SX;

namespace {
/// Said of a compilation, in parts that take about as long as each other.
constexpr std::string_view compiling = "compiling the model";
constexpr std::size_t compiled_parts = 7;
}  // namespace

std::vector<std::vector<int>> dependencies_of_rows(const SX& expression, const SX& variables) {
  std::vector<std::vector<int>> rows(at(expression.numel()));
  if (expression.numel() == 0 || variables.numel() == 0) return rows;
  const auto sparsity = SX::jacobian_sparsity(SX::densify(expression), variables);
  const casadi_int* column_start = sparsity.colind();
  const casadi_int* row = sparsity.row();
  for (casadi_int column = 0; column < sparsity.size2(); ++column) {
    for (casadi_int k = column_start[column]; k < column_start[column + 1]; ++k) {
      rows[at(row[k])].push_back(static_cast<int>(column));
    }
  }
  return rows;
}

std::vector<std::vector<int>> neighbours_in(const std::vector<std::vector<int>>& depends) {
  std::vector<std::vector<int>> neighbours(depends.size());
  for (std::size_t i = 0; i < depends.size(); ++i) {
    for (const int j : depends[i]) {
      if (i == at(j)) continue;
      neighbours[i].push_back(j);
      neighbours[at(j)].push_back(static_cast<int>(i));
    }
  }
  for (auto& list : neighbours) {
    drop_repeats(list);
  }
  return neighbours;
}

KernelSymbols::KernelSymbols(const model::System& system)
    : t(system.t),
      x(system.x),
      p(system.p),
      alpha(system.alpha),
      discrete(system.discrete_states),
      n_psi(static_cast<int>(system.switching.size())) {
  discrete.resize(at(x.numel()), false);
}

CompiledModel::CompiledModel(const model::System& system) : KernelSymbols(system) {
  auto& parameters = start.parameters;
  parameters = system.parameter_values;
  SALTUS_ASSERT(parameters.size() == at(p.numel()));
  fixed_parameters = parameters.size();
  input = SX::densify(system.input);
  const auto with_inputs = [&](const SX& expression) {
    return system.u.numel() == 0 ? expression : SX::substitute(expression, system.u, input);
  };
  free.f = with_inputs(system.f);
  outputs = with_inputs(system.outputs);
  std::vector<SX> rows;
  for (const auto& entry : system.switching) rows.push_back(entry.psi);
  for (const auto& event : system.events) {
    if (event.guards.numel() == 0) rows.push_back(event.value);
  }
  for (const auto& event : system.events) {
    if (event.guards.numel() > 0) rows.push_back(SX::vec(event.guards));
  }
  first_jump_guard = static_cast<int>(SX::vertcat(rows).numel());
  for (const auto& jump : system.jumps) {
    rows.push_back(SX::vec(jump.guards));
    for (casadi_int i = 0; i < jump.guards.numel(); ++i) {
      const SX guard = with_inputs(jump.guards(i));
      jump_guards.push_back({jump.name, guard, jump.targets, with_inputs(jump.values), discrete});
    }
  }
  start.regions = RegionConstants(system, p, parameters);
  start.cells = CellFunctions(system, p, parameters);
  first_activity = parameters.size();
  forces = system.contacts.forces;
  p = SX::vertcat({p, SX::vec(system.contacts.activities), forces});
  parameters.resize(at(p.numel()));
  start.activities.resize(system.contacts.contacts.size());
  for (std::size_t i = 0; i < start.activities.size(); ++i) start.set_activity(first_activity, i, {});
  places = SymbolPlaces(symbols());
  for (auto& end : start.cells.rows(system)) rows.push_back(std::move(end));
  phi = rows.empty() ? SX(0, 1) : with_inputs(SX::vertcat(rows));

  prepares(compiling, 1, compiled_parts);
  const RootLimits limits = limit_roots(free.f, phi(casadi::Slice(0, n_psi)), symbols(), system.parameter_values);
  free.f = limits.f;
  by_values = limits.by_values;
  rooted = limits.rooted;
  continued_roots = limits.continued;
  prepares(compiling, 2, compiled_parts);
  find_structure(system);
  prepares(compiling, 3, compiled_parts);
  compile_functions(system);
  prepares(compiling, 6, compiled_parts);
  find_layout(system);
}

/// Of event functions that are not affine, over t and x; 0 for the others.
ModelFunction CompiledModel::range_function() const {
  if (!functions.functions.program()) return {};
  const std::vector<SX> arguments{t, x, p, alpha};
  SX curved = SX::zeros(phi.numel(), 1);
  for (std::size_t j = 0; j < affine.size(); ++j) {
    if (!affine[j]) curved(static_cast<casadi_int>(j)) = phi(static_cast<casadi_int>(j));
  }
  const SX radii = SX::sym("radii", 1 + x.numel());
  const std::vector<casadi::SXElem> radius = radii.nonzeros();
  std::vector<std::vector<casadi::SXElem>> symbols;
  for (const SX& argument : arguments) symbols.push_back(argument.nonzeros());
  const auto found = model::ranges(casadi::Function("tape", arguments, {curved}), [&](casadi_int i, casadi_int k) {
    const bool moves = i <= 1;
    return model::Range{symbols[at(i)][at(k)], moves ? radius[at(i + k)] : casadi::SXElem(0.0)};
  });
  std::vector<casadi::SXElem> middle, width;
  for (const auto& range : found) {
    middle.push_back(range.middle);
    width.push_back(range.radius);
  }
  return {"saltus_ranges", {t, x, p, alpha, radii}, {SX(middle), SX(width)}};
}

void CompiledModel::compile_functions(const model::System& system) {
  const std::vector<SX> arguments{t, x, p, alpha};
  compile_field(free, "saltus_field");
  prepares(compiling, 4, compiled_parts);
  functions.functions = ModelFunction("saltus_functions", arguments, {phi});
  functions.output_function = ModelFunction("saltus_outputs", arguments, {outputs});
  functions.input_function = ModelFunction("saltus_inputs", arguments, {input});
  functions.jumps = JumpFunctions(system, arguments, input, first_jump_guard);
  prepares(compiling, 5, compiled_parts);
  const SX slope = SX::jacobian(phi, x);
  const SX rate = SX::jacobian(phi, t);
  const SX magnitude = SX::mtimes(fabs(slope), fabs(x)) + fabs(rate * t) + sizes_of_contact_guards(system);
  functions.scales = ModelFunction("saltus_scales", arguments, {magnitude, SX::sum2(fabs(slope))});
  functions.affine_rows = AffineRowFunctions(phi, symbols(), affine);
  if (contains(affine, false)) functions.ranges = range_function();
  functions.gradients.resize(at(phi.numel()));
  compile_conditions(system);
  start.cells.compile(arguments, system, input);
  if (!system.contacts.empty()) compile_contacts(system);
}

void CompiledModel::find_structure(const model::System& system) {
  const int n_phi = static_cast<int>(phi.numel());
  affine = affine_entries(phi, symbols());
  const SX read = with_what_forces_read(phi, system);
  inner = dependencies_of_rows(read, alpha);
  const auto on_states = dependencies_of_rows(read, x);
  if (!forces.is_empty()) {
    const auto on_forces = dependencies_of_rows(phi, forces);
    for (std::size_t j = 0; j < affine.size(); ++j) affine[j] = affine[j] && on_forces[j].empty();
  }
  const auto is_discrete = [&](int state) { return static_cast<bool>(discrete[at(state)]); };
  if (start.cells.size() > 0) on_cells = start.cells.dependencies(dependencies_of_rows(read, p));
  discrete_guards.assign(at(n_phi), false);
  const auto on_time = jump_guards.empty() ? std::vector<std::vector<int>>() : dependencies_of_rows(read, t);
  for (std::size_t k = 0; k < jump_guards.size(); ++k) {
    const auto j = at(first_jump_guard) + k;
    const bool in_cell = !on_cells.empty() && std::any_of(on_cells[j].begin(), on_cells[j].end(), std::identity{});
    discrete_guards[j] = std::all_of(on_states[j].begin(), on_states[j].end(), is_discrete) && on_time[j].empty() &&
                         !in_cell && std::all_of(inner[j].begin(), inner[j].end(), [&](int selection) {
                           return system.switching[at(selection)].role == model::SwitchingRole::discrete;
                         });
  }
  free.depends = normal_dependencies(with_what_forces_read(free.f, system));
  free.neighbours = neighbours_in(free.depends);
}

std::vector<std::vector<int>> CompiledModel::normal_dependencies(const SX& f) const {
  const auto on_states = dependencies_of_rows(phi, x);
  const auto field_on_alpha = dependencies_of_rows(f, alpha);
  std::vector<std::vector<int>> depends(inner.begin(), inner.begin() + n_psi);
  for (std::size_t i = 0; i < depends.size(); ++i) {
    for (const int component : on_states[i]) {
      const auto& selections = field_on_alpha[at(component)];
      depends[i].insert(depends[i].end(), selections.begin(), selections.end());
    }
    drop_repeats(depends[i]);
  }
  return depends;
}

const std::optional<ode::JacobianPattern>& CompiledModel::jacobian_pattern() {
  const SymbolicLock lock;
  if (!pattern_) {
    FieldDependencies dependencies{dependencies_of_rows(free.f, x), dependencies_of_rows(free.f, alpha),
                                   dependencies_of_rows(phi, x), free.neighbours};
    pattern_ = field_pattern(dependencies);
  }
  return *pattern_;
}

const ode::JacobianPattern* ModelKernel::jacobian_pattern() const {
  auto& self = *implementation_;
  if (self.motion != &self.free || !self.regions.groups().empty() || self.contact_solve.is_needed()) return nullptr;
  if (!self.free_pattern) {
    const auto& pattern = self.compiled->jacobian_pattern();
    self.free_pattern = pattern ? &*pattern : nullptr;
  }
  return *self.free_pattern;
}

void CompiledModel::compile_field(CompiledMotion& target, const std::string& name) const {
  const SX moving = SX::vertcat({x, forces}), fixed = p(casadi::Slice(0, p.numel() - forces.numel()));
  const FieldSplit split = split_field(target.f, {t, moving, fixed, alpha});
  target.field = ModelFunction(name, {t, moving, split.symbols}, {split.varying});
  target.constants = ModelFunction(name + "_constants", {fixed, alpha}, {split.constants});
}

void CompiledModel::compile_conditions(const model::System& system) {
  for (const auto& event : system.events) {
    if (event.guards.numel() == 0) {
      functions.conditions.emplace_back();
      continue;
    }
    const SX value = system.u.numel() == 0 ? event.value : SX::substitute(event.value, system.u, input);
    functions.conditions.emplace_back("condition", std::vector<SX>{t, x, p, alpha, event.guard_alpha},
                                      std::vector<SX>{value});
  }
}

ModelKernel::Implementation::Implementation(std::shared_ptr<CompiledModel> model, NativeCode native_code)
    : KernelFunctions(model->functions), compiled(std::move(model)), wanted(native_code) {
  static_cast<KernelValues&>(*this) = compiled->start;
  free = Motion(compiled->free);
  motion = &free;
  slope.resize(at(compiled->x.numel()));
}

Expected<ModelKernel> ModelKernel::of(std::shared_ptr<CompiledModel> model, NativeCode native) {
  const SymbolicLock lock;
  auto implementation = std::make_unique<Implementation>(std::move(model), native);
  if (auto started = implementation->start_native(); !started) return tl::unexpected(started.error());
  return ModelKernel(std::move(implementation));
}

Expected<ModelKernel> ModelKernel::compile(const model::System& system, NativeCode native) {
  const SymbolicLock lock;
  try {
    // The last kernel to go, in whatever thread, drops its expressions.
    const auto drop = [](CompiledModel* model) {
      const SymbolicLock dropping;
      delete model;
    };
    return of(std::shared_ptr<CompiledModel>(new CompiledModel(system), drop), native);
  } catch (const Stopped&) {
    throw;
  } catch (const std::exception& error) {
    return tl::unexpected(Error{ErrorCode::invalid_model,
                                std::string("the model's expressions cannot be compiled: ") + error.what(),
                                "",
                                {},
                                {}});
  }
}

}  // namespace saltus::evaluation
