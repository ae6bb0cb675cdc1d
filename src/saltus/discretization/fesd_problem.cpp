#include "saltus/discretization/fesd_problem.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/base/contracts.hpp"
#include "saltus/discretization/fesd_kernel_internal.hpp"
#include "saltus/discretization/placed_function_internal.hpp"

namespace saltus::discretization {

using mpcc::ConstVectorView;
using mpcc::VectorView;

struct FesdProblem::Implementation {
  std::shared_ptr<FesdKernel> owner;
  FesdKernel::Implementation& kernel;
  VariableLayout layout;
  int n_g = 0, n_pairs = 0;
  mpcc::Bounds w_bounds, g_bounds;
  std::vector<mpcc::Sign> signs;
  mpcc::Pattern jacobian_pattern, hessian_pattern;
  PlacedFunction elements, boundaries;
  linalg::Vector parameters;  ///< of the kernel: p, held, T/N
  linalg::Vector constants;   ///< left state, left time, lambda_(0,0)
  StepData step;

  Implementation(std::shared_ptr<FesdKernel> kernel_owner, int n)
      : owner(std::move(kernel_owner)),
        kernel(*owner->implementation_),
        layout{kernel.layout, n, static_cast<int>(kernel.boundary_bounds.lower.size())},
        elements(kernel.element),
        boundaries(kernel.boundary),
        constants(linalg::Vector::zero(kernel.left_size())) {
    SALTUS_ASSERT(n >= 1);
    place();
    find_patterns();
    find_bounds();
    parameters = linalg::Vector::zero(static_cast<linalg::Index>(kernel.parameters.size()) + kernel.held + 1);
    std::copy(kernel.parameters.begin(), kernel.parameters.end(), parameters.data());
  }

  /// Where lambda at the left end of an element stands: variables of the one before, or constants.
  [[nodiscard]] std::vector<int> left_lambda(int n) const {
    const int n_lambda = static_cast<int>(kernel.pairs.size());
    std::vector<int> places;
    for (int i = 0; i < n_lambda; ++i) {
      places.push_back(n == 0
                           ? constant_place(kernel.left_size() - n_lambda + i)
                           : layout.first_of_element(n - 1) + layout.element.lambda.at(layout.element.points() - 1, i));
    }
    return places;
  }

  /// Left state, left time, left lambda of an element.
  [[nodiscard]] std::vector<int> left_places(int n) const {
    std::vector<int> places;
    for (int i = 0; i < kernel.states; ++i) {
      places.push_back(n == 0 ? constant_place(i) : layout.first_of_element(n - 1) + layout.element.right_state() + i);
    }
    if (kernel.depends_on_time) {
      places.push_back(n == 0 ? constant_place(kernel.states)
                              : layout.first_of_element(n - 1) + layout.element.end_time.first);
    }
    const auto lambda = left_lambda(n);
    places.insert(places.end(), lambda.begin(), lambda.end());
    return places;
  }

  static void append(std::vector<int>& places, int first, int count) {
    for (int i = 0; i < count; ++i) places.push_back(first + i);
  }

  void place() {
    const int n = layout.elements;
    const int size = layout.element.size;
    n_g = n * kernel.element.equations() + (n - 1) * kernel.boundary.equations() + 1;
    n_pairs = n * kernel.element.pairs() + (n - 1) * kernel.boundary.pairs();
    int next_g = 0;
    int next_pair = 0;
    for (int i = 0; i < n; ++i) {
      auto places = left_places(i);
      append(places, layout.first_of_element(i), size);
      elements.add(places, {next_g, next_pair, n_g, n_pairs});
      next_g += kernel.element.equations();
      next_pair += kernel.element.pairs();
    }
    for (int i = 1; i < n; ++i) {
      auto places = left_lambda(i - 1);
      append(places, layout.first_of_element(i - 1), size);
      append(places, layout.first_of_element(i), size);
      append(places, layout.first_of_boundary(i), layout.boundary_size);
      boundaries.add(places, {next_g, next_pair, n_g, n_pairs});
      next_g += kernel.boundary.equations();
      next_pair += kernel.boundary.pairs();
    }
    signs.assign(static_cast<std::size_t>(2 * n_pairs), mpcc::Sign::implied);
    elements.write_signs(signs, n_g);
    boundaries.write_signs(signs, n_g);
  }

  void find_patterns() {
    elements.add_patterns(jacobian_pattern, hessian_pattern);
    boundaries.add_patterns(jacobian_pattern, hessian_pattern);
    for (int n = 0; n < layout.elements; ++n)
      jacobian_pattern.add(n_g - 1, layout.first_of_element(n) + layout.element.h);
  }

  void find_bounds() {
    const double infinity = std::numeric_limits<double>::infinity();
    w_bounds = {linalg::Vector::constant(layout.size(), -infinity), linalg::Vector::constant(layout.size(), infinity)};
    g_bounds = {linalg::Vector::zero(n_g), linalg::Vector::zero(n_g)};
    const auto& element = layout.element;
    for (int n = 0; n < layout.elements; ++n) {
      const int first = layout.first_of_element(n);
      const auto segment = [first](linalg::Vector& bound, const VariableBlock& block) {
        return bound.segment(first + block.first, block.end() - block.first);
      };
      segment(w_bounds.lower, element.selection).set_zero();
      segment(w_bounds.upper, element.selection).set_constant(1.0);
      segment(w_bounds.lower, element.lambda).set_zero();
      segment(w_bounds.lower, element.correction).set_zero();
    }
    for (int n = 1; n < layout.elements; ++n) {
      w_bounds.lower.segment(layout.first_of_boundary(n), layout.boundary_size) = kernel.boundary_bounds.lower;
      w_bounds.upper.segment(layout.first_of_boundary(n), layout.boundary_size) = kernel.boundary_bounds.upper;
    }
  }

  /// eq. (17): lambda_p = max(psi, 0), lambda_n = -min(psi, 0); lambda_i = g_i - min g.
  void set_left_lambda() {
    const int n_selections = layout.element.selection.size;
    linalg::Vector indicator(n_selections);
    kernel.native.call(kernel.indicators, std::array<const double*, 3>{&step.t, step.x.data(), parameters.data()},
                       std::array<double*, 1>{indicator.data()});
    for (const auto& [first, count] : kernel.simplices) {
      indicator.segment(first, count).add_to_all(-indicator.segment(first, count).min());
    }
    const int n_lambda = static_cast<int>(kernel.pairs.size());
    for (int k = 0; k < n_lambda; ++k) {
      const auto& pair = kernel.pairs[at(k)];
      const double value = indicator[pair.selection];
      const bool is_lambda_n = !pair.is_region && !pair.complement;
      constants[kernel.left_size() - n_lambda + k] = std::max(is_lambda_n ? -value : value, 0.0);
    }
  }

  /// lambda at the left end, then at the points of element n.
  [[nodiscard]] linalg::Matrix lambda_of(int n, ConstVectorView w) const {
    const auto& block = layout.element.lambda;
    linalg::Matrix lambda(block.size, block.count + 1);
    const auto left = left_lambda(n);
    for (int i = 0; i < block.size; ++i) lambda(i, 0) = value_at(left[at(i)], w, constants);
    lambda.right_cols(block.count) = matrix(n, block, w);
    return lambda;
  }

  [[nodiscard]] linalg::Matrix matrix(int n, const VariableBlock& block, ConstVectorView w) const {
    return linalg::ConstView(w.data() + layout.first_of_element(n) + block.first, block.size, block.count);
  }
};

FesdProblem::FesdProblem(std::shared_ptr<FesdKernel> kernel, int elements)
    : implementation_(std::make_unique<Implementation>(std::move(kernel), elements)) {}
FesdProblem::~FesdProblem() = default;

void FesdProblem::set_step(const StepData& step) {
  auto& own = *implementation_;
  SALTUS_ASSERT(step.length > 0.0 && static_cast<int>(step.x.size()) == own.kernel.states &&
                static_cast<int>(step.held.size()) == own.kernel.held);
  own.step = step;
  const double mean = step.length / own.layout.elements;
  std::copy(step.held.begin(), step.held.end(), own.parameters.data() + own.kernel.parameters.size());
  own.parameters[own.parameters.size() - 1] = mean;
  std::copy(step.x.begin(), step.x.end(), own.constants.data());
  if (own.kernel.depends_on_time) own.constants[own.kernel.states] = step.t;
  own.set_left_lambda();
  const bool moves = own.kernel.options.cross_complementarity != CrossComplementarity::same_stage;
  const double gamma = moves ? own.kernel.options.gamma_h : 0.0;
  for (int n = 0; n < own.layout.elements; ++n) {
    const int h = own.layout.first_of_element(n) + own.layout.element.h;
    own.w_bounds.lower[h] = (1.0 - gamma) * mean;
    own.w_bounds.upper[h] = (1.0 + gamma) * mean;
  }
  own.g_bounds.lower[own.n_g - 1] = own.g_bounds.upper[own.n_g - 1] = step.length;
}

linalg::Vector FesdProblem::first_guess() const {
  const auto& own = *implementation_;
  const auto& element = own.layout.element;
  const bool is_integral = own.kernel.options.representation == Representation::integral;
  const double mean = own.step.length / own.layout.elements;
  const linalg::ConstView x(own.step.x.data(), own.kernel.states);
  linalg::Vector w = linalg::Vector::zero(own.layout.size());
  for (int n = 0; n < own.layout.elements; ++n) {
    const int first = own.layout.first_of_element(n);
    w[first + element.h] = mean;
    for (int m = 0; m < element.stages && is_integral; ++m) w.segment(first + element.stage.at(m), x.size()) = x;
    if (element.end_state.count > 0) w.segment(first + element.end_state.first, x.size()) = x;
    if (element.end_time.count > 0) w[first + element.end_time.first] = own.step.t + (n + 1) * mean;
    // Away from the corner a = lambda = 0 of every pair, on no side of any surface.
    w.segment(first + element.selection.first, element.selection.end() - element.selection.first).set_constant(0.5);
    w.segment(first + element.lambda.first, element.lambda.end() - element.lambda.first).set_constant(0.5);
    for (const auto& [simplex, count] : own.kernel.simplices) {
      for (int m = 0; m < element.stages; ++m) {
        w.segment(first + element.selection.at(m, simplex), count).set_constant(1.0 / count);
      }
    }
  }
  for (int n = 1; n < own.layout.elements; ++n) {
    w.segment(own.layout.first_of_boundary(n), own.layout.boundary_size).set_constant(0.5);
  }
  return w;
}

std::vector<SolvedElement> FesdProblem::read(ConstVectorView w) const {
  const auto& own = *implementation_;
  const auto& element = own.layout.element;
  const auto& tableau = own.kernel.tableau;
  const bool is_integral = own.kernel.options.representation == Representation::integral;
  std::vector<SolvedElement> solved;
  double t = own.step.t;
  linalg::Vector left = linalg::ConstView(own.step.x.data(), own.kernel.states);
  for (int n = 0; n < own.layout.elements; ++n) {
    SolvedElement one;
    one.t = t;
    one.h = w[own.layout.first_of_element(n) + element.h];
    one.states = own.matrix(n, element.stage, w);
    if (!is_integral) {
      const linalg::Matrix increments = one.h * one.states * tableau.A.transpose();
      one.states = linalg::plus_column(increments, left);
    }
    one.selections = own.matrix(n, element.selection, w);
    one.lambda = own.lambda_of(n, w);
    one.end = w.segment(own.layout.first_of_element(n) + element.right_state(), own.kernel.states);
    t += one.h;
    left = one.end;
    solved.push_back(std::move(one));
  }
  return solved;
}

const VariableLayout& FesdProblem::layout() const { return implementation_->layout; }
int FesdProblem::variables() const { return implementation_->layout.size(); }
int FesdProblem::constraints() const { return implementation_->n_g; }
int FesdProblem::pairs() const { return implementation_->n_pairs; }
const mpcc::Bounds& FesdProblem::variable_bounds() const { return implementation_->w_bounds; }
const mpcc::Bounds& FesdProblem::constraint_bounds() const { return implementation_->g_bounds; }
const std::vector<mpcc::Sign>& FesdProblem::signs() const { return implementation_->signs; }
const mpcc::Pattern& FesdProblem::jacobian_pattern() const { return implementation_->jacobian_pattern; }
const mpcc::Pattern& FesdProblem::hessian_pattern() const { return implementation_->hessian_pattern; }

double FesdProblem::objective(ConstVectorView w) {
  auto& own = *implementation_;
  return own.elements.objective(w, own.constants, own.parameters) +
         own.boundaries.objective(w, own.constants, own.parameters);
}

void FesdProblem::objective_gradient(ConstVectorView w, VectorView gradient) {
  auto& own = *implementation_;
  gradient.set_zero();
  own.elements.add_gradient(w, own.constants, own.parameters, gradient);
  own.boundaries.add_gradient(w, own.constants, own.parameters, gradient);
}

void FesdProblem::functions(ConstVectorView w, VectorView c) {
  auto& own = *implementation_;
  own.elements.rows(w, own.constants, own.parameters, c);
  own.boundaries.rows(w, own.constants, own.parameters, c);
  double sum = 0.0;
  for (int n = 0; n < own.layout.elements; ++n) sum += w[own.layout.first_of_element(n) + own.layout.element.h];
  c[own.n_g - 1] = sum;
}

void FesdProblem::jacobian(ConstVectorView w, VectorView values) {
  auto& own = *implementation_;
  double* next = own.elements.jacobian(w, own.constants, own.parameters, values.data());
  next = own.boundaries.jacobian(w, own.constants, own.parameters, next);
  std::fill_n(next, own.layout.elements, 1.0);
}

void FesdProblem::hessian(ConstVectorView w, double objective_factor, ConstVectorView y, VectorView values) {
  auto& own = *implementation_;
  double* next = own.elements.hessian(w, own.constants, own.parameters, objective_factor, y, values.data());
  own.boundaries.hessian(w, own.constants, own.parameters, objective_factor, y, next);
}

}  // namespace saltus::discretization
