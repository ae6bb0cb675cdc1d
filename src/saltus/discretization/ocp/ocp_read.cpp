#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/discretization/ocp/ocp_problem_internal.hpp"

namespace saltus::discretization {

using mpcc::ConstVectorView;

namespace {

SolvedElement read_element(const OcpStructure& made, int number, ConstVectorView w, double t, double h,
                           const linalg::Vector& left) {
  const auto& kernel = made.kernel;
  const auto& layout = kernel.layout;
  const auto& element = made.element[at(number)];
  const auto matrix = [&](const VariableBlock& block) {
    return linalg::ConstView(w.data() + element.variable(block.first), block.size, block.count);
  };
  SolvedElement one;
  one.t = t;
  one.h = h;
  one.states = matrix(layout.stage);
  if (kernel.options.representation == Representation::differential) {
    const linalg::Matrix increments = h * one.states * kernel.tableau.A.transpose();
    one.states = linalg::plus_column(increments, left);
  }
  one.selections = matrix(layout.selection);
  one.lambda.resize(layout.lambda.size, layout.lambda.count + 1);
  const auto places = made.left_lambda(number);
  for (int i = 0; i < layout.lambda.size; ++i) one.lambda(i, 0) = value_at(places[at(i)], w, made.constants);
  one.lambda.right_cols(layout.lambda.count) = matrix(layout.lambda);
  one.end = w.segment(element.variable(layout.right_state()), kernel.states);
  return one;
}

}  // namespace

OcpSolution OcpProblem::read(ConstVectorView w) const {
  const auto& own = *implementation_;
  const auto& made = *own.structure;
  const auto& kernel = made.kernel;
  OcpSolution solution;
  solution.horizon = own.value(made.horizon, w);
  solution.parameters.assign(kernel.free_parameters.size() + kernel.fixed_parameters.size(), 0.0);
  for (std::size_t i = 0, fixed = 0, free = 0; i < solution.parameters.size(); ++i) {
    const bool is_free = free < kernel.free_parameters.size() && kernel.free_parameters[free] == static_cast<int>(i);
    solution.parameters[i] = is_free ? w[made.parameters[free++]] : kernel.fixed_parameters[fixed++];
  }
  for (const int place : made.start.state) solution.initial_state.push_back(own.value(place, w));
  linalg::Vector left = linalg::ConstView(solution.initial_state.data(), kernel.states);
  const auto& sizes = kernel.shared;
  double start = made.from;
  for (const auto& interval : made.interval) {
    auto& controls = solution.controls.emplace_back();
    for (int i = 0; i < sizes.controls; ++i) controls.push_back(own.value(interval.shared[at(i)], w));
    const double speed = own.value(interval.shared[at(sizes.controls + sizes.parameters + sizes.held + 1)], w);
    solution.speed_of_time.push_back(speed);
    const double length = speed * solution.horizon / made.intervals;
    double t = start;
    auto& elements = solution.elements.emplace_back();
    for (int n = 0; n < interval.elements; ++n) {
      const double h = own.value(made.element[at(interval.first_element + n)].length, w) * length;
      elements.push_back(read_element(made, interval.first_element + n, w, t, h, left));
      t += h;
      left = elements.back().end;
    }
    start += length;
  }
  return solution;
}

result::ObjectiveTerms OcpProblem::objective_terms(ConstVectorView w) {
  auto& own = *implementation_;
  result::ObjectiveTerms terms;
  terms.running = own.term(Term::running, w);
  terms.terminal = own.term(Term::terminal, w);
  terms.least_squares = own.term(Term::least_squares, w);
  terms.time = own.time_weight * own.value(own.structure->horizon, w);
  terms.penalties = own.penalties(w);
  return terms;
}

std::vector<result::ConstraintMultiplier> OcpProblem::constraint_multipliers(ConstVectorView w, ConstVectorView rows,
                                                                             ConstVectorView bounds) const {
  const auto& own = *implementation_;
  const auto& made = *own.structure;
  std::vector<result::ConstraintMultiplier> found;
  const OcpSolution solution = read(w);
  const auto end_of = [&](int number) {
    const auto& element = made.element[at(number)];
    const auto& one = solution.elements[at(element.interval)][at(element.number)];
    // Where time stands still, that of the elements is not the one of the user.
    return made.kernel.clock < 0 ? one.t + one.h : one.end[made.kernel.clock];
  };
  for (const auto& placed : made.functions) {
    // Rows of slacks are none of the user's.
    if (placed.bounds == nullptr || placed.bounds == &made.kernel.slack_bounds ||
        placed.bounds == &made.kernel.running_bounds)
      continue;
    const bool terminal = placed.function == &made.kernel.terminal_rows;
    for (const auto& one : placed.copies) {
      for (std::size_t i = 0; i < placed.bounds->size(); ++i) {
        const int constraint = (*placed.bounds)[i].constraint;
        const auto& name = constraint < 0 ? own.state_names[at(-1 - constraint)]
                           : terminal     ? own.terminal_names[at(constraint)]
                                          : own.path_names[at(constraint)];
        found.push_back(
            {name, one.element < 0 ? made.from : end_of(one.element), rows[one.first_row + static_cast<int>(i)]});
      }
    }
  }
  for (int e = 0; e < static_cast<int>(made.element.size()); ++e) {
    for (int i = 0; i < made.kernel.states; ++i) {
      const int variable = made.element[at(e)].variable(made.kernel.layout.right_state() + i);
      if (bounds.size() != w.size() || bounds[variable] == 0.0) continue;
      if (std::abs(bounds[variable]) < 1e-9) continue;  // a bound that does not press
      found.push_back({own.state_names[at(i)], end_of(e), bounds[variable]});
    }
  }
  return found;
}

std::string OcpProblem::not_finite(ConstVectorView w) {
  auto& own = *implementation_;
  auto& made = *own.structure;
  linalg::Vector c = linalg::Vector::zero(rows());
  for (const auto& placed : made.functions) {
    if (!std::isfinite(placed.placed->objective(w, made.constants, made.local_parameters))) return placed.what;
  }
  functions(w, c);
  for (linalg::Index i = 0; i < c.size(); ++i) {
    if (!std::isfinite(c[i])) return row_name(static_cast<int>(i));
  }
  return {};
}

std::string OcpProblem::name(int variable) const {
  const auto& made = *implementation_->structure;
  if (const auto& given = made.names[at(variable)]; !given.empty()) return given;
  const auto behind = std::upper_bound(made.element.begin(), made.element.end(), variable,
                                       [](int v, const OcpElement& element) { return v < element.first; });
  const OcpElement& element = *(behind - 1);
  const int local = variable - element.first + 1;
  const auto& layout = made.kernel.layout;
  const auto where = [&](const VariableBlock& block) { return local >= block.first && local < block.end(); };
  const auto text = [&](const VariableBlock& block, const std::string& what) {
    const int offset = local - block.first;
    return fmt::format("{} at point {} of element {},{}", what, offset / block.size + 1, element.interval,
                       element.number);
  };
  const auto component = [&](const VariableBlock& block) { return (local - block.first) % block.size; };
  if (where(layout.stage)) return text(layout.stage, implementation_->state_names[at(component(layout.stage))]);
  if (where(layout.selection)) return text(layout.selection, fmt::format("selection {}", component(layout.selection)));
  if (where(layout.lambda)) return text(layout.lambda, fmt::format("lambda {}", component(layout.lambda)));
  if (where(layout.end_state))
    return text(layout.end_state, implementation_->state_names[at(component(layout.end_state))]);
  return fmt::format("variable {} of element {},{}", local, element.interval, element.number);
}

std::string OcpProblem::row_name(int row) const {
  const auto& own = *implementation_;
  const auto& made = *own.structure;
  if (row >= made.n_g) return own.pair_name((row - made.n_g) % made.n_pairs);
  if (row >= made.first_linear_row) return made.linear[at(row - made.first_linear_row)].name;
  for (const auto& placed : made.functions) {
    if (placed.copies.empty() || placed.function->equations() == 0) continue;
    if (row < placed.copies.front().first_row || row >= placed.copies.back().first_row + placed.function->equations()) {
      continue;
    }
    const int copy = (row - placed.copies.front().first_row) / placed.function->equations();
    const int local = row - placed.copies[at(copy)].first_row;
    const auto& one = placed.copies[at(copy)];
    if (placed.bounds != nullptr) {
      const int constraint = (*placed.bounds)[at(local)].constraint;
      const bool terminal = placed.function == &made.kernel.terminal_rows;
      const std::string name = constraint < 0 ? fmt::format("bound of {}", own.state_names[at(-1 - constraint)])
                               : terminal     ? own.terminal_names[at(constraint)]
                                              : own.path_names[at(constraint)];
      return terminal ? fmt::format("terminal constraint '{}'", name)
                      : fmt::format("path constraint '{}' in interval {}", name, one.interval);
    }
    const int collocation = made.kernel.states * made.kernel.tableau.stages();
    if (placed.function == &made.kernel.element && local < collocation) {
      return fmt::format("dynamics of {} in interval {}, element {}, stage {}",
                         own.state_names[at(local % made.kernel.states)], one.interval,
                         made.element[at(one.element)].number, local / made.kernel.states + 1);
    }
    return fmt::format("{} equation {} in interval {}", placed.what, local, one.interval);
  }
  return mpcc::Problem::row_name(row);
}

}  // namespace saltus::discretization
