#include "saltus/fesd_integrator/sensitivities.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Core>

#include "saltus/base/contracts.hpp"
#include "saltus/fesd_integrator/element_tangent_internal.hpp"

namespace saltus::fesd_integrator {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;

struct SensitivityPropagation::Implementation {
  const discretization::TangentKernel& kernel;
  ElementTangent element;
  Index n_x, n_p;
  Directions boundary;  ///< X and tau; columns q

  Implementation(const discretization::TangentKernel& kernel_in, discretization::ButcherTableau tableau)
      : kernel(kernel_in), element(kernel_in, std::move(tableau)) {
    n_x = static_cast<Index>(kernel.states());
    n_p = static_cast<Index>(kernel.parameters());
    boundary.x = MatrixXd::Identity(n_x, n_x + n_p);
    boundary.t = boundary.h = RowVectorXd::Zero(n_x + n_p);
    boundary.p = MatrixXd::Zero(n_p, n_x + n_p);
    boundary.p.rightCols(n_p).setIdentity();
  }
};

SensitivityPropagation::SensitivityPropagation(const discretization::TangentKernel& kernel,
                                               discretization::ButcherTableau tableau)
    : implementation_(std::make_unique<Implementation>(kernel, std::move(tableau))) {}
SensitivityPropagation::SensitivityPropagation(SensitivityPropagation&&) noexcept = default;
SensitivityPropagation::~SensitivityPropagation() = default;

void SensitivityPropagation::chain(std::span<const Element> elements, std::span<const std::vector<double>> left,
                                   const ActiveSet& set, const double* held, const Condition* closing) {
  SALTUS_ASSERT(!elements.empty() && left.size() == elements.size() + 1);
  auto& self = *implementation_;
  auto& boundary = self.boundary;
  const Index columns = boundary.x.cols();
  // One more direction: a longer h of all elements.
  Directions go{MatrixXd::Zero(self.n_x, columns + 1), RowVectorXd::Zero(columns + 1), RowVectorXd::Zero(columns + 1),
                MatrixXd::Zero(self.n_p, columns + 1)};
  go.x.leftCols(columns) = boundary.x;
  go.t.head(columns) = boundary.t;
  go.h(columns) = 1.0;
  go.p.leftCols(columns) = boundary.p;
  for (std::size_t i = 0; i < elements.size(); ++i) {
    go.x = self.element.end(elements[i], {&set, 1}, left[i], held, go);
    go.t += go.h;
  }
  const RowVectorXd sigma =
      closing == nullptr ? go.t : self.element.condition(*closing, elements.back(), set, left.back(), held, go);
  const auto count = static_cast<double>(elements.size());
  boundary.x = go.x.leftCols(columns);
  for (Index c = 0; c < columns; ++c) {
    if (sigma(c) == 0.0) continue;  // a direction that leaves the end where it is, even if that is a tangency
    const double dh = -sigma(c) / sigma(columns);
    boundary.x.col(c) += go.x.col(columns) * dh;
    boundary.t(c) += count * dh;
  }
  if (closing == nullptr) boundary.t.setZero();
}

void SensitivityPropagation::fixed_step(const Element& element, std::span<const ActiveSet> sets, const double* held) {
  auto& self = *implementation_;
  const auto n = static_cast<std::ptrdiff_t>(self.kernel.selections());
  const std::vector<double> left(element.stage_selections.begin(), element.stage_selections.begin() + n);
  self.boundary.x = self.element.end(element, sets, left, held, self.boundary);
}

result::Sensitivities SensitivityPropagation::sensitivities(const std::vector<std::string>& parameter_names) const {
  const auto& self = *implementation_;
  constexpr double undefined = std::numeric_limits<double>::quiet_NaN();
  const auto columns = [&](Index first, const std::vector<bool>& misses_times) {
    std::vector<std::vector<double>> rows;
    for (Index i = 0; i < self.n_x; ++i) {
      auto& row = rows.emplace_back();
      for (std::size_t j = 0; j < misses_times.size(); ++j) {
        const double value = self.boundary.x(i, first + static_cast<Index>(j));
        row.push_back(misses_times[j] || !std::isfinite(value) ? undefined : value);
      }
    }
    return rows;
  };
  return {columns(0, self.kernel.states_of_held()), columns(self.n_x, self.kernel.parameters_of_held()),
          parameter_names};
}

}  // namespace saltus::fesd_integrator
