#include <algorithm>
#include <array>
#include <limits>

#include "saltus/base/contains.hpp"
#include "saltus/discretization/ocp/insertion_prices_internal.hpp"
#include "saltus/linalg/factors.hpp"

namespace saltus::discretization {
namespace {

using mpcc::ActiveSide;

/// Error of the multipliers of a new element, relative to the adjoints: above it there are none.
constexpr double agreement = 1e-6;

}  // namespace

InsertionPrices::InsertionPrices(const SolvedBranch& branch)
    : made_(branch.made),
      modes_(branch.modes),
      w_(branch.w),
      rows_(branch.multipliers.rows),
      trial_(made_, w_),
      within_(made_.element.size()),
      at_node_(made_.element.size()) {
  const auto& kernel = made_.kernel;
  const std::array<const LocalFunction*, 5> of_elements{&kernel.element, &kernel.running, &kernel.stage_squares,
                                                        &kernel.stage_rows, &kernel.measured_squares};
  for (const auto& placed : made_.functions) {
    if (placed.of_method || placed.is_dormant) continue;
    auto& list = contains(of_elements, placed.function) ? within_ : at_node_;
    for (std::size_t i = 0; i < placed.copies.size(); ++i) {
      if (placed.copies[i].element >= 0) list[at(placed.copies[i].element)].push_back({&placed, i});
    }
  }
}

void InsertionPrices::add_slopes(LocalFunction& function, const double* z, mpcc::ConstVectorView multipliers, int first,
                                 linalg::View slopes) const {
  const auto* parameters = made_.local_parameters.data();
  const auto count = static_cast<int>(slopes.size());
  if (function.has_objective()) {
    std::vector<double> gradient(at(function.variables()));
    function.gradient(z, parameters, gradient.data());
    for (int i = 0; i < count; ++i) slopes[i] += gradient[at(first + i)];
  }
  const auto& pattern = function.jacobian_pattern();
  std::vector<double> entries(at(pattern.entries()));
  function.jacobian(z, parameters, entries.data());
  for (int e = 0; e < pattern.entries(); ++e) {
    const int column = pattern.column[at(e)] - first;
    if (pattern.row[at(e)] >= function.equations() || column < 0 || column >= count) continue;
    slopes[column] += multipliers[pattern.row[at(e)]] * entries[at(e)];
  }
}

void InsertionPrices::add_slopes(const std::vector<CopyOf>& copies, int first, linalg::View slopes) const {
  for (const auto& [placed, number] : copies) {
    const auto& z = placed->placed->gather(static_cast<int>(number), w_, made_.constants);
    const auto multipliers = rows_.segment(placed->copies[number].first_row, placed->function->equations());
    add_slopes(*placed->function, z.data(), multipliers, first, slopes);
  }
}

linalg::Vector InsertionPrices::adjoint(const Insertion& where) const {
  const auto& kernel = made_.kernel;
  const auto& layout = kernel.layout;
  const int moving = kernel.states + (kernel.depends_on_time ? 1 : 0);
  linalg::Vector adjoint = linalg::Vector::zero(moving + layout.lambda.size);
  const std::size_t e = where.before;
  const bool is_end = e == made_.element.size() || at(made_.element[e].interval) != where.interval;
  if (e < made_.element.size()) {
    add_slopes(within_[e], 0, adjoint.head(moving));
    // Where the horizon is fixed intervals begin at times that are known.
    if (kernel.depends_on_time && made_.element[e].left[at(kernel.states)] < 0) adjoint[kernel.states] = 0.0;
  }
  if (e == 0) return adjoint;
  if (is_end) {
    linalg::Vector of_node = linalg::Vector::zero(1 + kernel.states);
    add_slopes(at_node_[e - 1], 0, of_node);
    adjoint.head(kernel.states) += of_node.tail(kernel.states);
    if (kernel.depends_on_time) adjoint[kernel.states] += of_node[0];
    const auto state = right_state(made_, made_.element[e - 1]);
    for (std::size_t i = 0; i < made_.linear.size(); ++i) {
      for (const auto& [variable, factor] : made_.linear[i].entries) {
        const auto place = std::find(state.begin(), state.end(), variable);
        if (place != state.end())
          adjoint[place - state.begin()] += factor * rows_[made_.first_linear_row + static_cast<int>(i)];
      }
    }
  }
  if (e == made_.element.size()) return adjoint;
  // A multiplier that only what follows holds at zero: dL/dlambda is 0, so it bears what the element before leaves.
  const int last = layout.lambda.at(layout.lambda.count - 1);
  linalg::Vector left_over = linalg::Vector::zero(layout.lambda.size);
  add_slopes(within_[e - 1], kernel.element.variables() - layout.size + last, left_over);
  for (int k = 0; k < layout.lambda.size; ++k) {
    const bool is_held = modes_.of(e, at(k)) == ActiveSide::H && modes_.of(e - 1, at(k)) == ActiveSide::G;
    if (is_held) adjoint[moving + k] = -left_over[k];
  }
  return adjoint;
}

std::optional<double> InsertionPrices::multiplier_of_sum(std::size_t interval) const {
  const auto& lengths = made_.interval[interval].lengths;
  if (lengths.empty()) return std::nullopt;
  for (std::size_t i = 0; i < made_.linear.size(); ++i) {
    if (made_.linear[i].entries.front().first == lengths.front())
      return rows_[made_.first_linear_row + static_cast<int>(i)];
  }
  return std::nullopt;
}

std::optional<double> InsertionPrices::price(const Insertion& where) const {
  auto& kernel = made_.kernel;
  const auto& layout = kernel.layout;
  const auto of_sum = multiplier_of_sum(where.interval);
  // Slacks of kinks belong to elements that are there.
  if (!of_sum || kernel.running.variables() > kernel.element.variables()) return std::nullopt;
  const auto z = trial_.inputs(where.left, where.interval, where.own, where.length);
  const auto is_held = trial_.held(where.modes);
  const int first = kernel.element.variables() - layout.size;

  linalg::Vector slopes = linalg::Vector::zero(layout.size);
  if (kernel.running.has_objective()) add_slopes(kernel.running, z.data(), {}, first, slopes);
  const linalg::Vector behind = adjoint(where);
  const auto add_at = [&](int local, linalg::Index from, int count) {
    slopes.segment(local, count) += behind.segment(from, count);
  };
  add_at(layout.right_state(), 0, kernel.states);
  if (kernel.depends_on_time) add_at(layout.end_time.first, kernel.states, 1);
  add_at(layout.lambda.at(layout.lambda.count - 1), behind.size() - layout.lambda.size, layout.lambda.size);

  const linalg::Matrix jacobian = trial_.jacobian(z);
  const linalg::Matrix transposed = ElementTrial::columns_of_free(jacobian, is_held).transpose();
  linalg::Vector right(transposed.rows());
  linalg::Index next = 0;
  for (int local = 0; local < layout.size; ++local) {
    if (!is_held[at(local)]) right[next++] = -slopes[local];
  }
  const linalg::Vector own = linalg::least_squares(transposed, right);
  const linalg::Vector error = linalg::Vector(transposed * own) - right;
  if (!(error.max_abs() <= agreement * (1.0 + right.max_abs()))) return std::numeric_limits<double>::infinity();
  const auto boundary = trial_.left_of(where.before);
  double of_jump = 0.0;
  for (int i = 0; i < kernel.states; ++i) of_jump += behind[i] * (where.left[at(i)] - boundary[at(i)]);
  const int speed = made_.interval[where.interval].shared[at(kernel.shared.speed())];
  const double of_length = slopes[layout.h] + jacobian.col(layout.h).dot(own);
  const double of_share = value_at(speed, w_, made_.constants) * of_length + *of_sum;
  return of_jump + where.length * of_share;
}

}  // namespace saltus::discretization
