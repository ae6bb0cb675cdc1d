#include "saltus/fesd_integrator/tangent/sensitivities.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/base/contracts.hpp"
#include "saltus/fesd_integrator/tangent/element_tangent_internal.hpp"
#include "saltus/linalg/matrix.hpp"

namespace saltus::fesd_integrator {

using linalg::Index;
using linalg::Matrix;
using linalg::Vector;

struct SensitivityPropagation::Implementation {
  const discretization::TangentKernel& kernel;
  ElementTangent element;
  Index n_x, n_p;
  Directions boundary;  ///< X and tau; columns q
  discretization::HeldTangent tangent;
  discretization::TangentValues values;
  std::vector<bool> undefined;  ///< columns

  Implementation(const discretization::TangentKernel& kernel_in, discretization::ButcherTableau tableau)
      : kernel(kernel_in), element(kernel_in, std::move(tableau)) {
    n_x = static_cast<Index>(kernel.states());
    n_p = static_cast<Index>(kernel.parameters());
    boundary.x = Matrix::identity(n_x, n_x + n_p);
    boundary.t = boundary.h = Vector::zero(n_x + n_p);
    boundary.p = Matrix::zero(n_p, n_x + n_p);
    boundary.p.right_cols(n_p).set_identity();
    kernel.size(values);
    undefined.assign(static_cast<std::size_t>(n_x + n_p), false);
  }

  /// How the time moves at which argument k, last evaluated, has its value.
  [[nodiscard]] Vector shift(std::size_t k, const Matrix& x) const {
    const auto n = static_cast<Index>(kernel.held()), row = static_cast<Index>(k);
    const double rate = tangent.by_t[k];
    if (rate == 0.0) return Vector::zero(x.cols());
    const linalg::ConstView by_x(tangent.by_x.data(), n, n_x), by_p(tangent.by_p.data(), n, n_p);
    return -(by_x.row(row) * x + by_p.row(row) * boundary.p) / rate;
  }
};

SensitivityPropagation::SensitivityPropagation(const discretization::TangentKernel& kernel,
                                               discretization::ButcherTableau tableau)
    : implementation_(std::make_unique<Implementation>(kernel, std::move(tableau))) {}
SensitivityPropagation::SensitivityPropagation(SensitivityPropagation&&) noexcept = default;
SensitivityPropagation::~SensitivityPropagation() = default;

void SensitivityPropagation::chain(std::span<const Element> elements, std::span<const std::vector<double>> left,
                                   const ActiveSet& set, const double* held, const Condition* closing,
                                   std::optional<std::size_t> changing) {
  SALTUS_ASSERT(!elements.empty() && left.size() == elements.size() + 1);
  auto& self = *implementation_;
  auto& boundary = self.boundary;
  const Index columns = boundary.x.cols();
  // One more direction: a longer h of all elements.
  Directions go{Matrix::zero(self.n_x, columns + 1), Vector::zero(columns + 1), Vector::zero(columns + 1),
                Matrix::zero(self.n_p, columns + 1)};
  go.x.left_cols(columns) = boundary.x;
  go.t.head(columns) = boundary.t;
  go.h(columns) = 1.0;
  go.p.left_cols(columns) = boundary.p;
  for (std::size_t i = 0; i < elements.size(); ++i) {
    go.x = self.element.end(elements[i], {&set, 1}, left[i], held, go);
    go.t += go.h;
  }
  Vector target = Vector::zero(columns);  // of a fixed end
  if (closing == nullptr && changing) {
    const Element& last = elements.back();
    self.kernel.held_tangent(last.t + last.h, last.end.data(), held, self.tangent);
    target = self.shift(*changing, boundary.x);
  }
  Vector sigma =
      closing == nullptr ? go.t : self.element.condition(*closing, elements.back(), set, left.back(), held, go);
  sigma.head(columns) -= target;
  const auto count = static_cast<double>(elements.size());
  boundary.x = go.x.left_cols(columns);
  for (Index c = 0; c < columns; ++c) {
    if (sigma(c) == 0.0) continue;  // a direction that leaves the end where it is, even if that is a tangency
    const double dh = -sigma(c) / sigma(columns);
    boundary.x.col(c).add_scaled(dh, go.x.col(columns));
    boundary.t(c) += count * dh;
  }
  if (closing == nullptr) boundary.t = target;
}

void SensitivityPropagation::switched_here(double t, const std::vector<double>& x,
                                           const std::vector<double>& selections, const double* held,
                                           const ActiveSet& set, const Condition& condition) {
  auto& self = *implementation_;
  auto& boundary = self.boundary;
  const Index columns = boundary.x.cols();
  self.kernel.evaluate(t, x.data(), selections.data(), held, self.values);
  const linalg::ConstView field(self.values.f);
  // One more direction: a later boundary.
  Directions go{Matrix(self.n_x, columns + 1), Vector(columns + 1), Vector::zero(columns + 1),
                Matrix::zero(self.n_p, columns + 1)};
  go.x.left_cols(columns) = boundary.x;
  go.x.col(columns) = field;
  go.t.head(columns) = boundary.t;
  go.t(columns) = 1.0;
  go.p.left_cols(columns) = boundary.p;
  Element here;
  here.t = t;
  here.end = x;
  const Vector sigma = self.element.condition(condition, here, set, selections, held, go);
  for (Index c = 0; c < columns; ++c) {
    if (sigma(c) == 0.0) continue;
    const double later = -sigma(c) / sigma(columns);
    boundary.x.col(c).add_scaled(later, field);
    boundary.t(c) += later;
  }
}

void SensitivityPropagation::begin_fixed_steps(int count, const End& end) {
  auto& self = *implementation_;
  Vector target = Vector::zero(self.boundary.t.size());
  if (end.changing) {
    self.kernel.held_tangent(end.t, end.x, end.held, self.tangent);
    target = self.shift(*end.changing, self.boundary.x);
  }
  self.boundary.h = (target - self.boundary.t) / count;
}

void SensitivityPropagation::fixed_step(const Element& element, std::span<const ActiveSet> sets, const double* held,
                                        double part) {
  auto& self = *implementation_;
  const Vector whole = self.boundary.h;
  self.boundary.h *= part;
  const auto n = static_cast<std::ptrdiff_t>(self.kernel.selections());
  const std::vector<double> left(element.stage_selections.begin(), element.stage_selections.begin() + n);
  self.boundary.x = self.element.end(element, sets, left, held, self.boundary);
  self.boundary.t += self.boundary.h;
  self.boundary.h = whole;
}

void SensitivityPropagation::held_changed(double t, const double* x, const double* selections, const double* before,
                                          const double* behind) {
  auto& self = *implementation_;
  const std::size_t n = self.kernel.held();
  self.kernel.held_tangent(t, x, before, self.tangent);
  std::optional<Vector> moves;
  for (std::size_t k = 0; k < n; ++k) {
    if (before[k] == behind[k]) continue;
    // One that changes because another one does has no time of its own.
    bool follows = false;
    for (std::size_t l = 0; l < k; ++l) {
      follows = follows || (before[l] != behind[l] && self.tangent.by_held[l * n + k] != 0.0);
    }
    if (follows) continue;
    const Vector own = self.shift(k, self.boundary.x);
    if (!moves) moves = own;
    for (Index c = 0; c < own.size(); ++c) {
      constexpr double rounding = 1e-9;
      const bool apart = std::abs(own(c) - (*moves)(c)) > rounding * (1.0 + std::abs(own(c)));
      if (apart) self.undefined[at(c)] = true;
    }
  }
  if (!moves) return;
  // An event that lies on the end of a simulation step was not what ended it: it moves off it with the field before it.
  self.kernel.evaluate(t, x, selections, before, self.values);
  const Vector off = *moves - self.boundary.t;
  self.boundary.x += linalg::ConstView(self.values.f) * off.transpose();
  self.boundary.t = *moves;
}

result::Sensitivities SensitivityPropagation::sensitivities(const std::vector<std::string>& parameter_names) const {
  const auto& self = *implementation_;
  constexpr double undefined = std::numeric_limits<double>::quiet_NaN();
  const auto columns = [&](Index first, Index count) {
    std::vector<std::vector<double>> rows;
    for (Index i = 0; i < self.n_x; ++i) {
      auto& row = rows.emplace_back();
      for (Index j = first; j < first + count; ++j) {
        const double value = self.boundary.x(i, j);
        row.push_back(self.undefined[at(j)] || !std::isfinite(value) ? undefined : value);
      }
    }
    return rows;
  };
  return {columns(0, self.n_x), columns(self.n_x, self.n_p), parameter_names};
}

}  // namespace saltus::fesd_integrator
