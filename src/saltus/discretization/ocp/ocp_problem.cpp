#include "saltus/discretization/ocp/ocp_problem.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/discretization/ocp/ocp_problem_internal.hpp"
#include "saltus/model/time_freezing/time_freezing.hpp"
#include "saltus/mpcc/elimination.hpp"

namespace saltus::discretization {

using mpcc::ConstVectorView;
using mpcc::VectorView;

OcpProblem::Implementation::Implementation(std::unique_ptr<OcpStructure> made, const model::Ocp& ocp,
                                           const reformulation::Dcs& dcs)
    : structure(std::move(made)),
      time_weight(ocp.horizon.time_weight),
      state_names(ocp.system.state_names),
      selection_names(names_of_selections(ocp.system, dcs)) {
  for (const auto& constraint : ocp.path) path_names.push_back(constraint.name);
  if (ocp.system.freezing) {
    for (const auto& contact : ocp.system.freezing->contacts)
      path_names.push_back(fmt::format("gap({})", contact.name));
  }
  for (const auto& constraint : ocp.terminal) terminal_names.push_back(constraint.name);
  const auto& options = structure->kernel.options;
  if (options.step_equilibration == StepEquilibration::heuristic_mean) {
    for (const auto& interval : structure->interval) {
      for (const int h : interval.lengths) {
        mean_lengths.push_back(h);
        mean_values.push_back(1.0 / interval.elements);
      }
    }
  }
  if (ocp.system.freezing && ocp.system.freezing->stabilisation >= 0) {
    const int parameter = ocp.system.freezing->stabilisation;
    const auto& free = structure->kernel.free_parameters;
    const auto before = std::lower_bound(free.begin(), free.end(), parameter) - free.begin();
    stabilisation = {parameter - before, ocp.system.freezing->stabilisation_initial,
                     ocp.system.parameter_values[at(parameter)]};
  }
  find_patterns();
  start = linalg::Vector::zero(structure->n_w).at_least(structure->w_bounds.lower).at_most(structure->w_bounds.upper);
}

void OcpProblem::Implementation::find_patterns() {
  for (const auto& placed : structure->functions) placed.placed->add_patterns(jacobian_pattern, hessian_pattern);
  for (std::size_t i = 0; i < structure->linear.size(); ++i) {
    for (const auto& [variable, coefficient] : structure->linear[i].entries) {
      jacobian_pattern.add(structure->first_linear_row + static_cast<int>(i), variable);
    }
  }
  for (const auto& penalty : structure->penalties) {
    if (penalty.squared) hessian_pattern.add(penalty.variable, penalty.variable);
  }
  for (const int h : mean_lengths) hessian_pattern.add(h, h);
}

double OcpProblem::Implementation::term(Term wanted, ConstVectorView w) {
  find_measurements(*structure, w);
  double sum = 0.0;
  for (const auto& placed : structure->functions) {
    if (placed.term == wanted) sum += placed.placed->objective(w, structure->constants, structure->local_parameters);
  }
  return sum;
}

double OcpProblem::Implementation::mean_term(ConstVectorView w) const {
  double sum = 0.0;
  for (std::size_t i = 0; i < mean_lengths.size(); ++i) {
    const double difference = w[mean_lengths[i]] - mean_values[i];
    sum += difference * difference;
  }
  return structure->kernel.options.rho_h * sum;
}

double OcpProblem::Implementation::penalties(ConstVectorView w) const {
  double sum = 0.0;
  for (const auto& penalty : structure->penalties) {
    const double v = w[penalty.variable];
    sum += penalty.factor * (penalty.squared ? v * v : v);
  }
  return sum;
}

OcpProblem::OcpProblem(std::unique_ptr<Implementation> implementation) : implementation_(std::move(implementation)) {}
OcpProblem::~OcpProblem() = default;

Expected<std::unique_ptr<OcpProblem>> OcpProblem::make(std::shared_ptr<OcpKernel> kernel, const model::Ocp& ocp,
                                                       const reformulation::Dcs& dcs,
                                                       const std::vector<int>& elements) {
  auto structure = ocp_structure(std::move(kernel), ocp, dcs, elements);
  if (!structure) return tl::unexpected(structure.error());
  return std::unique_ptr<OcpProblem>(new OcpProblem(std::make_unique<Implementation>(std::move(*structure), ocp, dcs)));
}

int OcpProblem::variables() const { return implementation_->structure->n_w; }
int OcpProblem::constraints() const { return implementation_->structure->n_g; }
int OcpProblem::pairs() const { return implementation_->structure->n_pairs; }
const mpcc::Bounds& OcpProblem::variable_bounds() const { return implementation_->structure->w_bounds; }
const mpcc::Bounds& OcpProblem::constraint_bounds() const { return implementation_->structure->g_bounds; }
const std::vector<mpcc::Sign>& OcpProblem::signs() const { return implementation_->structure->signs; }
const mpcc::Pattern& OcpProblem::jacobian_pattern() const { return implementation_->jacobian_pattern; }
const mpcc::Pattern& OcpProblem::hessian_pattern() const { return implementation_->hessian_pattern; }
const mpcc::Chain* OcpProblem::chain() const { return &implementation_->structure->chain; }

std::vector<int> OcpProblem::elimination_blocks() const {
  auto blocks = mpcc::elimination_blocks(*chain(), variables());
  mpcc::place_with_rows(blocks, jacobian_pattern(), rows());
  return blocks;
}

int OcpProblem::pair_group(int pair) const { return implementation_->structure->pair_group[at(pair)]; }

double OcpProblem::objective(ConstVectorView w) {
  auto& own = *implementation_;
  auto& made = *own.structure;
  find_measurements(made, w);
  double sum = own.penalties(w);
  if (own.time_weight != 0.0) sum += own.time_weight * own.value(made.horizon, w);
  for (const auto& placed : made.functions) {
    const double factor = own.factor(placed);
    if (factor != 0.0) sum += factor * placed.placed->objective(w, made.constants, made.local_parameters);
  }
  if (own.method_scale != 0.0) sum += own.method_scale * own.mean_term(w);
  return sum;
}

void OcpProblem::objective_gradient(ConstVectorView w, VectorView gradient) {
  auto& own = *implementation_;
  auto& made = *own.structure;
  find_measurements(made, w);
  gradient.set_zero();
  for (const auto& penalty : made.penalties) {
    gradient[penalty.variable] += penalty.factor * (penalty.squared ? 2.0 * w[penalty.variable] : 1.0);
  }
  if (made.horizon >= 0) gradient[made.horizon] += own.time_weight;
  for (const auto& placed : made.functions) {
    const double factor = own.factor(placed);
    if (factor != 0.0) placed.placed->add_gradient(w, made.constants, made.local_parameters, gradient, factor);
  }
  const double mean = 2.0 * own.method_scale * made.kernel.options.rho_h;
  for (std::size_t i = 0; i < own.mean_lengths.size() && mean != 0.0; ++i) {
    gradient[own.mean_lengths[i]] += mean * (w[own.mean_lengths[i]] - own.mean_values[i]);
  }
}

void OcpProblem::functions(ConstVectorView w, VectorView c) { implementation_->functions(w, c); }

void OcpProblem::Implementation::functions(ConstVectorView w, VectorView c) const {
  const auto& made = *structure;
  for (const auto& placed : made.functions) {
    if (placed.function->equations() + placed.function->pairs() == 0) continue;
    placed.placed->rows(w, made.constants, made.local_parameters, c);
  }
  for (std::size_t i = 0; i < made.linear.size(); ++i) {
    double sum = 0.0;
    for (const auto& [variable, coefficient] : made.linear[i].entries) sum += coefficient * w[variable];
    c[made.first_linear_row + static_cast<linalg::Index>(i)] = sum;
  }
}

void OcpProblem::jacobian(ConstVectorView w, VectorView values) {
  auto& made = *implementation_->structure;
  double* next = values.data();
  for (const auto& placed : made.functions) {
    if (placed.function->jacobian_pattern().entries() == 0) continue;
    next = placed.placed->jacobian(w, made.constants, made.local_parameters, next);
  }
  for (const auto& row : made.linear) {
    for (const auto& [variable, coefficient] : row.entries) *next++ = coefficient;
  }
}

void OcpProblem::hessian(ConstVectorView w, double objective_factor, ConstVectorView y, VectorView values) {
  auto& own = *implementation_;
  auto& made = *own.structure;
  find_measurements(made, w);
  double* next = values.data();
  for (const auto& placed : made.functions) {
    if (placed.function->hessian_pattern().entries() == 0) continue;
    next = placed.placed->hessian(w, made.constants, made.local_parameters, objective_factor * own.factor(placed), y,
                                  next);
  }
  for (const auto& penalty : made.penalties) {
    if (penalty.squared) *next++ = 2.0 * objective_factor * penalty.factor;
  }
  const double mean = 2.0 * objective_factor * own.method_scale * made.kernel.options.rho_h;
  std::fill_n(next, own.mean_lengths.size(), mean);
}

void OcpProblem::with_method_terms(ConstVectorView w) {
  auto& own = *implementation_;
  own.method_scale = 0.0;
  const double f = objective(w);
  const double n = own.structure->intervals;
  // rho max(1, |f|) / T^2 times squares of lengths hhat T/N.
  own.method_scale = (std::isfinite(f) ? std::max(1.0, std::abs(f)) : 1.0) / (n * n);
}
void OcpProblem::without_method_terms() { implementation_->method_scale = 0.0; }

void OcpProblem::relaxed_by(double part) {
  const auto& followed = implementation_->stabilisation;
  if (!followed) return;
  implementation_->structure->local_parameters[followed->place] =
      followed->last + part * (followed->initial - followed->last);
}

}  // namespace saltus::discretization
