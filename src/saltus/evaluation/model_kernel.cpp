#include "saltus/evaluation/model_kernel.hpp"

#include <algorithm>
#include <exception>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include <casadi/core/code_generator.hpp>

#include "saltus/base/contracts.hpp"
#include "saltus/evaluation/affine_functions_internal.hpp"
#include "saltus/evaluation/cell_functions_internal.hpp"
#include "saltus/evaluation/field_split_internal.hpp"
#include "saltus/evaluation/held_motion_internal.hpp"
#include "saltus/evaluation/jump_functions_internal.hpp"
#include "saltus/evaluation/model_function_internal.hpp"
#include "saltus/evaluation/native_code.hpp"
#include "saltus/model/system.hpp"

namespace saltus::evaluation {
namespace {

using casadi::SX;

std::size_t index(int i) { return static_cast<std::size_t>(i); }

/// For every row of `expression`, which entries of `variables` it depends on.
std::vector<std::vector<int>> dependencies(const SX& expression, const SX& variables) {
  std::vector<std::vector<int>> rows(index(static_cast<int>(expression.numel())));
  if (expression.numel() == 0 || variables.numel() == 0) return rows;
  const auto sparsity = SX::jacobian_sparsity(SX::densify(expression), variables);
  const casadi_int* column_start = sparsity.colind();
  const casadi_int* row = sparsity.row();
  for (casadi_int column = 0; column < sparsity.size2(); ++column) {
    for (casadi_int k = column_start[column]; k < column_start[column + 1]; ++k) {
      rows[static_cast<std::size_t>(row[k])].push_back(static_cast<int>(column));
    }
  }
  return rows;
}

/// d phi_j / d (x, t). Of a function that is affine, and does not hold selections, it is a constant: evaluated once.
struct Gradient {
  ModelFunction function;
  std::vector<double> constant;  ///< row and rate, once known
};

}  // namespace

/// xdot = f, free or with guards held, and what follows from it.
struct Motion {
  SX f;
  ModelFunction field;      ///< of t, x and the constants
  ModelFunction constants;  ///< of p and alpha
  ModelFunction pressure;   ///< of the holds; null without
  std::vector<std::vector<bool>> depends;
  std::map<std::pair<int, int>, ModelFunction> lie_derivatives;
  std::map<std::pair<int, int>, SX> lie_expressions;
  std::map<std::pair<int, int>, AffineRowFunction> lie_rows;  ///< by function and fixed component
};

struct ModelKernel::Implementation {
  SX t, x, p, alpha;  ///< p: parameters, then constants, upper and lower ends of cells
  SX phi, outputs, input;
  std::vector<double> parameters;  ///< values of p
  std::vector<bool> discrete;      ///< n_x
  int n_psi = 0;

  CellFunctions cells;
  std::vector<std::vector<bool>> on_cells;  ///< by event function

  ModelFunction functions, scales, output_function, input_function;
  std::vector<ModelFunction> conditions;  ///< one per [[events]] entry; null for expressions
  JumpFunctions jumps;
  std::vector<bool> affine, time_only;
  AffineRowFunctions affine_rows;
  FieldConstants constants;  ///< work space of field()
  std::vector<std::vector<int>> inner;
  std::vector<Gradient> gradients;  ///< one per event function, compiled when first asked for
  Motion free;
  std::vector<HeldGuard> jump_guards;  ///< by event function, from first_jump_guard on
  int first_jump_guard = 0;
  std::map<std::vector<int>, Motion> held;  ///< by event functions; compiled when first held
  Motion* motion = &free;
  long field_evaluations = 0;

  NativeCode native = NativeCode::off;
  double operations = 0.0;    ///< interpreted so far
  double next_attempt = 0.0;  ///< to find or compile native code, in operations
  std::string source;         ///< C source, once it was needed
  std::optional<NativeLibrary> library;

  explicit Implementation(const model::System& system);
  SX phi_row(int j) const { return phi(j); }
  ModelSymbols symbols() const { return {t, x, p, alpha}; }
  SX lie_expression(int j, int order);
  void compile_field(Motion& target, const std::string& name) const;
  void find_structure();
  [[nodiscard]] std::vector<std::vector<bool>> normal_dependencies(const SX& f) const;
  [[nodiscard]] Expected<Motion> compile_held(const std::vector<int>& functions) const;
  void compile_conditions(const model::System& system);
  void count(const ModelFunction& function);
  void look_for_native();
  void write_source();
  void use(NativeLibrary loaded);
};

/// Interpreted operations (about 5 ns each) after which looking into the cache, then compiling (tenths of a second)
/// pays.
constexpr double look_after = 2e6;
constexpr double compile_after = 1e8;

void ModelKernel::Implementation::write_source() {
  if (!source.empty()) return;
  casadi::CodeGenerator generator("saltus_model.c", {{"with_header", false}});
  for (const auto* function : {&free.field, &free.constants, &functions, &scales, &output_function, &input_function}) {
    generator.add(function->function());
  }
  source = generator.dump();
}

void ModelKernel::Implementation::use(NativeLibrary loaded) {
  for (auto* function : {&free.field, &free.constants, &functions, &scales, &output_function, &input_function}) {
    function->use_native(reinterpret_cast<ModelFunction::Native>(loaded.symbol(function->function().name())));
  }
  library = std::move(loaded);
}

/// native = auto: the cache after some work, the compiler after more. Results are bit-identical, so the moment is free.
void ModelKernel::Implementation::look_for_native() {
  write_source();
  auto found = find_native(source);
  if (!found && operations >= compile_after) {
    if (auto compiled = compile_native(source)) found = std::move(*compiled);
    native = NativeCode::off;  // one attempt: without a compiler the interpreter goes on
  }
  next_attempt = compile_after;
  if (!found) return;
  native = NativeCode::off;
  use(std::move(*found));
}

void ModelKernel::Implementation::count(const ModelFunction& function) {
  if (native != NativeCode::automatic) return;
  operations += static_cast<double>(function.operations());
  if (operations >= next_attempt) look_for_native();
}

ModelKernel::Implementation::Implementation(const model::System& system)
    : t(system.t),
      x(system.x),
      p(system.p),
      alpha(system.alpha),
      parameters(system.parameter_values),
      n_psi(static_cast<int>(system.switching.size())) {
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
  discrete = system.discrete_states;
  discrete.resize(index(static_cast<int>(x.numel())), false);
  for (const auto& jump : system.jumps) {
    rows.push_back(SX::vec(jump.guards));
    for (casadi_int i = 0; i < jump.guards.numel(); ++i) {
      const SX guard = with_inputs(jump.guards(i));
      jump_guards.push_back({jump.name, guard, jump.targets, with_inputs(jump.values), discrete});
    }
  }
  cells = CellFunctions(system, p, parameters);
  for (auto& end : cells.rows(system)) rows.push_back(std::move(end));
  phi = rows.empty() ? SX(0, 1) : with_inputs(SX::vertcat(rows));
  gradients.resize(index(static_cast<int>(phi.numel())));

  const std::vector<SX> arguments{t, x, p, alpha};
  compile_field(free, "saltus_field");
  functions = ModelFunction("saltus_functions", arguments, {phi});
  output_function = ModelFunction("saltus_outputs", arguments, {outputs});
  input_function = ModelFunction("saltus_inputs", arguments, {input});
  const SX slope = SX::jacobian(phi, x);
  const SX rate = SX::jacobian(phi, t);
  const SX magnitude = SX::mtimes(fabs(slope), fabs(x)) + fabs(rate * t);
  scales = ModelFunction("saltus_scales", arguments, {magnitude, SX::sum2(fabs(slope))});
  find_structure();
  compile_conditions(system);
  jumps = JumpFunctions(system, arguments, input, first_jump_guard);
  cells.compile(arguments, system, input);
}

void ModelKernel::Implementation::find_structure() {
  const int n_phi = static_cast<int>(phi.numel());
  affine = affine_entries(phi, symbols());
  affine_rows = AffineRowFunctions(phi, symbols(), affine);
  time_only.assign(index(n_phi), true);
  inner = dependencies(phi, alpha);
  const auto on_states = dependencies(phi, x);
  const auto is_discrete = [&](int state) { return static_cast<bool>(discrete[index(state)]); };
  for (int j = 0; j < n_phi; ++j) {
    const auto& states = on_states[index(j)];
    time_only[index(j)] = std::all_of(states.begin(), states.end(), is_discrete);
  }
  if (cells.size() > 0) on_cells = cells.dependencies(dependencies(phi, p));
  free.depends = normal_dependencies(free.f);
}

std::vector<std::vector<bool>> ModelKernel::Implementation::normal_dependencies(const SX& f) const {
  const auto on_states = dependencies(phi, x);
  const auto field_on_alpha = dependencies(f, alpha);
  std::vector<std::vector<bool>> depends(index(n_psi), std::vector<bool>(index(n_psi), false));
  for (int i = 0; i < n_psi; ++i) {
    for (const int component : on_states[index(i)]) {
      for (const int j : field_on_alpha[index(component)]) depends[index(i)][index(j)] = true;
    }
    for (const int j : inner[index(i)]) depends[index(i)][index(j)] = true;
  }
  return depends;
}

Expected<Motion> ModelKernel::Implementation::compile_held(const std::vector<int>& functions_held) const {
  std::vector<HeldGuard> guards;
  for (const int function : functions_held) {
    SALTUS_ASSERT(first_jump_guard <= function && function < static_cast<int>(phi.numel()));
    guards.push_back(jump_guards[index(function - first_jump_guard)]);
  }
  auto expressions = held_motion(t, x, free.f, guards);
  if (!expressions) return tl::unexpected(expressions.error());
  Motion result;
  result.f = expressions->f;
  compile_field(result, "held_field");
  result.pressure = ModelFunction("hold_pressure", {t, x, p, alpha}, {expressions->pressure});
  result.depends = normal_dependencies(result.f);
  return result;
}

void ModelKernel::Implementation::compile_field(Motion& target, const std::string& name) const {
  const FieldSplit split = split_field(target.f, symbols());
  target.field = ModelFunction(name, {t, x, split.symbols}, {split.varying});
  target.constants = ModelFunction(name + "_constants", {p, alpha}, {split.constants});
}

void ModelKernel::Implementation::compile_conditions(const model::System& system) {
  for (const auto& event : system.events) {
    if (event.guards.numel() == 0) {
      conditions.emplace_back();
      continue;
    }
    const SX value = system.u.numel() == 0 ? event.value : SX::substitute(event.value, system.u, input);
    conditions.emplace_back("condition", std::vector<SX>{t, x, p, alpha, event.guard_alpha}, std::vector<SX>{value});
  }
}

SX ModelKernel::Implementation::lie_expression(int j, int order) {
  if (order == 0) return phi_row(j);
  const auto key = std::make_pair(j, order);
  auto& known = motion->lie_expressions;
  if (const auto found = known.find(key); found != known.end()) return found->second;
  const SX previous = lie_expression(j, order - 1);
  const SX next = SX::mtimes(SX::jacobian(previous, x), motion->f) + SX::jacobian(previous, t);
  known[key] = next;
  return next;
}

ModelKernel::ModelKernel(std::unique_ptr<Implementation> implementation) : implementation_(std::move(implementation)) {}
ModelKernel::ModelKernel(ModelKernel&&) noexcept = default;
ModelKernel& ModelKernel::operator=(ModelKernel&&) noexcept = default;
ModelKernel::~ModelKernel() = default;

Expected<ModelKernel> ModelKernel::compile(const model::System& system, NativeCode native) {
  try {
    auto implementation = std::make_unique<Implementation>(system);
    if (native == NativeCode::on) {
      implementation->write_source();
      auto library = find_native(implementation->source);
      if (!library) {
        auto compiled = compile_native(implementation->source);
        if (!compiled) return tl::unexpected(compiled.error());
        library = std::move(*compiled);
      }
      implementation->use(std::move(*library));
    } else {
      implementation->native = native;
      implementation->next_attempt = look_after;
    }
    return ModelKernel(std::move(implementation));
  } catch (const std::exception& error) {
    return tl::unexpected(Error{ErrorCode::invalid_model,
                                std::string("the model's expressions cannot be compiled: ") + error.what(),
                                "",
                                {},
                                {}});
  }
}

int ModelKernel::states() const { return static_cast<int>(implementation_->x.numel()); }
int ModelKernel::switching_functions() const { return implementation_->n_psi; }
int ModelKernel::event_functions() const { return static_cast<int>(implementation_->phi.numel()); }
int ModelKernel::outputs() const { return static_cast<int>(implementation_->outputs.numel()); }
int ModelKernel::controls() const { return static_cast<int>(implementation_->input.numel()); }
long ModelKernel::field_evaluations() const { return implementation_->field_evaluations; }

void ModelKernel::field(double t, const double* x, const double* alpha, double* xdot) const {
  auto& self = *implementation_;
  prepare_field(alpha, self.constants);
  prepared_field(t, x, self.constants, xdot);
}

void ModelKernel::prepare_field(const double* alpha, FieldConstants& constants) const {
  auto& self = *implementation_;
  auto& function = self.motion->constants;
  constants.values.resize(index(static_cast<int>(function.function().numel_out(0))));
  constants.alpha.assign(alpha, alpha + self.n_psi);
  constants.motion = self.motion;
  self.count(function);
  function(std::array<const double*, 2>{self.parameters.data(), alpha},
           std::array<double*, 1>{constants.values.data()});
}

void ModelKernel::prepared_field(double t, const double* x, const FieldConstants& constants, double* xdot) const {
  auto& self = *implementation_;
  if (constants.motion != self.motion) return field(t, x, constants.alpha.data(), xdot);
  ++self.field_evaluations;
  self.count(self.motion->field);
  self.motion->field(std::array<const double*, 3>{&t, x, constants.values.data()}, std::array<double*, 1>{xdot});
}

void ModelKernel::functions(double t, const double* x, const double* alpha, double* values) const {
  auto& self = *implementation_;
  self.count(self.functions);
  self.functions(std::array<const double*, 4>{&t, x, self.parameters.data(), alpha}, std::array<double*, 1>{values});
}

void ModelKernel::scales(double t, const double* x, const double* alpha, double* magnitude, double* slope) const {
  auto& self = *implementation_;
  self.scales(std::array<const double*, 4>{&t, x, self.parameters.data(), alpha},
              std::array<double*, 2>{magnitude, slope});
}

void ModelKernel::gradient(int function, double t, const double* x, const double* alpha, double* row,
                           double* rate) const {
  SALTUS_ASSERT(0 <= function && function < event_functions());
  auto& self = *implementation_;
  auto& gradient = self.gradients[index(function)];
  const auto n = self.x.numel();
  if (!gradient.constant.empty()) {
    std::copy_n(gradient.constant.begin(), n, row);
    *rate = gradient.constant.back();
    return;
  }
  if (gradient.function.is_null()) {
    const SX phi = self.phi_row(function);
    gradient.function = ModelFunction("gradient", {self.t, self.x, self.p, self.alpha},
                                      {SX::jacobian(phi, self.x), SX::jacobian(phi, self.t)});
  }
  gradient.function(std::array<const double*, 4>{&t, x, self.parameters.data(), alpha},
                    std::array<double*, 2>{row, rate});
  if (is_affine(function) && inner(function).empty()) {
    gradient.constant.assign(row, row + n);
    gradient.constant.push_back(*rate);
  }
}

double ModelKernel::lie_derivative(int function, int order, double t, const double* x, const double* alpha) const {
  SALTUS_ASSERT(0 <= function && function < event_functions() && order >= 1);
  auto& self = *implementation_;
  auto& compiled = self.motion->lie_derivatives[{function, order}];
  if (compiled.is_null()) {
    compiled =
        ModelFunction("lie_derivative", {self.t, self.x, self.p, self.alpha}, {self.lie_expression(function, order)});
  }
  double value = 0.0;
  compiled(std::array<const double*, 4>{&t, x, self.parameters.data(), alpha}, std::array<double*, 1>{&value});
  return value;
}

void ModelKernel::outputs(double t, const double* x, const double* alpha, double* values) const {
  auto& self = *implementation_;
  self.output_function(std::array<const double*, 4>{&t, x, self.parameters.data(), alpha},
                       std::array<double*, 1>{values});
}

void ModelKernel::inputs(double t, const double* alpha, double* values) const {
  auto& self = *implementation_;
  self.input_function(std::array<const double*, 4>{&t, nullptr, self.parameters.data(), alpha},
                      std::array<double*, 1>{values});
}

bool ModelKernel::condition(int event, double t, const double* x, const double* alpha,
                            const double* guard_alpha) const {
  auto& self = *implementation_;
  double value = 0.0;
  self.conditions[index(event)](std::array<const double*, 5>{&t, x, self.parameters.data(), alpha, guard_alpha},
                                std::array<double*, 1>{&value});
  return value > 0.5;
}

int ModelKernel::jump_guard(int jump, int guard) const { return implementation_->jumps.guard(jump, guard); }

bool ModelKernel::jump_condition(int jump, double t, const double* x, const double* alpha,
                                 const double* guard_alpha) const {
  auto& self = *implementation_;
  return self.jumps.condition(jump, {&t, x, self.parameters.data(), alpha}, guard_alpha);
}

void ModelKernel::jump_values(int jump, double t, const double* x, const double* alpha, double* values) const {
  auto& self = *implementation_;
  self.jumps.values(jump, {&t, x, self.parameters.data(), alpha}, values);
}

double ModelKernel::jump_priority(int jump, double t, const double* x, const double* alpha) const {
  auto& self = *implementation_;
  return self.jumps.priority(jump, {&t, x, self.parameters.data(), alpha});
}

double ModelKernel::jump_delay(int jump, double t, const double* x, const double* alpha) const {
  auto& self = *implementation_;
  return self.jumps.delay(jump, {&t, x, self.parameters.data(), alpha});
}

Expected<void> ModelKernel::hold(const std::vector<Hold>& holds) {
  auto& self = *implementation_;
  if (holds.empty()) {
    self.motion = &self.free;
    return {};
  }
  std::vector<int> functions;
  for (const auto& hold : holds) functions.push_back(hold.function);
  auto known = self.held.find(functions);
  if (known == self.held.end()) {
    auto motion = self.compile_held(functions);
    if (!motion) return tl::unexpected(motion.error());
    known = self.held.emplace(functions, std::move(*motion)).first;
  }
  self.motion = &known->second;
  return {};
}

void ModelKernel::hold_pressure(double t, const double* x, const double* alpha, double* pressure) const {
  auto& self = *implementation_;
  SALTUS_ASSERT(!self.motion->pressure.is_null());
  self.motion->pressure(std::array<const double*, 4>{&t, x, self.parameters.data(), alpha},
                        std::array<double*, 1>{pressure});
}

int ModelKernel::cells() const { return implementation_->cells.size(); }
int ModelKernel::cell_function(int cell) const { return event_functions() - 2 * (cells() - cell); }
const model::CellTable& ModelKernel::cell_table(int cell) const { return implementation_->cells.table(cell); }
long ModelKernel::cell(int cell) const { return implementation_->cells.index(cell); }

void ModelKernel::set_cell(int cell, long target) const {
  auto& self = *implementation_;
  self.cells.move(cell, target, self.parameters);
  for (std::size_t j = 0; j < self.on_cells.size(); ++j) {
    if (self.on_cells[j][index(cell)]) self.gradients[j].constant.clear();
  }
}

double ModelKernel::cell_argument(int cell, double t, const double* x, const double* alpha) const {
  return implementation_->cells.argument(cell, {&t, x, implementation_->parameters.data(), alpha});
}

bool ModelKernel::depends_on_cell(int function, int cell) const {
  return implementation_->on_cells[index(function)][index(cell)];
}

bool ModelKernel::is_affine(int function) const { return implementation_->affine[index(function)]; }
void ModelKernel::affine_rows(const double* alpha, AffineRows& rows) const {
  implementation_->affine_rows.fill(implementation_->parameters.data(), alpha, rows);
}

bool ModelKernel::lie_row(int function, FixedState fixed, const double* alpha, AffineRow& row) const {
  auto& self = *implementation_;
  const auto [entry, is_new] = self.motion->lie_rows.try_emplace({function, fixed.component});
  if (is_new) {
    entry->second = AffineRowFunction(self.lie_expression(function, 1), self.symbols(), fixed.component);
  }
  if (!entry->second.is_affine()) return false;
  entry->second.fill(fixed, self.parameters.data(), alpha, row);
  return true;
}

bool ModelKernel::is_time_only(int function) const { return implementation_->time_only[index(function)]; }
const std::vector<int>& ModelKernel::inner(int function) const { return implementation_->inner[index(function)]; }
bool ModelKernel::depends(int surface, int alpha) const {
  return implementation_->motion->depends[index(surface)][index(alpha)];
}

}  // namespace saltus::evaluation
