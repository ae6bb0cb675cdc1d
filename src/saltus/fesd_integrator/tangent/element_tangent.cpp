#include <algorithm>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/fesd_integrator/tangent/element_tangent_internal.hpp"
#include "saltus/linalg/factors.hpp"

namespace saltus::fesd_integrator {
namespace {

using linalg::Index;
using linalg::Matrix;
using linalg::Vector;
using ConstMatrix = linalg::ConstView;
using ConstVector = linalg::ConstView;

/// Rows of the surfaces that slide, from rows of all indicators.
Matrix surfaces_of(const ActiveSet& set, const Matrix& indicators) {
  Matrix rows(static_cast<Index>(set.sliding().size()), indicators.cols());
  for (Index k = 0; k < rows.rows(); ++k) {
    for (Index c = 0; c < rows.cols(); ++c) {
      rows(k, c) = set.surface(static_cast<std::size_t>(k), indicators.col(c).data());
    }
  }
  return rows;
}

/// Of least norm where selections are not unique.
Matrix solve(ConstMatrix matrix, ConstMatrix right) { return linalg::least_squares(matrix, right); }

}  // namespace

/// Unknowns: stage by stage x_m and the selections that slide, the end, the lengths of the projection.
struct ElementTangent::System {
  std::vector<Index> place;  ///< of the stages
  Index end = 0;
  std::vector<Matrix> basis;  ///< of the stages: changes of all selections from those of the unknown ones
  Matrix matrix, right;
  Matrix first_selections;  ///< of a known first stage, else zero
};

ElementTangent::ElementTangent(const discretization::TangentKernel& kernel, discretization::ButcherTableau tableau)
    : kernel_(kernel),
      tableau_(std::move(tableau)),
      n_x_(static_cast<Index>(kernel.states())),
      n_(static_cast<Index>(kernel.selections())),
      n_p_(static_cast<Index>(kernel.parameters())),
      n_s_(tableau_.stages()),
      values_(static_cast<std::size_t>(n_s_)),
      inside_(kernel.selections()) {
  for (auto& point : values_) kernel.size(point);
  kernel.size(left_);
  kernel.size(right_);
}

/// Sliding step selections are moved off their bounds, where derivatives of guarded branches are missing; f is affine
/// in each of them, so that its derivatives hardly depend on it.
void ElementTangent::evaluate(double t, const double* x, const double* selections, const ActiveSet& set,
                              const double* held, discretization::TangentValues& at) {
  constexpr double off = 1e-9;
  inside_.assign(selections, selections + n_);
  for (const Sliding& entry : set.sliding()) {
    auto& value = inside_[saltus::at(entry.selection)];
    if (entry.reference < 0) value = std::clamp(value, off, 1.0 - off);
  }
  kernel_.evaluate(t, x, inside_.data(), held, at);
}

Matrix ElementTangent::basis(const ActiveSet& set) const {
  const auto& sliding = set.sliding();
  Matrix basis = Matrix::zero(n_, static_cast<Index>(sliding.size()));
  for (std::size_t k = 0; k < sliding.size(); ++k) {
    basis(sliding[k].selection, static_cast<Index>(k)) = 1.0;
    if (sliding[k].reference >= 0) basis(sliding[k].reference, static_cast<Index>(k)) -= 1.0;
  }
  return basis;
}

Matrix ElementTangent::field(const discretization::TangentValues& at, const Vector& t, const Matrix& p) const {
  return ConstVector(at.f_t) * t.transpose() + ConstMatrix(at.f_p.data(), n_x_, n_p_) * p;
}

Matrix ElementTangent::indicator(const discretization::TangentValues& at, const Vector& t, const Matrix& p) const {
  return ConstVector(at.indicator_t) * t.transpose() + ConstMatrix(at.indicator_p.data(), n_, n_p_) * p;
}

/// From the rate of the surfaces = 0, at a point where `at` was evaluated.
Matrix ElementTangent::projected_selections(const ActiveSet& set, const discretization::TangentValues& at,
                                            const Directions& go) const {
  const Matrix changes = basis(set);
  if (changes.cols() == 0) return Matrix::zero(n_, go.x.cols());
  const Matrix rate = ConstMatrix(at.rate_x.data(), n_, n_x_) * go.x + ConstVector(at.rate_t) * go.t.transpose() +
                      ConstMatrix(at.rate_p.data(), n_, n_p_) * go.p;
  const Matrix matrix = ConstMatrix(at.rate_selection.data(), n_, n_) * changes;
  return -changes * solve(surfaces_of(set, matrix), surfaces_of(set, rate));
}

/// The end is x_1 = x_b + D mu with x_b = x_0 + h sum b_l f_l. The direction D = f_alpha is that at x_b and the last
/// stage's selections:
///   d x_1 = (1 + (D mu)_x) d x_b + D d mu + (D mu)_alpha d alpha_s + (D mu)_t d t + (D mu)_p d p.
/// The rows of the end are those of x_b up to here.
void ElementTangent::add_projection(System& system, const Element& element, const ActiveSet& set, const double* held,
                                    const Directions& go) {
  const Index lengths = system.end + n_x_, count = system.matrix.rows() - lengths;
  Vector before = ConstVector(element.x);
  before += element.h * (ConstMatrix(element.stage_slopes.data(), n_x_, n_s_) * tableau_.b);
  const double* selections = element.stage_selections.data() + (n_s_ - 1) * n_;
  const Matrix& changes = system.basis.back();
  const double t = element.t + element.h;
  evaluate(t, before.data(), selections, set, held, left_);
  const Matrix along = ConstMatrix(left_.f_selection.data(), n_x_, n_) * changes;
  const Vector moved = ConstVector(element.end) - before;
  const Vector mu = changes * solve(along, moved);
  kernel_.direction(t, before.data(), inside_.data(), held, mu.data(), direction_);
  const Matrix turned = Matrix::identity(n_x_, n_x_) + ConstMatrix(direction_.by_x.data(), n_x_, n_x_);
  auto stages = system.matrix.block(system.end, 0, n_x_, system.end);
  stages = turned * stages;
  auto right = system.right.middle_rows(system.end, n_x_);
  right = turned * right;
  right += ConstVector(direction_.by_t) * (go.t + go.h).transpose();
  right += ConstMatrix(direction_.by_p.data(), n_x_, n_p_) * go.p;
  system.matrix.block(system.end, system.place.back() + n_x_, n_x_, changes.cols()) -=
      ConstMatrix(direction_.by_selection.data(), n_x_, n_) * changes;
  system.matrix.block(system.end, lengths, n_x_, count) = -along;
}

ElementTangent::System ElementTangent::begin_system(const Element& element, const Sets& sets, const double* held,
                                                    bool projected, const Directions& go) {
  System system;
  Index size = 0;
  for (Index m = 0; m < n_s_; ++m) {
    system.place.push_back(size);
    system.basis.push_back(is_known(m) ? Matrix(n_, 0) : basis(sets(m)));
    size += n_x_ + system.basis.back().cols();
    evaluate(element.t + element.h * tableau_.c(m), element.stage_states.data() + m * n_x_,
             element.stage_selections.data() + m * n_, sets(m), held, values_[at(m)]);
  }
  system.end = size;
  size += n_x_ + (projected ? system.basis.back().cols() : 0);
  system.matrix = Matrix::zero(size, size);
  system.right = Matrix::zero(size, go.x.cols());
  system.first_selections = Matrix::zero(n_, go.x.cols());
  return system;
}

/// Row block `row`: unknown - x_0 - h sum_l weight_l f_l = 0.
void ElementTangent::add_quadrature(System& system, Index row, const Vector& weight, double h, const Directions& go) {
  system.matrix.block(row, row, n_x_, n_x_).set_identity();
  auto right = system.right.middle_rows(row, n_x_);
  right = go.x;
  for (Index l = 0; l < n_s_; ++l) {
    const double factor = h * weight(l);
    if (factor == 0.0) continue;
    const auto& stage = values_[at(l)];
    const ConstMatrix by_selection(stage.f_selection.data(), n_x_, n_);
    const Index column = system.place[at(l)];
    const Matrix& changes = system.basis[at(l)];
    system.matrix.block(row, column, n_x_, n_x_) -= factor * ConstMatrix(stage.f_x.data(), n_x_, n_x_);
    system.matrix.block(row, column + n_x_, n_x_, changes.cols()) -= factor * by_selection * changes;
    right += factor * field(stage, go.t + tableau_.c(l) * go.h, go.p);
    right += weight(l) * ConstVector(stage.f) * go.h.transpose();
    if (is_known(l)) right += factor * by_selection * system.first_selections;
  }
}

/// Row block `row`: surfaces = 0 at the unknown state that begins at `column`.
void ElementTangent::add_surfaces(System& system, Index row, Index column, const ActiveSet& active,
                                  const discretization::TangentValues& at, double node, const Directions& go) const {
  const auto count = static_cast<Index>(active.sliding().size());
  system.matrix.block(row, column, count, n_x_) = surfaces_of(active, ConstMatrix(at.indicator_x.data(), n_, n_x_));
  system.right.middle_rows(row, count) = -surfaces_of(active, indicator(at, go.t + node * go.h, go.p));
}

bool ElementTangent::is_known(Index stage) const {
  return tableau_.family == discretization::TableauFamily::lobatto_iiia && stage == 0;
}

Matrix ElementTangent::end(const Element& element, std::span<const ActiveSet> sets, const std::vector<double>& left,
                           const double* held, const Directions& go) {
  const bool one_set = sets.size() == 1;
  const bool is_explicit = tableau_.family == discretization::TableauFamily::explicit_rk;
  const bool projected = one_set && !sets[0].sliding().empty() && !is_explicit && !tableau_.ends_at_last_stage();
  const Sets set = [&](Index m) -> const ActiveSet& { return sets[one_set ? 0 : static_cast<std::size_t>(m)]; };
  const double* last_selections = element.stage_selections.data() + (n_s_ - 1) * n_;

  System system = begin_system(element, set, held, projected, go);
  evaluate(element.t + element.h, element.end.data(), last_selections, set(n_s_ - 1), held, right_);
  // Known selections of the first stage are those of the projected field at the left end.
  if (is_known(0)) {
    evaluate(element.t, element.x.data(), left.data(), set(0), held, left_);
    system.first_selections = projected_selections(set(0), left_, go);
  }
  for (Index m = 0; m < n_s_; ++m) {
    const Index row = system.place[at(m)];
    add_quadrature(system, row, tableau_.A.row(m), element.h, go);
    if (system.basis[at(m)].cols() == 0) continue;
    // Half-explicit methods: one stage later, behind the last one at the end.
    const Index point = is_explicit && one_set ? m + 1 : m;
    if (point == n_s_) {
      add_surfaces(system, row + n_x_, system.end, set(m), right_, 1.0, go);
    } else {
      const auto i = static_cast<std::size_t>(point);
      add_surfaces(system, row + n_x_, system.place[i], set(m), values_[i], tableau_.c(point), go);
    }
  }
  add_quadrature(system, system.end, tableau_.b, element.h, go);
  if (projected) {
    add_projection(system, element, sets[0], held, go);
    add_surfaces(system, system.end + n_x_, system.end, sets[0], right_, 1.0, go);
  }
  return solve(system.matrix, system.right).middle_rows(system.end, n_x_);
}

Vector ElementTangent::condition(const Condition& condition, const Element& element, const ActiveSet& set,
                                 const std::vector<double>& right, const double* held, const Directions& go) {
  evaluate(element.t + element.h, element.end.data(), right.data(), set, held, right_);
  const bool side = condition.kind == Condition::Kind::side;
  if (!side && !set.is_determined(condition.selection)) return margin(condition, set, right, go);
  const Matrix change =
      side ? Matrix(ConstMatrix(right_.indicator_x.data(), n_, n_x_) * go.x + indicator(right_, go.t, go.p))
           : projected_selections(set, right_, go);
  Vector sigma(go.x.cols());
  for (Index c = 0; c < sigma.size(); ++c) {
    sigma(c) = side ? set.side(condition.selection, change.col(c).data()) : change(condition.selection, c);
  }
  return sigma;
}

/// 0 is on a facet of the velocities of a balance. With selections that hold the surfaces, what moves the facet's
/// normal takes no part. It goes as the rates of the surfaces do along it.
Vector ElementTangent::margin(const Condition& condition, const ActiveSet& set, const std::vector<double>& right,
                              const Directions& go) {
  std::vector<double> selections = right;
  margins_.evaluate(set, field_view(right_), selections.data());
  const std::vector<double> normal = margins_.normal(set, condition);
  const Matrix rate = ConstMatrix(right_.rate_x.data(), n_, n_x_) * go.x +
                      ConstVector(right_.rate_t) * go.t.transpose() +
                      ConstMatrix(right_.rate_p.data(), n_, n_p_) * go.p;
  return ConstVector(normal).transpose() * surfaces_of(set, rate);
}

}  // namespace saltus::fesd_integrator
