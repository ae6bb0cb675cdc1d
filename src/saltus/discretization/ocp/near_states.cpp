#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/discretization/ocp/near_states_internal.hpp"
#include "saltus/discretization/ocp/surface_states_internal.hpp"
#include "saltus/linalg/factors.hpp"

namespace saltus::discretization {
namespace {

/// Of what a switching function could be in such a motion: a smaller value counts as 0.
constexpr double as_good_as_zero = 0.05;
constexpr int newton_steps = 8;
constexpr double exact_enough = 1e-13;

/// Of states that change by so much.
linalg::Vector scales(const linalg::Matrix& jacobian, const linalg::Vector& changes) {
  linalg::Vector scale(jacobian.rows());
  for (linalg::Index i = 0; i < jacobian.rows(); ++i) {
    for (linalg::Index j = 0; j < jacobian.cols(); ++j) scale[i] += std::abs(jacobian(i, j)) * changes[j];
  }
  return scale;
}

}  // namespace

NearStates::NearStates(const OcpStructure& made, mpcc::ConstVectorView w, std::vector<double> parameters)
    : made_(made),
      w_(w),
      parameters_(std::move(parameters)),
      jacobian_(made.kernel.indicator.factory("saltus_indicator_x", made.kernel.indicator.name_in(), {"jac:o0:i1"})),
      scale_(linalg::Vector::zero(made.kernel.selections)) {
  const ElementTrial trial(made, w);
  linalg::Vector changes = linalg::Vector::zero(made.kernel.states);
  for (const auto& interval : made.interval) {
    begins_.push_back(trial.left_of(at(interval.first_element)));
    for (int i = 0; i < made.kernel.states; ++i) {
      changes[i] = std::max(changes[i], std::abs(begins_.back()[at(i)] - begins_.front()[at(i)]));
    }
  }
  for (std::size_t k = 0; k < begins_.size(); ++k) {
    const linalg::Vector here = scales(jacobian(k, begins_[k]), changes);
    for (linalg::Index i = 0; i < scale_.size(); ++i) scale_[i] = std::max(scale_[i], here[i]);
  }
}

std::vector<casadi::DM> NearStates::inputs(std::size_t k, const std::vector<double>& left) const {
  const auto& sizes = made_.kernel.shared;
  const auto& shared = made_.interval[k].shared;
  const auto value = [&](int i) { return value_at(shared[at(i)], w_, made_.constants); };
  std::vector<double> known = parameters_;
  for (int i = 0; i < sizes.held; ++i) known.push_back(value(sizes.controls + sizes.parameters + i));
  for (int i = 0; i < sizes.controls; ++i) known.push_back(value(i));
  const auto states = at(made_.kernel.states);
  const double horizon = value_at(made_.horizon, w_, made_.constants);
  const double t =
      made_.kernel.depends_on_time ? left[states] : made_.from + horizon * static_cast<double>(k) / made_.intervals;
  return {t, std::vector<double>(left.begin(), left.begin() + static_cast<std::ptrdiff_t>(states)), known};
}

linalg::Vector NearStates::psi(std::size_t k, const std::vector<double>& left) const {
  const auto values = casadi::DM::densify(made_.kernel.indicator(inputs(k, left)).front()).nonzeros();
  return linalg::ConstView(values);
}

linalg::Matrix NearStates::jacobian(std::size_t k, const std::vector<double>& left) const {
  const auto values = casadi::DM::densify(jacobian_(inputs(k, left)).front());
  linalg::Matrix found(values.size1(), values.size2());
  for (casadi_int i = 0; i < values.size1(); ++i) {
    for (casadi_int j = 0; j < values.size2(); ++j) found(i, j) = values(i, j).scalar();
  }
  return found;
}

/// One row per surface where both are: psi, or its difference to that of another region.
linalg::Matrix NearStates::held(const std::vector<bool>& is_zero) const {
  const auto& kernel = made_.kernel;
  std::vector<std::pair<int, int>> rows;
  std::map<int, int> first_of_part;
  for (std::size_t k = 0; k < kernel.pairs.size(); ++k) {
    const auto& pair = kernel.pairs[k];
    if (!is_zero[k]) continue;
    if (pair.is_region) {
      const auto [first, is_first] = first_of_part.emplace(part_of(pair.selection), pair.selection);
      if (!is_first) rows.emplace_back(pair.selection, first->second);
    } else if (!pair.complement && is_zero[k + 1]) {
      rows.emplace_back(pair.selection, -1);
    }
  }
  linalg::Matrix combined = linalg::Matrix::zero(static_cast<linalg::Index>(rows.size()), kernel.selections);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    combined(static_cast<linalg::Index>(i), rows[i].first) = 1.0;
    if (rows[i].second >= 0) combined(static_cast<linalg::Index>(i), rows[i].second) = -1.0;
  }
  return combined;
}

int NearStates::part_of(int selection) const {
  const auto& parts = made_.kernel.simplex_parts;
  return static_cast<int>(
      std::count_if(parts.begin(), parts.end(), [&](auto& part) { return part.first <= selection; }));
}

std::vector<bool> NearStates::zeros(const linalg::Vector& lambda) const {
  std::vector<bool> are_zero;
  for (linalg::Index i = 0; i < lambda.size(); ++i) {
    are_zero.push_back(lambda[i] <= as_good_as_zero * scale_[made_.kernel.pairs[at(i)].selection]);
  }
  return are_zero;
}

std::optional<std::vector<double>> NearStates::at_begin_of(std::size_t k, const std::vector<double>& left) const {
  const auto& kernel = made_.kernel;
  auto begin = begins_[k];
  const linalg::Vector own = multipliers_of(kernel, psi(k, left));
  const auto is_zero = zeros(own);
  if (is_zero != zeros(multipliers_of(kernel, psi(k, begin)))) return std::nullopt;
  const linalg::Matrix rows = held(is_zero);
  const linalg::Vector wanted = rows * psi(k, left);
  for (int step = 0; step < newton_steps && rows.rows() > 0; ++step) {
    const linalg::Vector error = rows * psi(k, begin) - wanted;
    if (error.max_abs() <= exact_enough) break;
    const linalg::Vector change = linalg::least_squares(linalg::Matrix(rows * jacobian(k, begin)), error);
    for (int i = 0; i < kernel.states; ++i) begin[at(i)] -= change[i];
  }
  const linalg::Vector lambda = multipliers_of(kernel, psi(k, begin));
  const std::size_t first = left.size() - kernel.pairs.size();
  for (std::size_t i = 0; i < kernel.pairs.size(); ++i) {
    const double value = lambda[static_cast<linalg::Index>(i)];
    if ((left[first + i] <= on_surface) != (value <= on_surface)) return std::nullopt;
    begin[first + i] = is_zero[i] ? left[first + i] : value;
  }
  return begin;
}

}  // namespace saltus::discretization
