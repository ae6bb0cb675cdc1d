#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/discretization/element_expressions_internal.hpp"
#include "saltus/discretization/ocp/element_trial_internal.hpp"
#include "saltus/discretization/ocp/ocp_problem_internal.hpp"

namespace saltus::discretization {
namespace {

using mpcc::ActiveSide;
using mpcc::ConstVectorView;
using Sides = std::vector<ActiveSide>;

/// A selection that reaches its bound at the end of sliding.
struct Departure {
  int selection = 0;
  bool at_upper = false;
};

/// The one at the left end of element e, if nothing else happens there. A switch or a beginning of sliding is an
/// equation for the boundary, the end of sliding is none.
std::optional<Departure> departure_at(const OcpStructure& made, const ElementSides& modes, std::size_t e) {
  const auto& pairs = made.kernel.pairs;
  std::optional<Departure> departure;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    if (pairs[k].is_region) {
      // A region is active where lambda is zero: sliding ends where one of several becomes inactive.
      const bool was_active = modes.of(e - 1, k) == ActiveSide::H;
      const bool is_active = modes.of(e, k) == ActiveSide::H;
      if (!was_active && is_active) return std::nullopt;
      if (was_active && !is_active && !departure) departure = {.selection = pairs[k].selection, .at_upper = false};
      continue;
    }
    if (pairs[k].complement) continue;  // looked at together with the row before it
    const auto slides = [&](std::size_t element) {
      return modes.of(element, k) == ActiveSide::H && modes.of(element, k + 1) == ActiveSide::H;
    };
    const bool differs = modes.of(e - 1, k) != modes.of(e, k) || modes.of(e - 1, k + 1) != modes.of(e, k + 1);
    if (!differs) continue;
    if (!slides(e - 1)) return std::nullopt;
    const bool to_upper = modes.of(e, k + 1) == ActiveSide::G;
    if (!departure) departure = {.selection = pairs[k].selection, .at_upper = to_upper};
  }
  return departure;
}

/// Where the right end is a stage, the selection has its bound there; elsewhere it leaves its surface tangentially.
mpcc::BranchClosure::Freedom freedom_of(const OcpStructure& made, const ElementSides& modes) {
  mpcc::BranchClosure::Freedom freedom;
  const auto& kernel = made.kernel;
  for (std::size_t e = 1; e < made.element.size() && kernel.moves && !kernel.layout.has_end_point; ++e) {
    const auto departure = made.element[e].number > 0 ? departure_at(made, modes, e) : std::nullopt;
    if (!departure) continue;
    const int local = kernel.layout.selection.at(kernel.layout.stages - 1, departure->selection);
    (departure->at_upper ? freedom.at_upper : freedom.at_lower).push_back(made.element[e - 1].variable(local));
  }
  for (const auto& placed : made.functions) {
    if (!placed.is_dormant) continue;
    for (const auto& one : placed.copies) {
      const auto departure = departure_at(made, modes, static_cast<std::size_t>(one.element));
      if (departure) freedom.rows.push_back(one.first_row + departure->selection);
    }
  }
  return freedom;
}

/// ClosingGap: selections that stay where they are, at a bound.
void hold_closing_gaps(const OcpStructure& made, const ElementSides& modes, std::size_t e,
                       mpcc::BranchClosure& closure) {
  if (made.kernel.closing_gaps.empty()) return;
  for (const auto& held : held_while_closing(made.kernel, modes.modes(e))) {
    (held.at_upper ? closure.at_upper : closure.at_lower).push_back(made.element[e].variable(held.local));
  }
}

}  // namespace

mpcc::BranchClosure OcpProblem::close_branch(const Sides& sides) const {
  const auto& made = *implementation_->structure;
  const auto& kernel = made.kernel;
  mpcc::BranchClosure closure;
  closure.at_lower = made.boundary_own;
  for (const auto& placed : made.functions) {
    if (!placed.of_method) continue;
    for (const auto& one : placed.copies) {
      for (int i = 0; i < placed.function->equations(); ++i) closure.dropped_rows.push_back(one.first_row + i);
    }
  }
  const bool of_stages_only = kernel.options.cross_complementarity == CrossComplementarity::paper;
  const bool equal_lengths = kernel.moves && kernel.options.step_equilibration != StepEquilibration::none;
  const ElementSides modes(made, sides);
  for (std::size_t e = 0; e < made.element.size(); ++e) {
    // Complementarities of the same stage say nothing of the left end.
    const auto left = made.left_lambda(static_cast<int>(e));
    for (std::size_t k = 0; k < kernel.pairs.size() && of_stages_only; ++k) {
      if (modes.of(e, k) == ActiveSide::H && left[k] >= 0) closure.at_lower.push_back(left[k]);
    }
    hold_closing_gaps(made, modes, e, closure);
    if (!equal_lengths || made.element[e].number == 0 || !modes.are_equal(e - 1, e)) continue;
    closure.equal.emplace_back(made.element[e - 1].length, made.element[e].length);
  }
  closure.freedom = freedom_of(made, modes);
  return closure;
}

void OcpProblem::complete(mpcc::VectorView w) {
  const auto& made = *implementation_->structure;
  if (made.boundary_own.empty()) return;
  for (const int i : made.boundary_own) w[i] = 0.0;
  linalg::Vector c(rows());
  functions(w, c);
  const int equations = made.kernel.equilibration.equations();
  for (const auto& placed : made.functions) {
    if (placed.function != &made.kernel.equilibration) continue;
    auto own = made.boundary_own.begin();
    for (const auto& one : placed.copies) {
      const auto first_sides = c.segment(made.n_g + one.first_pair, placed.function->pairs());
      for (const double value : boundary_values(first_sides, c[one.first_row + equations - 1])) w[*own++] = value;
    }
  }
}

std::vector<int> OcpProblem::crowded_intervals(ConstVectorView w, const linalg::Vector& upper, double tolerance) const {
  const auto& made = *implementation_->structure;
  std::set<int> crowded = implementation_->crowded;
  for (const auto& element : made.element) {
    const int h = element.length;
    // A bound of 1 is none: the others are as short as they can be.
    if (h < 0 || upper.size() <= h || made.w_bounds.upper[h] >= 1.0 || !(upper[h] > tolerance)) continue;
    if (w[h] > made.w_bounds.upper[h] - vanished) crowded.insert(element.interval);
  }
  return {crowded.begin(), crowded.end()};
}

}  // namespace saltus::discretization
