#include <algorithm>
#include <exception>
#include <utility>
#include <vector>

#include "saltus/base/at.hpp"
#include "saltus/discretization/fesd_checks_internal.hpp"
#include "saltus/discretization/ocp/ocp_kernel_internal.hpp"
#include "saltus/model/time_freezing/time_freezing.hpp"

namespace saltus::discretization {
namespace {

using casadi::SX;
using reformulation::Dcs;

Error no_roots() {
  return ocp_refusal(
      ErrorCode::not_available,
      "[optimize] does not cover roots of a switching function (sqrt(abs(x))): the equations of elements have "
      "infinite derivatives there",
      "replace the root by a smooth function near zero, for example sqrt(abs(x) + 1e-6)");
}

/// Of a part with both of a contact's functions, numbers `gap` and `rate` of its surfaces. In the step form the pairs
/// are those of both selections. Else they are of regions that only the gap tells apart, and that only the rate does.
void take_closing_gap(const model::FrozenContact& contact, const reformulation::DcsPart& part, int gap, int rate,
                      int held, OcpKernel::Implementation& kernel) {
  const auto pair = [&](int selection, bool of_complement) {
    int k = 0;
    while (kernel.pairs[at(k)].selection != part.first + selection) ++k;
    return of_complement ? k + 1 : k;
  };
  if (part.form == reformulation::Form::step) {
    const bool is_opposite = contact.gap.orientation < 0;
    kernel.closing_gaps.push_back({.open = pair(gap, is_opposite),
                                   .closed = pair(gap, !is_opposite),
                                   .closing = pair(rate, contact.normal.orientation < 0),
                                   .held = held < 0 ? -1 : pair(held, false)});
    return;
  }
  const auto other_side = [&](int region, int surface) {
    const auto row = part.signs.row(region);
    std::vector<int> signs(row.begin(), row.end());
    signs[at(surface)] = -signs[at(surface)];
    int other = 0;
    while (!std::ranges::equal(part.signs.row(other), signs)) ++other;
    return other;
  };
  for (int region = 0; region < part.count; ++region) {
    const bool is_open = part.signs(region, gap) == contact.gap.orientation;
    if (!is_open || part.signs(region, rate) == contact.normal.orientation) continue;
    const int behind = other_side(region, gap);
    kernel.closing_gaps.push_back(
        {.open = pair(region, false), .closed = pair(behind, false), .closing = pair(other_side(behind, rate), false)});
  }
}

void take_closing_gaps(const model::Ocp& ocp, const Dcs& dcs, OcpKernel::Implementation& kernel) {
  if (!ocp.system.freezing) return;
  for (const auto& contact : ocp.system.freezing->contacts) {
    for (const auto& part : dcs.parts) {
      int gap = -1, rate = -1, held = -1;
      for (int j = 0; j < static_cast<int>(part.surfaces.size()); ++j) {
        const int function = dcs.surfaces[at(part.surfaces[at(j)])].function;
        if (function == contact.gap.function) gap = j;
        if (function == contact.normal.function) rate = j;
        if (function >= 0 && ocp.system.switching[at(function)].name == contact.name + ".held") held = j;
      }
      if (!contact.is_elastic && gap >= 0 && rate >= 0) take_closing_gap(contact, part, gap, rate, held, kernel);
    }
  }
}

void take_sizes(const model::Ocp& ocp, const Dcs& dcs, OcpKernel::Implementation& kernel) {
  kernel.states = static_cast<int>(dcs.x.numel());
  kernel.selections = static_cast<int>(dcs.selection.numel());
  kernel.pairs = selection_pairs(dcs);
  kernel.parts = dcs.parts;
  kernel.moves = kernel.options.cross_complementarity != CrossComplementarity::same_stage;
  for (std::size_t i = 0; i < ocp.free_parameters.size(); ++i) {
    if (ocp.free_parameters[i])
      kernel.free_parameters.push_back(static_cast<int>(i));
    else
      kernel.fixed_parameters.push_back(ocp.system.parameter_values[i]);
  }
  for (const auto& part : dcs.parts) {
    if (part.form == reformulation::Form::stewart) kernel.simplex_parts.emplace_back(part.first, part.count);
  }
  kernel.simplices = static_cast<int>(kernel.simplex_parts.size());
  take_closing_gaps(ocp, dcs, kernel);
  if (ocp.clock) kernel.clock = ocp.clock->state;
}

/// Between stages a solution is known where they are values of one polynomial.
Error no_polynomial() {
  return ocp_refusal(ErrorCode::not_available, "least_squares at times need a scheme that is a collocation method",
                     "use scheme = \"radau_iia\" or \"gauss_legendre\"");
}

void compile_functions(const OcpExpressions& made, OcpKernel::Implementation& kernel) {
  const auto& element = made.element;
  const auto function = [&](const char* name, const SX& inputs, const LocalExpressions& expressions) {
    return LocalFunction(std::string("saltus_ocp_") + name, inputs, made.parameters, expressions);
  };
  kernel.element = function("element", element.element_inputs, element.element);
  kernel.running = function("running", made.running_inputs, made.running);
  kernel.stage_squares = function("stage_squares", element.element_inputs, made.stage_squares);
  kernel.stage_rows = function("stage_rows", made.stage_inputs, made.stage_rows);
  kernel.node_squares = function("node_squares", made.node_inputs, made.node_squares);
  kernel.node_rows = function("node_rows", made.node_row_inputs, made.node_rows);
  kernel.first_rows = function("first_rows", made.node_row_inputs, made.first_rows);
  kernel.slack_rows = function("slack_rows", made.slack_inputs, made.slack_rows);
  kernel.terminal = function("terminal", made.node_inputs, made.terminal);
  kernel.end_squares = function("end_squares", made.node_inputs, made.end_squares);
  kernel.measured_squares = function("measured_squares", made.measured_inputs, made.measured_squares);
  kernel.terminal_rows = function("terminal_rows", made.terminal_row_inputs, made.terminal_rows);
  kernel.start = function("start", made.start_inputs, made.start);
  kernel.equilibration = function("equilibration", element.boundary_inputs, element.boundary);
  kernel.departure = function("departure", element.element_inputs, made.departure);
  kernel.neighbours = function("neighbours", element.boundary_inputs, element.neighbours);
}

}  // namespace

OcpKernel::OcpKernel(std::unique_ptr<Implementation> implementation) : implementation_(std::move(implementation)) {}
OcpKernel::~OcpKernel() = default;

Expected<std::shared_ptr<OcpKernel>> OcpKernel::compile(const model::Ocp& ocp, const Dcs& dcs,
                                                        const ButcherTableau& tableau, const FesdOptions& options,
                                                        evaluation::NativeCode native) {
  if (auto checked = check(options); !checked) return tl::unexpected(checked.error());
  if (!dcs.root_exponents.empty()) return tl::unexpected(no_roots());
  if (has_measurements(ocp) && !tableau.is_collocation()) return tl::unexpected(no_polynomial());
  try {
    auto kernel = std::make_unique<Implementation>();
    kernel->tableau = tableau;
    kernel->options = options;
    take_sizes(ocp, dcs, *kernel);
    auto made = ocp_expressions(ocp, dcs, *kernel);
    if (!made) return tl::unexpected(made.error());
    kernel->layout = made->element.layout;
    kernel->depends_on_time = made->element.depends_on_time;
    kernel->boundary_bounds = made->element.boundary_own_bounds;
    kernel->correction_pairs = 2 * (kernel->layout.correction.count > 0 ? kernel->selections : 0);
    compile_functions(*made, *kernel);
    kernel->indicator = casadi::Function("saltus_indicator", {dcs.t, dcs.x, made->known}, {dcs.indicator});
    SX arguments(0, 1);
    for (const auto& symbol : dcs.held_symbols) arguments = SX::vertcat({arguments, symbol.argument});
    kernel->held_arguments = casadi::Function("saltus_held", {dcs.t, dcs.x, made->known}, {arguments});
    std::vector<model::ModelFunction*> functions;
    for (LocalFunction* function :
         {&kernel->element, &kernel->running, &kernel->stage_squares, &kernel->stage_rows, &kernel->node_squares,
          &kernel->node_rows, &kernel->first_rows, &kernel->slack_rows, &kernel->terminal, &kernel->end_squares,
          &kernel->measured_squares, &kernel->terminal_rows, &kernel->start, &kernel->equilibration,
          &kernel->neighbours, &kernel->departure}) {
      function->join(kernel->native, functions);
    }
    auto started = kernel->native.start(native, std::move(functions));
    if (!started) return tl::unexpected(started.error());
    return std::shared_ptr<OcpKernel>(new OcpKernel(std::move(kernel)));
  } catch (const std::exception& error) {
    return tl::unexpected(
        ocp_refusal(ErrorCode::invalid_model,
                    std::string("the finite element of the problem cannot be compiled: ") + error.what(), ""));
  }
}

}  // namespace saltus::discretization
