#include <algorithm>
#include <cmath>

#include "saltus/base/at.hpp"
#include "saltus/base/contracts.hpp"
#include "saltus/discretization/ocp/ocp_problem_internal.hpp"

namespace saltus::discretization {
namespace {

/// How far selections and multipliers of a simulated start are kept from their bounds.
constexpr double interior = 0.1;

/// Writes a guess into the variables, element by element.
class StartWriter {
 public:
  StartWriter(const OcpStructure& made, const OcpGuessValues& guess, Eigen::VectorXd& w)
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
    w_ = w_.cwiseMax(made_.w_bounds.lower).cwiseMin(made_.w_bounds.upper);
  }

 private:
  void set(int place, double value) {
    if (place >= 0) w_[place] = value;
  }
  [[nodiscard]] Eigen::Map<const Eigen::VectorXd> state(std::size_t row) const {
    return {guess_.states[row].data(), kernel_.states};
  }

  void write_element(int number, std::size_t& row) {
    const auto& element = made_.element[at(number)];
    const auto& layout = kernel_.layout;
    const double horizon = guess_.horizon;
    const double h = horizon / made_.intervals / made_.interval[at(element.interval)].elements;
    const double t = made_.from + horizon * element.interval / made_.intervals + element.number * h;
    const std::size_t first = row;
    const bool ends_at_stage = kernel_.tableau.ends_at_last_stage();
    row += static_cast<std::size_t>(layout.stages + (ends_at_stage ? 0 : 1));
    const Eigen::VectorXd left = first == 0
                                     ? Eigen::Map<const Eigen::VectorXd>(guess_.initial_state.data(), kernel_.states)
                                     : Eigen::VectorXd(state(first - 1));
    const Eigen::VectorXd end = state(row - 1);
    for (int m = 0; m < layout.stages; ++m) {
      const Eigen::VectorXd x = state(first + at(m));
      const bool integral = kernel_.options.representation == Representation::integral;
      w_.segment(element.variable(layout.stage.at(m)), kernel_.states) =
          integral ? x : Eigen::VectorXd((end - left) / h);
      write_selections(element, m, t + kernel_.tableau.c[m] * h, x);
    }
    if (layout.end_state.count > 0) w_.segment(element.variable(layout.end_state.first), kernel_.states) = end;
    if (layout.end_time.count > 0) w_[element.variable(layout.end_time.first)] = t + h;
    if (layout.has_end_point) write_multipliers(element, layout.points() - 1, t + h, end);
  }

  void write_selections(const OcpElement& element, int m, double t, const Eigen::VectorXd& x) {
    const auto& block = kernel_.layout.selection;
    Eigen::VectorXd selection = Eigen::VectorXd::Constant(kernel_.selections, 0.5);
    for (const auto& [first, count] : kernel_.simplex_parts) selection.segment(first, count).setConstant(1.0 / count);
    if (guess_.simulated && kernel_.selections > 0) {
      const Eigen::VectorXd psi = indicator(element, t, x);
      for (const auto& pair : kernel_.pairs) {
        if (!pair.is_region) selection[pair.selection] = psi[pair.selection] > 0.0 ? 1.0 - interior : interior;
      }
      for (const auto& [first, count] : kernel_.simplex_parts) {
        Eigen::Index smallest = 0;
        psi.segment(first, count).minCoeff(&smallest);
        selection.segment(first, count).setConstant(interior / count);
        selection[first + smallest] = 1.0 - interior;
      }
    }
    w_.segment(element.variable(block.at(m)), kernel_.selections) = selection;
    write_multipliers(element, m, t, x);
  }

  void write_multipliers(const OcpElement& element, int point, double t, const Eigen::VectorXd& x) {
    const auto& block = kernel_.layout.lambda;
    if (block.size == 0) return;
    Eigen::VectorXd lambda = Eigen::VectorXd::Constant(block.size, 0.5);
    if (guess_.simulated) {
      Eigen::VectorXd psi = indicator(element, t, x);
      for (const auto& [first, count] : kernel_.simplex_parts) {
        psi.segment(first, count).array() -= psi.segment(first, count).minCoeff();
      }
      for (std::size_t k = 0; k < kernel_.pairs.size(); ++k) {
        const auto& pair = kernel_.pairs[k];
        const double value = psi[pair.selection];
        lambda[static_cast<Eigen::Index>(k)] =
            std::max(!pair.is_region && !pair.complement ? -value : value, 0.0) + interior;
      }
    }
    w_.segment(element.variable(block.at(point)), block.size) = lambda;
  }

  [[nodiscard]] Eigen::VectorXd indicator(const OcpElement& element, double t, const Eigen::VectorXd& x) const {
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
    return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
  }

  const OcpStructure& made_;
  const OcpKernel::Implementation& kernel_;
  const OcpGuessValues& guess_;
  Eigen::VectorXd& w_;
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

void OcpProblem::set_start(Eigen::VectorXd w) {
  SALTUS_ASSERT(w.size() == variables());
  implementation_->start = std::move(w);
}

Eigen::VectorXd OcpProblem::start() const { return implementation_->start; }

}  // namespace saltus::discretization
