#include <algorithm>
#include <cmath>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/base/contracts.hpp"
#include "saltus/discretization/ocp/ocp_problem_internal.hpp"
#include "saltus/discretization/ocp/stated_modes_internal.hpp"

namespace saltus::discretization {
namespace {

/// How far selections and multipliers of a simulated start are kept from their bounds.
constexpr double interior = 0.1;

/// Writes a guess into the variables, element by element.
class StartWriter {
 public:
  StartWriter(const OcpStructure& made, const OcpGuessValues& guess, linalg::Vector& w)
      : made_(made), kernel_(made.kernel), guess_(guess), w_(w) {}

  void write() {
    set(made_.horizon, guess_.horizon);
    for (std::size_t i = 0; i < made_.parameters.size(); ++i) {
      set(made_.parameters[i], guess_.parameters[at(kernel_.free_parameters[i])]);
    }
    for (std::size_t i = 0; i < made_.start.state.size(); ++i) set(made_.start.state[i], guess_.initial_state[i]);
    for (const int place : made_.start.lambda) set(place, 0.5);
    for (const int place : made_.start.own) set(place, 0.5);
    for (const int place : made_.boundary_own) set(place, 0.5);
    std::size_t row = 0;
    for (std::size_t k = 0; k < made_.interval.size(); ++k) {
      const auto& interval = made_.interval[k];
      for (std::size_t i = 0; i < guess_.controls[k].size(); ++i) set(interval.shared[i], guess_.controls[k][i]);
      set(interval.shared[at(kernel_.shared.controls + kernel_.shared.parameters + kernel_.shared.held + 1)], 1.0);
      for (const int h : interval.lengths) w_[h] = 1.0 / interval.elements;
      for (int n = 0; n < interval.elements; ++n) write_element(interval.first_element + n, row);
    }
    if (guess_.has_modes) {
      const auto psi = [&](std::size_t k, double share, const linalg::Vector& x) {
        const double t = made_.from + guess_.horizon * (static_cast<double>(k) + share) / made_.intervals;
        return indicator(made_.element[at(made_.interval[k].first_element)], t, x);
      };
      StatedModes(made_, guess_, psi, w_).write();
    }
    w_ = w_.at_least(made_.w_bounds.lower).at_most(made_.w_bounds.upper);
  }

 private:
  void set(int place, double value) {
    if (place >= 0) w_[place] = value;
  }
  [[nodiscard]] linalg::ConstView state(std::size_t row) const { return {guess_.states[row].data(), kernel_.states}; }

  void write_element(int number, std::size_t& row) {
    const auto& element = made_.element[at(number)];
    const auto& layout = kernel_.layout;
    const double horizon = guess_.horizon;
    const double h = horizon / made_.intervals / made_.interval[at(element.interval)].elements;
    const double t = made_.from + horizon * element.interval / made_.intervals + element.number * h;
    const std::size_t first = row;
    const bool ends_at_stage = kernel_.tableau.ends_at_last_stage();
    row += static_cast<std::size_t>(layout.stages + (ends_at_stage ? 0 : 1));
    const linalg::Vector left =
        first == 0 ? linalg::ConstView(guess_.initial_state.data(), kernel_.states) : state(first - 1);
    const linalg::Vector end = state(row - 1);
    for (int m = 0; m < layout.stages; ++m) {
      const linalg::Vector x = state(first + at(m));
      const bool integral = kernel_.options.representation == Representation::integral;
      w_.segment(element.variable(layout.stage.at(m)), kernel_.states) =
          integral ? x : linalg::Vector((end - left) / h);
      write_selections(element, m, t + kernel_.tableau.c[m] * h, x);
    }
    if (layout.end_state.count > 0) w_.segment(element.variable(layout.end_state.first), kernel_.states) = end;
    if (layout.end_time.count > 0) w_[element.variable(layout.end_time.first)] = t + h;
    if (layout.has_end_point) write_multipliers(element, layout.points() - 1, t + h, end);
  }

  void write_selections(const OcpElement& element, int m, double t, const linalg::Vector& x) {
    const auto& block = kernel_.layout.selection;
    linalg::Vector selection = linalg::Vector::constant(kernel_.selections, 0.5);
    for (const auto& [first, count] : kernel_.simplex_parts) selection.segment(first, count).set_constant(1.0 / count);
    if (guess_.simulated && kernel_.selections > 0) {
      const linalg::Vector psi = indicator(element, t, x);
      for (const auto& pair : kernel_.pairs) {
        if (!pair.is_region) selection[pair.selection] = psi[pair.selection] > 0.0 ? 1.0 - interior : interior;
      }
      for (const auto& [first, count] : kernel_.simplex_parts) {
        const linalg::Index smallest = psi.segment(first, count).index_of_min();
        selection.segment(first, count).set_constant(interior / count);
        selection[first + smallest] = 1.0 - interior;
      }
    }
    w_.segment(element.variable(block.at(m)), kernel_.selections) = selection;
    write_multipliers(element, m, t, x);
  }

  void write_multipliers(const OcpElement& element, int point, double t, const linalg::Vector& x) {
    const auto& block = kernel_.layout.lambda;
    if (block.size == 0) return;
    linalg::Vector lambda = linalg::Vector::constant(block.size, 0.5);
    if (guess_.simulated) {
      lambda = multipliers_of(kernel_, indicator(element, t, x));
      lambda.add_to_all(interior);
    }
    w_.segment(element.variable(block.at(point)), block.size) = lambda;
  }

  [[nodiscard]] linalg::Vector indicator(const OcpElement& element, double t, const linalg::Vector& x) const {
    std::vector<double> known = guess_.parameters;
    const auto& shared = made_.interval[at(element.interval)].shared;
    for (int i = 0; i < kernel_.shared.held; ++i) {
      known.push_back(
          value_at(shared[at(kernel_.shared.controls + kernel_.shared.parameters + i)], w_, made_.constants));
    }
    const auto& u = guess_.controls[at(element.interval)];
    known.insert(known.end(), u.begin(), u.end());
    const std::vector<double> state(x.data(), x.data() + x.size());
    const std::vector<casadi::DM> in{t, state, known};
    const auto values = casadi::DM::densify(kernel_.indicator(in).front()).nonzeros();
    return linalg::ConstView(values);
  }

  const OcpStructure& made_;
  const OcpKernel::Implementation& kernel_;
  const OcpGuessValues& guess_;
  linalg::Vector& w_;
};

}  // namespace

std::vector<double> OcpProblem::start_fractions() const {
  const auto& made = *implementation_->structure;
  const auto& tableau = made.kernel.tableau;
  std::vector<double> fractions;
  for (const auto& element : made.element) {
    const int count = made.interval[at(element.interval)].elements;
    const double h = 1.0 / made.intervals / count;
    const double left = static_cast<double>(element.interval) / made.intervals + element.number * h;
    for (int m = 0; m < tableau.stages(); ++m) fractions.push_back(std::min(left + tableau.c[m] * h, 1.0));
    if (!tableau.ends_at_last_stage()) fractions.push_back(std::min(left + h, 1.0));
  }
  return fractions;
}

void OcpProblem::set_start(const OcpGuessValues& guess) {
  StartWriter(*implementation_->structure, guess, implementation_->start).write();
}

linalg::Vector OcpProblem::add_start(std::string name, const OcpGuessValues& guess) {
  linalg::Vector w = implementation_->start;
  StartWriter(*implementation_->structure, guess, w).write();
  const bool is_another = (w - implementation_->start).max_abs() != 0.0;
  if (is_another) implementation_->other_starts.push_back({std::move(name), w});
  return w;
}

void OcpProblem::set_start(linalg::Vector w) {
  SALTUS_ASSERT(w.size() == variables());
  implementation_->start = std::move(w);
}

linalg::Vector OcpProblem::start() const { return implementation_->start; }

std::vector<mpcc::NamedStart> OcpProblem::other_starts() const { return implementation_->other_starts; }

}  // namespace saltus::discretization
