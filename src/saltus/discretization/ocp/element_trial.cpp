#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "saltus/discretization/ocp/element_trial_internal.hpp"
#include "saltus/discretization/ocp/surface_states_internal.hpp"
#include "saltus/linalg/factors.hpp"

namespace saltus::discretization {
namespace {

using mpcc::ActiveSide;

constexpr int largest_steps = 15;
/// Of the equations of an element that is solved, and of one that no step makes smaller.
constexpr double solved = 1e-10;
constexpr double exact = 1e-13;
/// Steps in a row that do not halve the error: what has no solution stays where the equations contradict each other
/// least.
constexpr int most_vain_steps = 3;

/// What is left, relative to the beginning, of the multiplier that comes to 0 first.
double least_left(const std::vector<double>& begin, const std::vector<double>& end) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < begin.size(); ++k) {
    if (begin[k] > on_surface) least = std::min(least, end[k] / begin[k]);
  }
  return least;
}

}  // namespace

std::vector<HeldSelection> held_while_closing(const OcpKernel::Implementation& kernel,
                                              const ElementSides::Sides& modes) {
  std::vector<HeldSelection> held;
  const auto is_zero = [&](int pair) { return modes[at(pair)] == ActiveSide::G; };
  for (const auto& gap : kernel.closing_gaps) {
    if (!is_zero(gap.closing)) continue;
    const auto& pair = kernel.pairs[at(is_zero(gap.closed) ? gap.closed : gap.open)];
    for (int m = 0; m < kernel.layout.stages; ++m) {
      held.push_back({kernel.layout.selection.at(m, pair.selection), pair.complement});
    }
  }
  return held;
}

std::vector<double> ElementTrial::left_of(std::size_t number) const {
  const auto& kernel = made_.kernel;
  std::vector<int> places;
  if (number < made_.element.size()) {
    places = made_.element[number].left;
  } else {
    places = right_state(made_, made_.element.back());
    if (kernel.depends_on_time) places.push_back(made_.element.back().variable(kernel.layout.end_time.first));
    const auto lambda = made_.left_lambda(static_cast<int>(number));
    places.insert(places.end(), lambda.begin(), lambda.end());
  }
  std::vector<double> values;
  for (const int place : places) values.push_back(value_at(place, w_, made_.constants));
  return values;
}

std::vector<double> ElementTrial::right_of(const linalg::Vector& own) const {
  const auto& layout = made_.kernel.layout;
  std::vector<double> values;
  for (int i = 0; i < made_.kernel.states; ++i) values.push_back(own[layout.right_state() + i - 1]);
  if (made_.kernel.depends_on_time) values.push_back(own[layout.end_time.first - 1]);
  for (int i = 0; i < layout.lambda.size; ++i) values.push_back(own[layout.lambda.at(layout.lambda.count - 1, i) - 1]);
  return values;
}

bool are_near(const std::vector<double>& a, const std::vector<double>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), [](double x, double y) { return std::abs(x - y) <= on_surface; });
}

double ElementTrial::length_of(std::size_t number) const {
  const auto& element = made_.element[number];
  const int speed = made_.interval[at(element.interval)].shared[at(made_.kernel.shared.speed())];
  return value_at(element.length, w_, made_.constants) * value_at(speed, w_, made_.constants);
}

bool ElementTrial::is_at_edge(std::size_t number) const {
  const auto& kernel = made_.kernel;
  const auto& [multiplier, selection] = std::tie(kernel.layout.lambda, kernel.layout.selection);
  const auto left = lambda(left_of(number));
  for (std::size_t k = 0; k < kernel.pairs.size(); ++k) {
    const auto& pair = kernel.pairs[k];
    double largest = left[k];
    for (int point = 0; point < multiplier.count; ++point) {
      largest = std::max(largest, w_[made_.element[number].variable(multiplier.at(point, static_cast<int>(k)))]);
    }
    for (int m = 0; m < kernel.layout.stages; ++m) {
      const double value = w_[made_.element[number].variable(selection.at(m, pair.selection))];
      largest = std::max(largest, pair.complement ? 1.0 - value : value);
    }
    if (largest <= on_surface) return true;
  }
  return false;
}

std::vector<double> ElementTrial::lambda(const std::vector<double>& left) const {
  return {left.end() - made_.kernel.layout.lambda.size, left.end()};
}

std::vector<bool> ElementTrial::hold(const Modes& modes, linalg::View local) const {
  const auto& kernel = made_.kernel;
  const auto& layout = kernel.layout;
  std::vector<bool> is_held(at(layout.size), false);
  const auto set = [&](int variable, double value) {
    is_held[at(variable)] = true;
    local[variable] = value;
  };
  set(layout.h, local[layout.h]);
  for (std::size_t k = 0; k < kernel.pairs.size(); ++k) {
    const auto& pair = kernel.pairs[k];
    if (modes[k] == ActiveSide::G) {
      for (int m = 0; m < layout.stages; ++m) set(layout.selection.at(m, pair.selection), pair.complement ? 1.0 : 0.0);
    } else {
      for (int point = 0; point < layout.lambda.count; ++point) {
        set(layout.lambda.at(point, static_cast<int>(k)), 0.0);
      }
    }
  }
  for (const auto& held : held_while_closing(kernel, modes)) set(held.local, held.at_upper ? 1.0 : 0.0);
  return is_held;
}

void ElementTrial::begin_at(const std::vector<double>& left, linalg::View local) const {
  const auto& kernel = made_.kernel;
  const auto& layout = kernel.layout;
  const linalg::ConstView state(left.data(), kernel.states);
  const auto fill = [&](const VariableBlock& block) {
    for (int group = 0; group < block.count; ++group) local.segment(block.at(group), block.size) = state;
  };
  if (kernel.options.representation == Representation::integral) fill(layout.stage);
  fill(layout.end_state);
  for (int i = layout.selection.first; i < layout.selection.end(); ++i) local[i] = 0.5;
  if (layout.end_time.count > 0) local[layout.end_time.first] = left[at(kernel.states)];
}

/// Those that an element shares with others; its own are 0. Lengths are in parts of a control interval: the speed is 1.
std::vector<double> ElementTrial::inputs(const std::vector<double>& left, std::size_t interval) const {
  const auto& kernel = made_.kernel;
  std::vector<double> z = left;
  for (const int place : made_.interval[interval].shared) z.push_back(value_at(place, w_, made_.constants));
  z[left.size() + at(kernel.shared.speed())] = 1.0;
  z.resize(z.size() + at(kernel.layout.size), 0.0);
  return z;
}

std::vector<double> ElementTrial::inputs(const std::vector<double>& left, std::size_t interval,
                                         const linalg::Vector& own, double length) const {
  std::vector<double> z = inputs(left, interval);
  z[z.size() - at(own.size()) - 1] = length;
  std::copy(own.data(), own.data() + own.size(), z.end() - own.size());
  return z;
}

std::optional<linalg::Vector> ElementTrial::solve(const std::vector<double>& left, std::size_t interval,
                                                  const Modes& modes, double length, const linalg::Vector* near) const {
  const auto& kernel = made_.kernel;
  std::vector<double> z = inputs(left, interval);
  const std::size_t first = z.size() - at(kernel.layout.size);
  linalg::View local(z.data() + first, kernel.layout.size);
  begin_at(left, local);
  if (near) local.tail(near->size()) = *near;
  local[kernel.layout.h] = length;
  std::vector<bool> is_held = hold(modes, local);
  do {
    if (!solve(z, first, is_held)) return std::nullopt;
  } while (hold_beyond(local, is_held));
  return local.tail(kernel.layout.size - 1);
}

/// From rest multipliers fall with the square of time.
std::optional<linalg::Vector> ElementTrial::solve_to_end(const std::vector<double>& left, std::size_t interval,
                                                         const Modes& modes, double& length) const {
  constexpr int most_steps = 60;
  constexpr double enough = 1e-9, largest_growth = 10.0;
  double low = 0.0, at_low = 1.0, high = std::numeric_limits<double>::infinity(), at_high = 0.0;
  for (int step = 0; step < most_steps; ++step) {
    auto own = solve(left, interval, modes, length);
    if (!own) return std::nullopt;
    const double rest = least_left(lambda(left), lambda(right_of(*own)));
    if (std::abs(rest) <= enough) return own;
    std::tie(rest > 0.0 ? low : high, rest > 0.0 ? at_low : at_high) = std::pair(length, rest);
    if (std::isinf(high)) {
      if (!(rest < 1.0)) return std::nullopt;
      length *= std::min(1.0 / (1.0 - rest), largest_growth);
    } else {
      const bool halve = step % 3 == 0;
      length = halve ? 0.5 * (low + high) : low + (high - low) * at_low / (at_low - at_high);
    }
  }
  return std::nullopt;
}

/// Where selections are not unique, those of the smallest step may be beyond their bounds: there they stay.
bool ElementTrial::hold_beyond(linalg::View local, std::vector<bool>& is_held) const {
  bool are_beyond = false;
  const auto& selection = made_.kernel.layout.selection;
  for (int i = selection.first; i < selection.end(); ++i) {
    const double inside = std::clamp(local[i], 0.0, 1.0);
    if (is_held[at(i)] || std::abs(local[i] - inside) <= allowed_beyond) continue;
    local[i] = inside;
    are_beyond = is_held[at(i)] = true;
  }
  return are_beyond;
}

linalg::Matrix ElementTrial::jacobian(const std::vector<double>& z) const {
  auto& element = made_.kernel.element;
  const auto& pattern = element.jacobian_pattern();
  const int first = element.variables() - made_.kernel.layout.size;
  std::vector<double> entries(at(pattern.entries()));
  element.jacobian(z.data(), made_.local_parameters.data(), entries.data());
  linalg::Matrix jacobian = linalg::Matrix::zero(element.equations(), made_.kernel.layout.size);
  for (int e = 0; e < pattern.entries(); ++e) {
    const int row = pattern.row[at(e)], column = pattern.column[at(e)] - first;
    if (row < element.equations() && column >= 0) jacobian(row, column) += entries[at(e)];
  }
  return jacobian;
}

linalg::Matrix ElementTrial::columns_of_free(const linalg::Matrix& jacobian, const std::vector<bool>& is_held) {
  const auto free = std::count(is_held.begin(), is_held.end(), false);
  linalg::Matrix columns(jacobian.rows(), free);
  linalg::Index next = 0;
  for (linalg::Index i = 0; i < jacobian.cols(); ++i) {
    if (!is_held[at(i)]) columns.col(next++) = jacobian.col(i);
  }
  return columns;
}

bool ElementTrial::solve(std::vector<double>& z, std::size_t first, const std::vector<bool>& is_held) const {
  auto& element = made_.kernel.element;
  linalg::View local(z.data() + first, made_.kernel.layout.size);
  std::vector<double> rows(at(element.equations() + 2 * element.pairs()));
  const linalg::ConstView errors(rows.data(), element.equations());
  double objective = 0.0, least = std::numeric_limits<double>::infinity();
  int vain_steps = 0;
  for (int step = 0; step < largest_steps && vain_steps < most_vain_steps; ++step) {
    element.values(z.data(), made_.local_parameters.data(), &objective, rows.data());
    if (!errors.all_finite()) return false;
    const double error = errors.max_abs();
    vain_steps = error > 0.5 * least ? vain_steps + 1 : 0;
    least = std::min(least, error);
    if (error <= solved && (error <= exact || vain_steps > 0)) return true;
    const linalg::Vector change = linalg::least_squares(columns_of_free(jacobian(z), is_held), errors);
    linalg::Index next = 0;
    for (linalg::Index i = 0; i < local.size(); ++i) {
      if (!is_held[at(i)]) local[i] -= change[next++];
    }
  }
  return false;
}

bool ElementTrial::is_admissible(const linalg::Vector& own, double below) const {
  const auto& layout = made_.kernel.layout;
  const auto selections = own.segment(layout.selection.first - 1, layout.selection.end() - layout.selection.first);
  const auto lambdas = own.segment(layout.lambda.first - 1, layout.lambda.end() - layout.lambda.first);
  if (lambdas.size() > 0 && lambdas.min() < -below) return false;
  return selections.size() == 0 || (selections.min() >= -allowed_beyond && selections.max() <= 1.0 + allowed_beyond);
}

bool ElementTrial::stands_still(const std::vector<double>& left, const linalg::Vector& own) const {
  const int clock = made_.kernel.clock;
  if (clock < 0) return false;
  return right_of(own)[at(clock)] - left[at(clock)] <= vanished * interval_length();
}

double ElementTrial::interval_length() const { return value_at(made_.horizon, w_, made_.constants) / made_.intervals; }

}  // namespace saltus::discretization
