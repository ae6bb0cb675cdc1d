#include "saltus/fesd_integrator/element.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Core>

#include "saltus/base/contracts.hpp"
#include "saltus/fesd_integrator/dense_system_internal.hpp"
#include "saltus/fesd_integrator/element_polynomial_internal.hpp"
#include "saltus/fesd_integrator/root_unknowns_internal.hpp"

namespace saltus::fesd_integrator {
namespace {

using discretization::TableauFamily;
using Vector = Eigen::Map<Eigen::VectorXd>;
using ConstVector = Eigen::Map<const Eigen::VectorXd>;
using ConstMatrix = Eigen::Map<const Eigen::MatrixXd>;
using Eigen::Index;

constexpr int most_iterations = 40;

}  // namespace

struct ElementSolver::Implementation {
  const discretization::StageKernel& kernel;
  discretization::ButcherTableau tableau;
  ElementPolynomial polynomial;
  Index n_x, n_s, n_psi;
  bool explicit_method, left_limit, ends_at_last_stage;

  DenseSystem system, projection;
  std::vector<discretization::StageValues> values;  // of the stages; one more for the end
  Eigen::MatrixXd directions;                       // n_x by n_psi per stage: f_alpha of what slides
  std::vector<Index> offset;                        // of the unknowns of each stage
  std::vector<const ActiveSet*> sets;
  Eigen::VectorXd end, row, mu;
  RootUnknowns roots;
  Eigen::MatrixXd A;  // of the tableau, with the factors of the element's warp
  Eigen::VectorXd b, c;
  TimeWarp warp;

  Implementation(const discretization::StageKernel& kernel_in, discretization::ButcherTableau tableau_in)
      : kernel(kernel_in),
        tableau(std::move(tableau_in)),
        polynomial(tableau),
        roots(kernel_in, static_cast<std::size_t>(tableau.stages())),
        A(tableau.A),
        b(tableau.b),
        c(tableau.c) {
    n_x = static_cast<Index>(kernel.states());
    n_psi = static_cast<Index>(kernel.selections());
    n_s = tableau.stages();
    explicit_method = tableau.family == TableauFamily::explicit_rk;
    left_limit = tableau.family == TableauFamily::lobatto_iiia;
    ends_at_last_stage = tableau.ends_at_last_stage();
    values.resize(static_cast<std::size_t>(n_s + 1));
    for (auto& stage : values) kernel.size(stage);
    directions.resize(n_x, n_psi * (n_s + 1));
    offset.resize(static_cast<std::size_t>(n_s + 1));
    sets.resize(static_cast<std::size_t>(n_s));
    system.reserve(n_s * (n_x + n_psi));
    projection.reserve(n_psi);
    end.resize(n_x);
    row.resize(n_x);
    mu.resize(n_psi);
  }

  void set_warp(const TimeWarp& wanted) {
    if (warp == wanted) return;
    warp = wanted;
    for (Index m = 0; m < n_s; ++m) {
      const double factor = warp.slope(tableau.c(m));
      c(m) = warp.at(tableau.c(m));
      b(m) = tableau.b(m) * factor;
      A.col(m) = tableau.A.col(m) * factor;
    }
  }
  /// Stages of Euler's method from the left end.
  void guess_by_euler(const Point& left, const double* held, Element& element);
  [[nodiscard]] const ActiveSet& set(Index stage) const { return *sets[static_cast<std::size_t>(stage)]; }
  /// Whether the selections of a stage are known: taken from the left end.
  [[nodiscard]] bool known(Index stage) const { return left_limit && stage == 0; }
  [[nodiscard]] Index unknowns(Index stage) const {
    return known(stage) ? 0 : static_cast<Index>(set(stage).sliding().size());
  }

  void find_directions(Index stage, const discretization::StageValues& at) {
    const ConstMatrix f_selection(at.f_selection.data(), n_x, n_psi);
    Index column = stage * n_psi;
    for (const Sliding& entry : set(std::min(stage, n_s - 1)).sliding()) {
      directions.col(column) = f_selection.col(entry.selection);
      if (entry.reference >= 0) directions.col(column) -= f_selection.col(entry.reference);
      ++column;
    }
  }
  [[nodiscard]] auto directions_of(Index stage) { return directions.middleCols(stage * n_psi, unknowns(stage)); }

  /// Gradient of surface k of `active` into `row`.
  void surface_row(const ActiveSet& active, std::size_t k, const discretization::StageValues& at) {
    const ConstMatrix psi_x(at.indicator_x.data(), n_psi, n_x);
    const Sliding& entry = active.sliding()[k];
    row = psi_x.row(entry.selection).transpose();
    if (entry.reference >= 0) row = psi_x.row(entry.reference).transpose() - row;
  }

  /// What the states are rounded at: the largest one or, near zero, the terms of h f that cancel in sliding.
  [[nodiscard]] double size(const Element& element) const {
    double terms = 0.0;
    for (Index m = 0; m < n_s; ++m) {
      for (Index k = 0; k < unknowns(m); ++k) {
        terms = std::max(terms, directions.col(m * n_psi + k).cwiseAbs().maxCoeff());
      }
    }
    return std::max(element.size, element.h * terms);
  }
  /// Rounding level of the equations: a few roundings of that.
  [[nodiscard]] double negligible(const Element& element) const { return 1e-13 * size(element); }
  /// Equations of one Newton step; the unknowns of the selections are their changes times h, as in the states.
  void assemble_matrix(const Element& element);
  void assemble_right(const Element& element);
  /// Where the equations of the selections of a stage hold: at its own state, or one stage later.
  [[nodiscard]] Index point_of(Index stage) const {
    return explicit_method && sets[0] == sets.back() ? stage + 1 : stage;
  }
  /// f and the indicators at the stages, with derivatives or without.
  enum class Parts { everything, values };
  void evaluate(const Element& element, const double* held, Parts parts);
  /// Adds a step; the largest change of a state, relative to the largest state.
  [[nodiscard]] double update(Element& element);
  [[nodiscard]] bool project(double t, const double* held, Element& element);
};

void ElementSolver::Implementation::evaluate(const Element& element, const double* held, Parts parts) {
  for (Index m = 0; m < n_s; ++m) {
    auto& at = values[static_cast<std::size_t>(m)];
    const double t = element.t + element.h * c(m);
    const double* state = element.stage_states.data() + m * n_x;
    const double* selections = element.stage_selections.data() + m * n_psi;
    if (!roots.empty()) {
      roots.evaluate(static_cast<std::size_t>(m), t, state, selections, held, at);
      find_directions(m, at);
    } else if (parts == Parts::values) {
      kernel.values(t, state, selections, held, at);
    } else {
      kernel.evaluate(t, state, selections, held, at);
      find_directions(m, at);
    }
  }
}

void ElementSolver::Implementation::assemble_right(const Element& element) {
  auto right = system.right();
  for (Index m = 0; m < n_s; ++m) {
    const Index place = offset[static_cast<std::size_t>(m)];
    double* residual = right.data() + place;
    const double* state = element.stage_states.data() + m * n_x;
    for (Index i = 0; i < n_x; ++i) residual[i] = element.x[static_cast<std::size_t>(i)] - state[i];
    for (Index l = 0; l < n_s; ++l) {
      const double weight = element.h * A(m, l);
      if (weight == 0.0) continue;
      const double* f = values[static_cast<std::size_t>(l)].f.data();
      for (Index i = 0; i < n_x; ++i) residual[i] += weight * f[i];
    }
    const auto& at = values[static_cast<std::size_t>(point_of(m))];
    for (Index k = 0; k < unknowns(m); ++k) {
      residual[n_x + k] = -set(m).surface(static_cast<std::size_t>(k), at.indicator.data());
    }
  }
}

void ElementSolver::Implementation::assemble_matrix(const Element& element) {
  system.reset(offset[static_cast<std::size_t>(n_s)]);
  auto matrix = system.matrix();
  const Index rows = matrix.rows();
  const auto place = [&](Index stage) { return offset[static_cast<std::size_t>(stage)]; };
  for (Index m = 0; m < n_s; ++m) {
    for (Index l = 0; l < n_s; ++l) {
      const double weight = element.h * A(m, l);
      if (weight == 0.0) continue;
      const double* f_x = values[static_cast<std::size_t>(l)].f_x.data();
      double* block = matrix.data() + place(l) * rows + place(m);
      for (Index j = 0; j < n_x; ++j, f_x += n_x, block += rows) {
        for (Index i = 0; i < n_x; ++i) block[i] = -weight * f_x[i];
      }
      if (unknowns(l) > 0) {
        matrix.block(place(m), place(l) + n_x, n_x, unknowns(l)) = -A(m, l) * directions_of(l);
      }
    }
    for (Index i = 0; i < n_x; ++i) matrix(place(m) + i, place(m) + i) += 1.0;
  }
  for (Index m = 0; m < n_s; ++m) {
    const Index point = point_of(m);
    const auto& at = values[static_cast<std::size_t>(point)];
    for (Index k = 0; k < unknowns(m); ++k) {
      const Index equation = place(m) + n_x + k;
      surface_row(set(m), static_cast<std::size_t>(k), at);
      if (point < n_s) {
        matrix.block(equation, place(point), 1, n_x) = row.transpose();
        continue;
      }
      for (Index l = 0; l < n_s; ++l) {
        const auto& stage = values[static_cast<std::size_t>(l)];
        matrix.block(equation, place(l), 1, n_x) =
            element.h * b(l) * row.transpose() * ConstMatrix(stage.f_x.data(), n_x, n_x);
        if (unknowns(l) > 0) {
          matrix.block(equation, place(l) + n_x, 1, unknowns(l)) = b(l) * row.transpose() * directions_of(l);
        }
      }
    }
  }
}

double ElementSolver::Implementation::update(Element& element) {
  Eigen::Map<Eigen::MatrixXd> states(element.stage_states.data(), n_x, n_s);
  const auto step = system.right();
  double change = 0.0, root_change = 0.0;
  for (Index m = 0; m < n_s; ++m) {
    const Index begin = offset[static_cast<std::size_t>(m)];
    change = std::max(change, step.segment(begin, n_x).cwiseAbs().maxCoeff());
    states.col(m) += step.segment(begin, n_x);
    if (!roots.empty()) {
      const bool felt = A.col(m).cwiseAbs().maxCoeff() > 0.0;  // behind a warp nothing depends on the last stage
      root_change = std::max(root_change, roots.update(static_cast<std::size_t>(m), step.data() + begin, felt));
    }
    double* all = element.stage_selections.data() + m * n_psi;
    const auto& sliding = set(m).sliding();
    for (Index k = 0; k < unknowns(m); ++k) {
      const Sliding& entry = sliding[static_cast<std::size_t>(k)];
      const double correction = step(begin + n_x + k) / element.h;
      all[entry.selection] += correction;
      if (entry.reference >= 0) all[entry.reference] -= correction;
    }
  }
  const double scale = std::max(size(element), states.cwiseAbs().maxCoeff());
  // Roots by their own size: near the surface they are small, and all that moves the state there.
  return std::max(scale > 0.0 ? change / scale : change, root_change);
}

void ElementSolver::Implementation::guess_by_euler(const Point& left, const double* held, Element& element) {
  kernel.field(left.t, left.x.data(), left.selections.data(), held, end.data());
  Eigen::Map<Eigen::MatrixXd> states(element.stage_states.data(), n_x, n_s);
  for (Index m = 0; m < n_s; ++m) {
    states.col(m) = ConstVector(left.x.data(), n_x) + element.h * c(m) * end;
  }
}

/// NOTE: without this the methods with c_s != 1 lose half their order on curved surfaces.
bool ElementSolver::Implementation::project(double t, const double* held, Element& element) {
  auto& at = values[static_cast<std::size_t>(n_s)];
  const ActiveSet& active = set(n_s - 1);
  const auto count = static_cast<Index>(active.sliding().size());
  const double* selections = element.stage_selections.data() + (n_s - 1) * n_psi;
  Vector x_1(element.end.data(), n_x);
  double before = std::numeric_limits<double>::infinity();
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    kernel.evaluate(t + element.h, element.end.data(), selections, held, at);
    if (iteration == 0) find_directions(n_s, at);
    const auto along = directions.middleCols(n_s * n_psi, count);
    projection.reset(count);
    auto matrix = projection.matrix();
    auto right = projection.right();
    for (Index k = 0; k < count; ++k) {
      surface_row(active, static_cast<std::size_t>(k), at);
      for (Index l = 0; l < count; ++l) matrix(k, l) = row.dot(along.col(l));
      right(k) = -active.surface(static_cast<std::size_t>(k), at.indicator.data());
    }
    if (!projection.solve(negligible(element))) return false;
    for (Index l = 0; l < count; ++l) x_1 += right(l) * along.col(l);
    double change = 0.0;
    for (Index i = 0; i < n_x; ++i) {
      double moved = 0.0;
      for (Index l = 0; l < count; ++l) moved += right(l) * along(i, l);
      change = std::max(change, std::abs(moved));
    }
    const double scale = size(element);
    if (change <= 1e-15 * scale || (change <= 1e-12 * scale && change >= 0.5 * before)) return true;
    if (change <= 1e-9 * scale && before <= 1e-4 * scale) return true;
    before = change;
  }
  return false;
}

ElementSolver::ElementSolver(const discretization::StageKernel& kernel, discretization::ButcherTableau tableau)
    : implementation_(std::make_unique<Implementation>(kernel, std::move(tableau))) {}
ElementSolver::ElementSolver(ElementSolver&&) noexcept = default;
ElementSolver& ElementSolver::operator=(ElementSolver&&) noexcept = default;
ElementSolver::~ElementSolver() = default;

const discretization::ButcherTableau& ElementSolver::tableau() const { return implementation_->tableau; }

ElementSolver::Outcome ElementSolver::solve(const Point& left, double h, std::span<const ActiveSet> sets,
                                            const double* held, Guess guess, Element& element) {
  auto& self = *implementation_;
  const auto n_x = static_cast<std::size_t>(self.n_x), n_s = static_cast<std::size_t>(self.n_s),
             n_psi = static_cast<std::size_t>(self.n_psi);
  SALTUS_ASSERT(sets.size() == 1 || sets.size() == n_s);
  element.t = left.t;
  element.h = h;
  element.x = left.x;
  element.size = std::max(left.size, ConstVector(left.x.data(), self.n_x).cwiseAbs().maxCoeff());
  element.stage_states.resize(n_x * n_s);
  element.stage_slopes.resize(n_x * n_s);
  element.stage_selections.resize(n_psi * n_s);
  element.end.resize(n_x);
  for (std::size_t m = 0; m < n_s; ++m) {
    self.sets[m] = &sets[sets.size() == 1 ? 0 : m];
    self.offset[m + 1] = self.offset[m] + self.n_x + self.unknowns(static_cast<Index>(m));
    double* selections = element.stage_selections.data() + m * n_psi;
    if (self.known(static_cast<Index>(m))) std::copy(left.selections.begin(), left.selections.end(), selections);
    if (guess == Guess::left_end) {
      std::copy(left.x.begin(), left.x.end(), element.stage_states.begin() + static_cast<std::ptrdiff_t>(m * n_x));
      std::copy(left.selections.begin(), left.selections.end(), selections);
    }
    // Not at their bounds: there, derivatives of guarded branches are missing.
    self.mu.head(static_cast<Index>(self.sets[m]->sliding().size())).setZero();
    self.sets[m]->unknowns(selections, self.mu.data());
    if (!self.known(static_cast<Index>(m))) {
      for (std::size_t k = 0; k < self.sets[m]->sliding().size(); ++k) {
        const bool region = self.sets[m]->sliding()[k].reference >= 0;
        double& value = self.mu(static_cast<Index>(k));
        value = region ? value : std::clamp(value, 1e-3, 1.0 - 1e-3);
      }
    }
    self.sets[m]->selections(self.mu.data(), selections);
  }
  self.set_warp(element.warp);
  if (!self.roots.empty()) {
    if (guess == Guess::left_end) self.guess_by_euler(left, held, element);
    for (std::size_t m = 0; m < n_s; ++m) {
      self.roots.start(m, element.t + h * self.c(static_cast<Index>(m)), element.stage_states.data() + m * n_x,
                       element.stage_selections.data() + m * n_psi, held);
    }
  }
  const bool slides = !sets.front().sliding().empty();
  const bool at_end = self.explicit_method && sets.size() == 1 && slides;
  double before = std::numeric_limits<double>::infinity();
  bool factorised = false;  // the matrix of the step before serves once more
  for (int iteration = 0;; ++iteration) {
    if (iteration == most_iterations) return Outcome::not_converged;
    using Parts = Implementation::Parts;
    self.evaluate(element, held, factorised ? Parts::values : Parts::everything);
    if (at_end) {
      self.end = ConstVector(element.x.data(), self.n_x);
      for (std::size_t m = 0; m < n_s; ++m) {
        self.end += h * self.b(static_cast<Index>(m)) * ConstVector(self.values[m].f.data(), self.n_x);
      }
      self.kernel.evaluate(element.t + h, self.end.data(), element.stage_selections.data() + (n_s - 1) * n_psi, held,
                           self.values[n_s]);
    }
    if (!factorised) self.assemble_matrix(element);
    self.assemble_right(element);
    if (!(factorised ? self.system.solve_again() : self.system.solve(self.negligible(element)))) {
      return Outcome::not_finite;
    }
    const double change = self.update(element);
    if (!std::isfinite(change)) return Outcome::not_finite;
    // Quadratic convergence: a step of 1e-9 leaves 1e-18 times the curvature; and steps that no longer shrink are
    // roundings. With the matrix of the step before, a step leaves 2 change / before of itself.
    const bool quadratic = factorised ? change * change <= 1e-17 * before : change <= 1e-9 && before <= 1e-3;
    const double rounding = self.roots.empty() ? 1e-12 : 1e-9;
    if (change <= 1e-15 || quadratic || (change <= rounding && change >= 0.25 * before)) break;
    constexpr double near = 1e-4;
    factorised = !factorised && change <= near && !at_end && self.system.is_factorised() && self.roots.empty();
    before = change;
  }
  for (std::size_t m = 0; m < n_s; ++m) {
    const auto stage = static_cast<Index>(m);
    const double t = element.t + h * self.c(stage);
    const double* state = element.stage_states.data() + m * n_x;
    const double* selections = element.stage_selections.data() + m * n_psi;
    double* slope = element.stage_slopes.data() + m * n_x;
    if (self.roots.empty()) {
      self.kernel.field(t, state, selections, held, slope);
      continue;
    }
    self.roots.field(m, t, state, selections, held, slope);
    Vector(slope, self.n_x) *= self.warp.slope(self.tableau.c(stage));
  }
  element.size =
      std::max(self.size(element), ConstMatrix(element.stage_states.data(), self.n_x, self.n_s).cwiseAbs().maxCoeff());
  if (self.ends_at_last_stage && !self.explicit_method) {
    std::copy_n(element.stage_states.end() - static_cast<std::ptrdiff_t>(n_x), n_x, element.end.begin());
  } else {
    Vector end(element.end.data(), self.n_x);
    end = ConstVector(element.x.data(), self.n_x) +
          h * ConstMatrix(element.stage_slopes.data(), self.n_x, self.n_s) * self.tableau.b;
    if (sets.size() == 1 && slides && !self.project(element.t, held, element)) return Outcome::not_converged;
  }
  const ConstVector end(element.end.data(), self.n_x);
  return end.allFinite() ? Outcome::solved : Outcome::not_finite;
}

bool ElementSolver::determined() const {
  const auto& self = *implementation_;
  const Eigen::MatrixXd free = self.system.null_space();
  constexpr double rounding = 1e-6;  // of columns of length 1
  for (Index m = 0; m < self.n_s && free.cols() > 0; ++m) {
    const Index begin = self.offset[static_cast<std::size_t>(m)];
    if (free.middleRows(begin, self.n_x).cwiseAbs().maxCoeff() > rounding) return false;
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
  for (Index m = 0; m < self.n_s; ++m) {
    const double theta = 1.0 + self.tableau.c(m) * h / element.h;
    self.polynomial.evaluate(element, theta, next.stage_states.data() + m * self.n_x);
  }
}

const std::vector<double>& ElementSolver::watch_points() const { return implementation_->polynomial.watch_points(); }

int ElementSolver::watch_stage(std::size_t point) const {
  const auto& self = *implementation_;
  for (Index m = 0; m < self.n_s; ++m) {
    if (self.tableau.c(m) == watch_points()[point] && !self.known(m) && !self.explicit_method)
      return static_cast<int>(m);
  }
  return -1;
}

void ElementSolver::watch_state(const Element& element, std::size_t point, double* x) const {
  implementation_->polynomial.watch_state(element, point, x);
}

}  // namespace saltus::fesd_integrator
