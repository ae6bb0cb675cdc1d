#include "saltus/fesd_integrator/element/element.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/base/contracts.hpp"
#include "saltus/base/stop.hpp"
#include "saltus/fesd_integrator/element/element_equations_internal.hpp"
#include "saltus/fesd_integrator/element/element_polynomial_internal.hpp"
#include "saltus/fesd_integrator/element/rest_projection.hpp"
#include "saltus/linalg/matrix.hpp"

namespace saltus::fesd_integrator {
namespace {

using ConstVector = linalg::ConstView;
using linalg::Index;

constexpr int most_newton_steps = 40;
constexpr double negligible_defect = 1e-13;  // a few roundings of the largest terms of a stage

constexpr double stalls = 0.25;  // of the step before: roundings do not shrink

/// Quadratic convergence: a step of 1e-9 leaves 1e-18 times the curvature; and steps that no longer shrink are
/// roundings. With the matrix of the step before, a step leaves 2 change / before of itself.
bool is_converged(double change, double before, bool again, double rounding) {
  const bool quadratic =
      again ? change * change <= 1e-17 * before && std::isfinite(before) : change <= 1e-9 && before <= 1e-3;
  return change <= 1e-15 || quadratic || (change <= rounding && change >= stalls * before);
}

/// How far the stages are from x_0 + h sum_l a_ml f_l, in sizes of the states. Newton steps measure states: where what
/// slides holds them, selections may still be far from theirs.
double defect_of(const Element& element, const discretization::ButcherTableau& tableau) {
  const Index n_x = index(element.x.size()), n_s = tableau.stages();
  double defect = 0.0;
  for (Index m = 0; m < n_s; ++m) {
    for (Index i = 0; i < n_x; ++i) {
      double sum = element.x[at(i)] - element.stage_states[at(m * n_x + i)];
      for (Index l = 0; l < n_s; ++l) {
        sum += element.h * tableau.A(m, l) * element.stage_slopes[at(l * n_x + i)];
      }
      defect = std::max(defect, std::abs(sum));
    }
  }
  return element.size > 0.0 ? defect / element.size : defect;
}

}  // namespace

struct ElementSolver::Implementation {
  Implementation(const discretization::StageKernel& kernel, discretization::ButcherTableau tableau_in)
      : tableau(std::move(tableau_in)),
        n_x(static_cast<Index>(kernel.states())),
        polynomial(tableau),
        equations(kernel, tableau),
        rest(kernel) {}

  /// The method holds the rate of what rests: its value drifts by the error of the method, which is taken back here.
  void put_to_rest(std::span<const ActiveSet> sets, const double* held, Element& element) {
    const ActiveSet& set = sets.front();
    if (sets.size() > 1 || set.resting().empty()) return;
    const double* const last = element.stage_selections.data() + element.stage_selections.size() - set.modes().size();
    const RestProjection::Place place{element.t + element.h, held, element.size, {last, last + set.modes().size()}};
    auto end = element.end;
    if (rest.onto_surfaces(set, place, end)) element.end = std::move(end);
  }

  discretization::ButcherTableau tableau;
  Index n_x;
  ElementPolynomial polynomial;
  ElementEquations equations;
  RestProjection rest;
};

ElementSolver::ElementSolver(const discretization::StageKernel& kernel, discretization::ButcherTableau tableau)
    : implementation_(std::make_unique<Implementation>(kernel, std::move(tableau))) {}
ElementSolver::ElementSolver(ElementSolver&&) noexcept = default;
ElementSolver& ElementSolver::operator=(ElementSolver&&) noexcept = default;
ElementSolver::~ElementSolver() = default;

const discretization::ButcherTableau& ElementSolver::tableau() const { return implementation_->tableau; }

ElementSolver::Outcome ElementSolver::solve(const Point& left, double h, std::span<const ActiveSet> sets,
                                            const double* held, Guess guess, Element& element) {
  heed_stop();
  using Matrix = ElementEquations::Matrix;
  auto& equations = implementation_->equations;
  SALTUS_ASSERT(sets.size() == 1 || sets.size() == static_cast<std::size_t>(tableau().stages()));
  equations.begin(left, h, sets, held, guess, element);
  const auto failed = [&](Outcome outcome) {
    equations.forget_matrix();
    return outcome;
  };
  double before = std::numeric_limits<double>::infinity(), defect_before = before;
  Matrix matrix = equations.first_matrix(h);
  for (int iteration = 0;; ++iteration) {
    if (iteration == most_newton_steps) return failed(Outcome::not_converged);
    const auto change = equations.step(held, matrix, element);
    if (!change) return failed(Outcome::not_finite);
    const bool again = matrix == Matrix::of_the_step_before;
    if (is_converged(*change, before, again, equations.rounding())) {
      if (!equations.finish(held, element)) return failed(Outcome::not_converged);
      const double defect = defect_of(element, tableau());
      if (defect <= negligible_defect || defect >= stalls * defect_before) break;
      defect_before = defect;
    }
    constexpr double near = 1e-4, shrinks = 0.1;
    const bool once_more =
        equations.saves_factors() ? !again || *change <= shrinks * before : !again && *change <= near;
    const bool keep = once_more && equations.keeps_matrix();
    matrix = keep ? Matrix::of_the_step_before : Matrix::its_own;
    before = *change;
  }
  implementation_->put_to_rest(sets, held, element);
  return ConstVector(element.end.data(), static_cast<Index>(element.end.size())).all_finite() ? Outcome::solved
                                                                                              : Outcome::not_finite;
}

bool ElementSolver::determined() const {
  const auto& equations = implementation_->equations;
  const linalg::Matrix free = equations.free_directions();
  constexpr double rounding = 1e-6;  // of columns of length 1
  for (Index m = 0; m < tableau().stages() && free.cols() > 0; ++m) {
    if (free.middle_rows(equations.place(m), implementation_->n_x).max_abs() > rounding) return false;
  }
  return true;
}

void ElementSolver::interpolate(const Element& element, double theta, double* x) const {
  implementation_->polynomial.evaluate(element, element.warp.inverse(theta), x);
}

void ElementSolver::slope(const Element& element, double tau, double* slope) const {
  implementation_->polynomial.slope(element, tau, slope);
}

void ElementSolver::extrapolate(const Element& element, double h, Element& next) const {
  const auto& self = *implementation_;
  next.stage_states.resize(element.stage_states.size());
  next.stage_selections = element.stage_selections;
  for (Index m = 0; m < self.tableau.stages(); ++m) {
    const double theta = 1.0 + self.tableau.c(m) * h / element.h;
    self.polynomial.evaluate(element, theta, next.stage_states.data() + m * self.n_x);
  }
}

const std::vector<double>& ElementSolver::watch_points() const { return implementation_->polynomial.watch_points(); }

int ElementSolver::watch_stage(std::size_t point) const {
  const auto& equations = implementation_->equations;
  if (equations.explicit_method()) return -1;
  for (Index m = 0; m < tableau().stages(); ++m) {
    if (tableau().c(m) == watch_points()[point] && !equations.known(m)) return static_cast<int>(m);
  }
  return -1;
}

void ElementSolver::watch_state(const Element& element, std::size_t point, double* x) const {
  implementation_->polynomial.watch_state(element, point, x);
}

}  // namespace saltus::fesd_integrator
