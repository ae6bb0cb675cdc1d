#include <algorithm>
#include <cmath>
#include <limits>

#include "saltus/base/at.hpp"
#include "saltus/fesd_integrator/element/element_equations_internal.hpp"

namespace saltus::fesd_integrator {
namespace {

using ConstVector = linalg::ConstView;
using ConstMatrix = linalg::ConstView;
using linalg::Index;
using linalg::View;

/// Of Newton's method that puts an end onto the surfaces.
constexpr int most_steps_onto_surfaces = 40;

NewtonSystem::Storage storage_of(const discretization::StageKernel& kernel) {
  return kernel.pattern().is_sparse ? NewtonSystem::Storage::sparse : NewtonSystem::Storage::dense;
}

}  // namespace

ElementEquations::ElementEquations(const discretization::StageKernel& kernel,
                                   const discretization::ButcherTableau& tableau)
    : kernel_(kernel),
      tableau_(tableau),
      n_x_(static_cast<Index>(kernel.states())),
      n_s_(tableau.stages()),
      n_psi_(static_cast<Index>(kernel.selections())),
      explicit_method_(tableau.family == discretization::TableauFamily::explicit_rk),
      left_limit_(tableau.family == discretization::TableauFamily::lobatto_iiia),
      system_(storage_of(kernel), n_s_ * (n_x_ + n_psi_)),
      projection_(storage_of(kernel), n_psi_),
      values_(static_cast<std::size_t>(n_s_ + 1)),
      directions_(n_x_, system_.is_sparse() ? 0 : n_psi_ * (n_s_ + 1)),
      sparse_{std::vector<SparseColumns>(system_.is_sparse() ? at(n_s_ + 1) : 0), {}, 0.0},
      offset_(static_cast<std::size_t>(n_s_ + 1)),
      sets_(static_cast<std::size_t>(n_s_)),
      end_(n_x_),
      row_(n_x_),
      mu_(n_psi_),
      roots_(kernel, static_cast<std::size_t>(n_s_)),
      A_(tableau.A),
      b_(tableau.b),
      c_(tableau.c) {
  for (auto& stage : values_) kernel.size(stage);
}

void ElementEquations::set_warp(const TimeWarp& wanted) {
  if (warp_ == wanted) return;
  warp_ = wanted;
  for (Index m = 0; m < n_s_; ++m) {
    const double factor = warp_.slope(tableau_.c(m));
    c_(m) = warp_.at(tableau_.c(m));
    b_(m) = tableau_.b(m) * factor;
    A_.col(m) = tableau_.A.col(m) * factor;
  }
}

void ElementEquations::find_directions(Index stage, const discretization::StageValues& at) {
  if (system_.is_sparse()) {
    sparse_.directions[static_cast<std::size_t>(stage)] = sliding_directions(set(std::min(stage, n_s_ - 1)), at);
    return;
  }
  const ConstMatrix f_selection(at.f_selection.data(), n_x_, n_psi_);
  Index column = stage * n_psi_;
  for (const Sliding& entry : set(std::min(stage, n_s_ - 1)).sliding()) {
    directions_.col(column) = f_selection.col(entry.selection);
    if (entry.reference >= 0) directions_.col(column) -= f_selection.col(entry.reference);
    ++column;
  }
}

/// Gradient of surface k of `active`.
void ElementEquations::surface_row(const ActiveSet& active, std::size_t k, const discretization::StageValues& at) {
  const ConstMatrix psi_x(at.indicator_x.data(), n_psi_, n_x_);
  const Surface& surface = active.sliding()[k].surface;
  row_ = psi_x.row(surface.reference >= 0 ? surface.reference : surface.indicator);
  if (surface.reference >= 0) row_ -= psi_x.row(surface.indicator);
}

/// What the states are rounded at: the largest one or, near zero, the terms of h f that cancel in sliding. The rounding
/// level of the equations is a few roundings of that.
double ElementEquations::size(const Element& element) const {
  double terms = 0.0;
  for (Index m = 0; m < n_s_; ++m) {
    if (system_.is_sparse()) {
      const SparseColumns& entries = sparse_.directions[at(m)];
      if (unknowns(m) > 0) terms = std::max(terms, ConstVector(entries.values()).max_abs());
      continue;
    }
    for (Index k = 0; k < unknowns(m); ++k) {
      terms = std::max(terms, directions_.col(m * n_psi_ + k).max_abs());
    }
  }
  return std::max(element.size, element.h * terms);
}

/// Where the equations of the selections of a stage hold: at its own state, or one stage later.
Index ElementEquations::point_of(Index stage) const {
  return explicit_method_ && sets_.front() == sets_.back() ? stage + 1 : stage;
}

/// f and the indicators at the stages, with derivatives or without.
void ElementEquations::evaluate(const Element& element, const double* held, Parts parts) {
  for (Index m = 0; m < n_s_; ++m) {
    auto& here = values_[at(m)];
    const double t = element.t + element.h * c_(m);
    const double* state = element.stage_states.data() + m * n_x_;
    const double* selections = element.stage_selections.data() + m * n_psi_;
    if (!roots_.empty()) {
      roots_.evaluate(static_cast<std::size_t>(m), t, state, selections, held, here);
      find_directions(m, here);
    } else if (parts == Parts::values) {
      kernel_.values(t, state, selections, held, here);
    } else {
      kernel_.evaluate(t, state, selections, held, here);
      find_directions(m, here);
    }
  }
}

void ElementEquations::assemble_right(const Element& element) {
  auto right = system_.right();
  for (Index m = 0; m < n_s_; ++m) {
    const Index place = offset_[at(m)];
    double* residual = right.data() + place;
    const double* state = element.stage_states.data() + m * n_x_;
    for (Index i = 0; i < n_x_; ++i) residual[i] = element.x[at(i)] - state[i];
    for (Index l = 0; l < n_s_; ++l) {
      const double weight = element.h * A_(m, l);
      if (weight == 0.0) continue;
      const double* f = values_[at(l)].f.data();
      for (Index i = 0; i < n_x_; ++i) residual[i] += weight * f[i];
    }
    const auto& here = values_[at(point_of(m))];
    for (Index k = 0; k < unknowns(m); ++k) {
      residual[n_x_ + k] = -set(m).surface(static_cast<std::size_t>(k), here.indicator.data());
    }
  }
}

void ElementEquations::assemble_matrix(const Element& element) {
  system_.reset(offset_[at(n_s_)]);
  if (system_.is_sparse()) return assemble_entries(element);
  auto matrix = system_.matrix();
  const Index rows = matrix.rows();
  const auto place = [&](Index stage) { return offset_[at(stage)]; };
  for (Index m = 0; m < n_s_; ++m) {
    for (Index l = 0; l < n_s_; ++l) {
      const double weight = element.h * A_(m, l);
      if (weight == 0.0) continue;
      const double* f_x = values_[at(l)].f_x.data();
      double* block = matrix.data() + place(l) * rows + place(m);
      for (Index j = 0; j < n_x_; ++j, f_x += n_x_, block += rows) {
        for (Index i = 0; i < n_x_; ++i) block[i] = -weight * f_x[i];
      }
      if (unknowns(l) > 0) {
        auto of_selections = matrix.block(place(m), place(l) + n_x_, n_x_, unknowns(l));
        of_selections = directions_of(l);
        of_selections *= -A_(m, l);
      }
    }
    for (Index i = 0; i < n_x_; ++i) matrix(place(m) + i, place(m) + i) += 1.0;
  }
  for (Index m = 0; m < n_s_; ++m) {
    const Index point = point_of(m);
    const auto& here = values_[at(point)];
    for (Index k = 0; k < unknowns(m); ++k) {
      const Index equation = place(m) + n_x_ + k;
      const auto set_rate = [&](double weight, ConstMatrix by, Index column) {
        auto rate = matrix.block(equation, column, 1, by.cols());
        linalg::multiply(row_.transpose(), by, rate);
        rate *= weight;
      };
      surface_row(set(m), static_cast<std::size_t>(k), here);
      if (point < n_s_) {
        matrix.block(equation, place(point), 1, n_x_) = row_;
        continue;
      }
      for (Index l = 0; l < n_s_; ++l) {
        const auto& stage = values_[at(l)];
        set_rate(element.h * b_(l), ConstMatrix(stage.f_x.data(), n_x_, n_x_), place(l));
        if (unknowns(l) > 0) set_rate(b_(l), directions_of(l), place(l) + n_x_);
      }
    }
  }
}

double ElementEquations::update(Element& element) {
  View states(element.stage_states.data(), n_x_, n_s_);
  const auto step = system_.right();
  double change = 0.0, root_change = 0.0;
  for (Index m = 0; m < n_s_; ++m) {
    const Index begin = offset_[at(m)];
    change = std::max(change, step.segment(begin, n_x_).max_abs());
    states.col(m) += step.segment(begin, n_x_);
    if (!roots_.empty()) {
      const bool felt = A_.col(m).max_abs() > 0.0;  // behind a warp nothing depends on the last stage
      root_change = std::max(root_change, roots_.update(static_cast<std::size_t>(m), step.data() + begin, felt));
    }
    double* all = element.stage_selections.data() + m * n_psi_;
    const auto& sliding = set(m).sliding();
    for (Index k = 0; k < unknowns(m); ++k) {
      const Sliding& entry = sliding[at(k)];
      const double correction = step(begin + n_x_ + k) / element.h;
      all[entry.selection] += correction;
      if (entry.reference >= 0) all[entry.reference] -= correction;
    }
  }
  const double scale = std::max(size(element), states.max_abs());
  // Roots by their own size: near the surface they are small, and all that moves the state there.
  return std::max(scale > 0.0 ? change / scale : change, root_change);
}

/// Stages of Euler's method from the left end.
void ElementEquations::guess_by_euler(const Point& left, const double* held, Element& element) {
  kernel_.field(left.t, left.x.data(), left.selections.data(), held, end_.data());
  View states(element.stage_states.data(), n_x_, n_s_);
  for (Index m = 0; m < n_s_; ++m) {
    states.col(m) = ConstVector(left.x);
    states.col(m).add_scaled(element.h * c_(m), end_);
  }
}

/// A Newton step of the right end from the values there; the largest change of a state.
std::optional<double> ElementEquations::move_onto_surfaces(const ActiveSet& active, Element& element) {
  if (projection_.is_sparse()) return move_onto_surfaces_by_entries(active, element);
  const auto& here = values_[at(n_s_)];
  const auto count = static_cast<Index>(active.sliding().size());
  const auto along = directions_.middle_cols(n_s_ * n_psi_, count);
  projection_.reset(count);
  auto matrix = projection_.matrix();
  auto right = projection_.right();
  double steepest = 0.0;
  for (Index k = 0; k < count; ++k) {
    surface_row(active, static_cast<std::size_t>(k), here);
    steepest = std::max(steepest, row_.max_abs());
    for (Index l = 0; l < count; ++l) matrix(k, l) = row_.dot(along.col(l));
    right(k) = -active.surface(static_cast<std::size_t>(k), here.indicator.data());
  }
  if (!projection_.solve(negligible(element) * steepest)) return std::nullopt;
  View x_1(element.end);
  for (Index l = 0; l < count; ++l) x_1.add_scaled(right(l), along.col(l));
  double change = 0.0;
  for (Index i = 0; i < n_x_; ++i) {
    double moved = 0.0;
    for (Index l = 0; l < count; ++l) moved += right(l) * along(i, l);
    change = std::max(change, std::abs(moved));
  }
  return change;
}

/// NOTE: without this the methods with c_s != 1 lose half their order on curved surfaces.
bool ElementEquations::project(double t, const double* held, Element& element) {
  auto& here = values_[at(n_s_)];
  const ActiveSet& active = set(n_s_ - 1);
  const double* selections = element.stage_selections.data() + (n_s_ - 1) * n_psi_;
  double before = std::numeric_limits<double>::infinity();
  for (int iteration = 0; iteration < most_steps_onto_surfaces; ++iteration) {
    kernel_.evaluate(t + element.h, element.end.data(), selections, held, here);
    if (iteration == 0) find_directions(n_s_, here);
    const auto moved = move_onto_surfaces(active, element);
    if (!moved) return false;
    const double change = *moved;
    const double scale = size(element);
    if (change <= 1e-15 * scale || (change <= 1e-12 * scale && change >= 0.5 * before)) return true;
    if (change <= 1e-9 * scale && before <= 1e-4 * scale) return true;
    before = change;
  }
  return false;
}

/// Guesses the selections of a stage. They are the left end's where these are known or nothing better is. Where they
/// are sought they are put off their bounds, for there derivatives of guarded branches are missing.
void ElementEquations::set_guess(std::size_t stage, const Point& left, ElementSolver::Guess guess, Element& element) {
  const bool is_known = known(static_cast<Index>(stage));
  const auto count = static_cast<Index>(set(static_cast<Index>(stage)).sliding().size());
  double* selections = element.stage_selections.data() + stage * static_cast<std::size_t>(n_psi_);
  if (is_known || guess != ElementSolver::Guess::stages) {
    std::copy(left.selections.begin(), left.selections.end(), selections);
  }
  if (guess != ElementSolver::Guess::stages) {
    std::copy_n(left.x.begin(), n_x_, element.stage_states.data() + static_cast<Index>(stage) * n_x_);
  }
  mu_.head(count).set_zero();
  sets_[stage]->unknowns(selections, mu_.data());
  for (Index k = 0; k < count && !is_known; ++k) {
    const bool region = sets_[stage]->sliding()[at(k)].reference >= 0;
    mu_(k) = region ? mu_(k) : std::clamp(mu_(k), 1e-3, 1.0 - 1e-3);
  }
  sets_[stage]->selections(mu_.data(), selections);
}

void ElementEquations::begin(const Point& left, double h, std::span<const ActiveSet> sets, const double* held,
                             ElementSolver::Guess guess, Element& element) {
  const auto n_x = static_cast<std::size_t>(n_x_), n_s = static_cast<std::size_t>(n_s_);
  one_set_ = sets.size() == 1;
  slides_ = !sets.front().sliding().empty();
  at_end_ = explicit_method_ && one_set_ && slides_;
  element.t = left.t;
  element.h = h;
  element.x = left.x;
  element.size = std::max(left.size, ConstVector(left.x).max_abs());
  element.stage_states.resize(n_x * n_s);
  element.stage_slopes.resize(n_x * n_s);
  element.stage_selections.resize(static_cast<std::size_t>(n_psi_) * n_s);
  element.end.resize(n_x);
  for (std::size_t m = 0; m < n_s; ++m) {
    sets_[m] = &sets[one_set_ ? 0 : m];
    offset_[m + 1] = offset_[m] + n_x_ + unknowns(static_cast<Index>(m));
    set_guess(m, left, guess, element);
  }
  set_warp(element.warp);
  const bool has_roots = !roots_.empty() && guess == ElementSolver::Guess::left_end;
  if (has_roots || guess == ElementSolver::Guess::field) guess_by_euler(left, held, element);
  if (roots_.empty()) return;
  for (std::size_t m = 0; m < n_s; ++m) {
    roots_.start(m, element.t + h * c_(static_cast<Index>(m)), element.stage_states.data() + m * n_x,
                 element.stage_selections.data() + m * static_cast<std::size_t>(n_psi_), held);
  }
}

/// f and the indicators behind the last stage.
void ElementEquations::evaluate_end(const Element& element, const double* held) {
  const auto last = static_cast<std::size_t>(n_s_);
  end_ = ConstVector(element.x);
  for (std::size_t m = 0; m < last; ++m) {
    end_.add_scaled(element.h * b_(static_cast<Index>(m)), ConstVector(values_[m].f));
  }
  kernel_.evaluate(element.t + element.h, end_.data(), element.stage_selections.data() + (n_s_ - 1) * n_psi_, held,
                   values_[last]);
}

std::optional<double> ElementEquations::step(const double* held, Matrix matrix, Element& element) {
  const bool own = matrix == Matrix::its_own;
  evaluate(element, held, own ? Parts::everything : Parts::values);
  if (at_end_) evaluate_end(element, held);
  if (own) assemble_matrix(element);
  assemble_right(element);
  if (!(own ? system_.solve(negligible(element), DenseSystem::Unit::row) : system_.solve_again())) return std::nullopt;
  const double change = update(element);
  return std::isfinite(change) ? std::optional(change) : std::nullopt;
}

bool ElementEquations::finish(const double* held, Element& element) {
  for (Index m = 0; m < n_s_; ++m) {
    const double t = element.t + element.h * c_(m);
    const double* state = element.stage_states.data() + m * n_x_;
    const double* selections = element.stage_selections.data() + m * n_psi_;
    double* slope = element.stage_slopes.data() + m * n_x_;
    if (roots_.empty()) {
      kernel_.field(t, state, selections, held, slope);
      continue;
    }
    roots_.field(static_cast<std::size_t>(m), t, state, selections, held, slope);
    View(slope, n_x_) *= warp_.slope(tableau_.c(m));
  }
  const ConstMatrix states(element.stage_states.data(), n_x_, n_s_);
  element.size = std::max(size(element), states.max_abs());
  View end(element.end);
  if (tableau_.ends_at_last_stage() && !explicit_method_) {
    end = states.col(n_s_ - 1);
    return true;
  }
  linalg::multiply(ConstMatrix(element.stage_slopes.data(), n_x_, n_s_), tableau_.b, end);
  end *= element.h;
  end += ConstVector(element.x);
  return !(one_set_ && slides_) || project(element.t, held, element);
}

}  // namespace saltus::fesd_integrator
