#include <cmath>
#include <functional>
#include <limits>

#include "saltus/base/at.hpp"
#include "saltus/discretization/ocp/ocp_kernel_internal.hpp"
#include "saltus/model/time_freezing/time_freezing.hpp"

namespace saltus::discretization {
namespace {

using casadi::SX;
using model::ConstraintNorm;
using model::ConstraintPoints;
using model::CostPoints;
using reformulation::Dcs;

SX rows_of(const SX& column, const std::vector<int>& rows) {
  std::vector<casadi_int> wanted(rows.begin(), rows.end());
  return wanted.empty() ? SX(0, 1) : SX::densify(column(wanted));
}

SX picked(const SX& symbols, const std::vector<int>& indices) {
  SX found(0, 1);
  for (const int i : indices) found = SX::vertcat({found, symbols(i)});
  return found;
}

class OcpExpressionBuilder {
 public:
  OcpExpressionBuilder(const model::Ocp& ocp, const Dcs& dcs, OcpKernel::Implementation& kernel)
      : ocp_(ocp), dcs_(dcs), kernel_(kernel) {}

  Expected<OcpExpressions> run() {
    make_symbols();
    const SharedInputs shared{made_.shared, made_.speed * made_.horizon * inverse_, needs_time()};
    auto element = element_expressions(dcs_, kernel_.tableau, kernel_.options, &shared);
    if (!element) return tl::unexpected(element.error());
    made_.element = std::move(*element);
    outputs_ = casadi::Function("saltus_outputs", {dcs_.t, dcs_.x, dcs_.selection, made_.known}, {dcs_.outputs});
    field_ = casadi::Function("saltus_field", {dcs_.t, dcs_.x, dcs_.selection, made_.known}, {without_lifting()});
    add_running_terms();
    add_stage_rows();
    add_node_terms();
    add_terminal_terms();
    add_measured_terms();
    add_start();
    add_departure();
    return std::move(made_);
  }

 private:
  void make_symbols() {
    const auto& free = kernel_.free_parameters;
    std::vector<int> fixed;
    for (int i = 0; i < static_cast<int>(dcs_.p.numel()); ++i) {
      if (!ocp_.free_parameters[at(i)]) fixed.push_back(i);
    }
    int samples = 0;
    for (const auto& term : ocp_.least_squares) samples += static_cast<int>(term.samples_per_interval());
    made_.known = SX::vertcat({dcs_.p, dcs_.held, dcs_.u});
    made_.horizon = SX::sym("T");
    made_.speed = SX::sym("s");
    made_.samples = SX::sym("samples", samples);
    made_.shared = SX::vertcat({dcs_.u, picked(dcs_.p, free), dcs_.held, made_.horizon, made_.speed, made_.samples});
    made_.parameters = SX::vertcat({picked(dcs_.p, fixed), inverse_});
    kernel_.shared = {static_cast<int>(dcs_.u.numel()), static_cast<int>(free.size()),
                      static_cast<int>(dcs_.held.numel()), samples};
  }

  [[nodiscard]] bool needs_time() const {
    return has_measurements(ocp_) || (dcs_.outputs.numel() > 0 && SX::depends_on(dcs_.outputs, dcs_.t));
  }

  [[nodiscard]] SX without_lifting() const {
    SX f = dcs_.f;
    for (casadi_int k = dcs_.lifted.numel(); k-- > 0;) {
      f = SX::substitute(f, dcs_.lifted(k), -SX::substitute(dcs_.lifting(k), dcs_.lifted(k), 0.0));
    }
    return f;
  }

  [[nodiscard]] SX outputs_at(const ElementPoint& point, const std::vector<int>& rows) const {
    if (rows.empty()) return SX(0, 1);
    return rows_of(outputs_(std::vector<SX>{point.t, point.x, point.selection, made_.known}).front(), rows);
  }
  [[nodiscard]] SX output_at(const ElementPoint& point, int row) const { return outputs_at(point, {row}); }

  /// d physical time / d time of the right-hand side.
  [[nodiscard]] SX clock_rate(const ElementPoint& point) const {
    if (!ocp_.clock) return 1.0;
    return field_(std::vector<SX>{point.t, point.x, point.selection, made_.known}).front()(ocp_.clock->state);
  }

  /// Samples of a term that its interval has.
  [[nodiscard]] SX samples_of(std::size_t number) const {
    casadi_int first = 0;
    for (std::size_t i = 0; i < number; ++i) first += ocp_.least_squares[i].samples_per_interval();
    return made_.samples(casadi::Slice(first, first + ocp_.least_squares[number].samples_per_interval()));
  }

  /// r'W r of a term at a point.
  [[nodiscard]] SX square(const model::OcpLeastSquares& term, const SX& samples, const ElementPoint& point) const {
    SX r = outputs_at(point, term.of);
    if (!term.reference.empty()) r -= outputs_at(point, term.reference);
    if (samples.numel() > 0) r -= samples;
    const auto n = static_cast<casadi_int>(term.of.size());
    SX sum = 0.0;
    for (casadi_int i = 0; i < n; ++i) {
      for (casadi_int j = 0; j < n; ++j) {
        if (term.weight(i, j) != 0.0) sum += term.weight(i, j) * r(i) * r(j);
      }
    }
    return sum;
  }

  /// The squares of all terms of a kind at a point.
  [[nodiscard]] SX squares(CostPoints at, const ElementPoint& point) const {
    SX sum = 0.0;
    for (std::size_t i = 0; i < ocp_.least_squares.size(); ++i) {
      if (ocp_.least_squares[i].at == at) sum += square(ocp_.least_squares[i], samples_of(i), point);
    }
    return sum;
  }

  void add_running_terms() {
    const auto slacks = static_cast<casadi_int>(ocp_.stage_slacks.size());
    const SX slack = SX::sym("kink", slacks, kernel_.tableau.stages());
    made_.running_inputs = SX::vertcat({made_.element.element_inputs, SX::vec(slack)});
    const casadi_int first_control = made_.known.numel() - dcs_.u.numel();
    for (int m = 0; m < kernel_.tableau.stages(); ++m) {
      const ElementPoint& point = made_.element.stages[at(m)];
      const SX weight = made_.element.h * kernel_.tableau.b[m] * clock_rate(point);
      SX known = made_.known;
      for (casadi_int i = 0; i < slacks; ++i) known(first_control + ocp_.stage_slacks[at(i)]) = slack(i, m);
      const auto value = [&](int row) {
        return outputs_(std::vector<SX>{point.t, point.x, point.selection, known}).front()(row);
      };
      if (ocp_.running_cost) made_.running.objective += weight * value(*ocp_.running_cost);
      for (std::size_t i = 0; i < ocp_.path.size(); ++i) {
        if (!ocp_.path[i].at_stages) continue;
        made_.running.equation(SX::densify(value(ocp_.path[i].output)));
        kernel_.running_bounds.push_back({static_cast<int>(i), ocp_.path[i].lower, ocp_.path[i].upper, -1});
      }
      made_.stage_squares.objective += weight * squares(CostPoints::stages, point);
    }
  }

  /// The collocation polynomial at tau h behind the left end; selections by that of the stages.
  [[nodiscard]] ElementPoint between_stages(const SX& t, const SX& tau) const {
    const auto& tableau = kernel_.tableau;
    const int stages = tableau.stages();
    const bool begins_at_stage = tableau.c[0] == 0.0;
    const auto lagrange = [&](int m, bool with_left) {
      SX weight = with_left ? tau / tableau.c[m] : SX(1.0);
      for (int l = 0; l < stages; ++l) {
        if (l != m) weight *= (tau - tableau.c[l]) / (tableau.c[m] - tableau.c[l]);
      }
      return weight;
    };
    ElementPoint point{t, SX::zeros(dcs_.x.numel()), SX::zeros(dcs_.selection.numel())};
    SX of_left = 1.0;
    for (int m = 0; m < stages; ++m) {
      const ElementPoint& stage = made_.element.stages[at(m)];
      point.x += lagrange(m, !begins_at_stage) * stage.x;
      point.selection += lagrange(m, false) * stage.selection;
      if (!begins_at_stage) of_left *= (tableau.c[m] - tau) / tableau.c[m];
    }
    if (!begins_at_stage) point.x += of_left * made_.element.left.x;
    return point;
  }

  /// Squares at a time of measurements; the element counts where it holds it.
  void add_measured_terms() {
    const SX t = SX::sym("t_measured");
    made_.measured_inputs = SX::vertcat({made_.element.element_inputs, t});
    if (!has_measurements(ocp_)) return;
    for (const auto& term : ocp_.least_squares) {
      if (term.at != CostPoints::times) continue;
      const SX holds = SX::sym("holds");
      const SX samples = SX::sym("samples", term.samples.cols());
      made_.measured_inputs = SX::vertcat({made_.measured_inputs, holds, samples});
      // 0 in other elements, which may have no length.
      const SX tau = holds * (t - made_.element.left.t) / (made_.element.h + 1.0 - holds);
      made_.measured_squares.objective += holds * square(term, samples, between_stages(t, tau));
    }
  }

  /// Rows of constraints at a point; soft ones with their slacks, number first_soft and on of `soft`.
  void add_rows(const std::vector<model::OcpConstraint>& constraints, const ElementPoint& point, const SX& soft,
                int first_soft, LocalExpressions& expressions, std::vector<ConstraintRow>& rows,
                const std::function<bool(const model::OcpConstraint&)>& applies) const {
    int next_soft = first_soft;
    for (std::size_t i = 0; i < constraints.size(); ++i) {
      const auto& constraint = constraints[i];
      if (constraint.is_slack) continue;
      if (!applies(constraint)) {
        next_soft += constraint.norm != ConstraintNorm::hard ? 1 : 0;
        continue;
      }
      const SX y = output_at(point, constraint.output);
      if (constraint.norm == ConstraintNorm::hard) {
        expressions.equation(y);
        rows.push_back({static_cast<int>(i), constraint.lower, constraint.upper, -1});
        continue;
      }
      const SX v = soft(next_soft);
      if (std::isfinite(constraint.upper)) {
        expressions.equation(y - v);
        rows.push_back({static_cast<int>(i), -inf, constraint.upper, next_soft});
      }
      if (std::isfinite(constraint.lower)) {
        expressions.equation(y + v);
        rows.push_back({static_cast<int>(i), constraint.lower, inf, next_soft});
      }
      ++next_soft;
    }
  }

  static bool everywhere(const model::OcpConstraint& /*constraint*/) { return true; }

  [[nodiscard]] static int soft_count(const std::vector<model::OcpConstraint>& constraints) {
    int count = 0;
    for (const auto& constraint : constraints) count += constraint.norm != ConstraintNorm::hard ? 1 : 0;
    return count;
  }

  /// Between the ends of elements: path constraints, bounds of states that are no variables, complementarities; at the
  /// ends, too: gaps.
  void add_stage_rows() {
    const int stages = kernel_.tableau.stages();
    const bool ends_at_stage = kernel_.tableau.ends_at_last_stage();
    const bool with_constraints = ocp_.path_at == ConstraintPoints::stages;
    kernel_.soft_per_point = soft_count(ocp_.path);
    const SX soft = SX::sym("soft", with_constraints ? stages * kernel_.soft_per_point : 0);
    made_.stage_inputs = SX::vertcat({made_.element.element_inputs, soft});
    for (int m = 0; m < stages; ++m) {
      const ElementPoint& point = made_.element.stages[at(m)];
      const bool at_end = m == stages - 1 && ends_at_stage;
      if (with_constraints && !at_end) {
        add_rows(ocp_.path, point, soft, m * kernel_.soft_per_point, made_.stage_rows, kernel_.stage_bounds,
                 everywhere);
      }
      if (kernel_.options.representation == Representation::differential && !at_end) add_bound_rows(point);
      for (const auto& [first, second] : ocp_.complementarities) {
        made_.stage_rows.G.push_back(output_at(point, first));
        made_.stage_rows.H.push_back(output_at(point, second));
        made_.stage_rows.G_signs.push_back(mpcc::Sign::constrained);
        made_.stage_rows.H_signs.push_back(mpcc::Sign::constrained);
      }
      add_gap_rows(point);
    }
    if (!ends_at_stage) add_gap_rows(made_.element.end);
  }

  /// Persistent contact is held by velocities, so that gaps drift, which an optimiser exploits.
  void add_gap_rows(const ElementPoint& point) {
    const auto* freezing = ocp_.system.freezing ? &*ocp_.system.freezing : nullptr;
    if (freezing == nullptr || !std::isfinite(freezing->penetration)) return;
    int number = static_cast<int>(ocp_.path.size());
    for (const auto& contact : freezing->contacts) {
      made_.stage_rows.equation(output_at(point, contact.gap_output));
      kernel_.stage_bounds.push_back({number++, -freezing->penetration, inf, -1});
    }
  }

  void add_bound_rows(const ElementPoint& point) {
    for (int i = 0; i < static_cast<int>(dcs_.x.numel()); ++i) {
      const double lower = ocp_.system.state_lower[at(i)];
      const double upper = ocp_.system.state_upper[at(i)];
      if (!std::isfinite(lower) && !std::isfinite(upper)) continue;
      made_.stage_rows.equation(point.x(i));
      kernel_.stage_bounds.push_back({-1 - i, lower, upper, -1});
    }
  }

  /// At a node, whose time, state and selections are inputs of their own.
  void add_node_terms() {
    node_ = {SX::sym("t_node"), SX::sym("x_node", dcs_.x.numel()), SX::sym("a_node", dcs_.selection.numel())};
    made_.node_inputs = SX::vertcat({node_.t, node_.x, node_.selection, made_.shared});
    made_.node_squares.objective = made_.horizon * inverse_ * squares(CostPoints::intervals, node_);
    const SX soft = SX::sym("soft", kernel_.soft_per_point);
    made_.node_row_inputs = SX::vertcat({made_.node_inputs, soft});
    add_rows(ocp_.path, node_, soft, 0, made_.node_rows, kernel_.node_bounds, everywhere);
    const bool start_is_free = free_states().size() + kernel_.free_parameters.size() > 0;
    const auto at_start = [&](const model::OcpConstraint& constraint) {
      return start_is_free || SX::depends_on(dcs_.outputs(constraint.output), dcs_.u);
    };
    add_rows(ocp_.path, node_, soft, 0, made_.first_rows, kernel_.first_bounds, at_start);
    made_.slack_inputs = made_.node_inputs;
    for (std::size_t i = 0; i < ocp_.path.size(); ++i) {
      if (!ocp_.path[i].is_slack || ocp_.path[i].at_stages) continue;
      made_.slack_rows.equation(output_at(node_, ocp_.path[i].output));
      kernel_.slack_bounds.push_back({static_cast<int>(i), ocp_.path[i].lower, ocp_.path[i].upper, -1});
    }
  }

  void add_terminal_terms() {
    if (ocp_.terminal_cost) made_.terminal.objective = output_at(node_, *ocp_.terminal_cost);
    made_.end_squares.objective = squares(CostPoints::end, node_);
    kernel_.soft_at_end = soft_count(ocp_.terminal);
    const SX soft = SX::sym("soft", kernel_.soft_at_end);
    made_.terminal_row_inputs = SX::vertcat({made_.node_inputs, soft});
    add_rows(ocp_.terminal, node_, soft, 0, made_.terminal_rows, kernel_.terminal_bounds, everywhere);
  }

  /// lambda_(0,0) of a start that is not fixed: psi = lambda_p - lambda_n, lambda_n _|_ lambda_p; in Stewart's form
  /// g - lambda + mu e = 0, e'theta = 1, theta _|_ lambda.
  void add_start() {
    const SX free = SX::vertcat({picked(dcs_.x, free_states()), picked(dcs_.p, kernel_.free_parameters)});
    for (casadi_int i = 0; i < dcs_.indicator.numel(); ++i) {
      const bool constant = free.numel() == 0 || !SX::depends_on(dcs_.indicator(i), free);
      kernel_.start_is_constant.push_back(constant);
      kernel_.has_start_pairs = kernel_.has_start_pairs || !constant;
    }
    for (const auto& part : dcs_.parts) {  // a simplex as a whole
      if (part.form != reformulation::Form::stewart) continue;
      bool constant = true;
      for (int i = 0; i < part.count; ++i) constant = constant && kernel_.start_is_constant[at(part.first + i)];
      for (int i = 0; i < part.count; ++i) kernel_.start_is_constant[at(part.first + i)] = constant;
    }
    const SX lambda = SX::sym("lambda_start", static_cast<casadi_int>(kernel_.pairs.size()));
    const SX mu = SX::sym("mu_start", kernel_.simplices);
    const SX theta = SX::sym("theta_start", dcs_.selection.numel());
    const SX x = SX::sym("x_start", dcs_.x.numel());
    const SX t = SX::sym("t_start");
    made_.start_inputs = SX::vertcat({t, x, made_.shared, lambda, mu, theta});
    const SX indicator = casadi::Function("saltus_start", {dcs_.t, dcs_.x, made_.known},
                                          {dcs_.indicator})(std::vector<SX>{t, x, made_.known})
                             .front();
    int next = 0;
    int simplex = 0;
    for (const auto& part : dcs_.parts) {
      const bool stewart = part.form == reformulation::Form::stewart;
      SX sum = -1.0;
      for (int i = part.first; i < part.first + part.count; ++i) {
        const bool constant = kernel_.start_is_constant[at(i)];
        if (!constant && stewart) {
          made_.start.equation(indicator(i) - lambda(next) + mu(simplex));
          made_.start.pair(theta(i), lambda(next));
        } else if (!constant) {
          made_.start.equation(indicator(i) + lambda(next) - lambda(next + 1));
          made_.start.pair(lambda(next), lambda(next + 1));
        }
        sum += theta(i);
        next += stewart ? 1 : 2;
      }
      if (stewart && part.count > 0 && !kernel_.start_is_constant[at(part.first)]) made_.start.equation(sum);
      simplex += stewart ? 1 : 0;
    }
  }

  /// d psi / dt along the field of an element at its left end, where a selection ends to slide: 0, so that it leaves
  /// its surface tangentially. Of regions d(g_i - theta'g) / dt. Selections there by the polynomial of the stages.
  /// Where the right end is a stage, branches fix a selection there instead.
  void add_departure() {
    if (!kernel_.moves || dcs_.selection.numel() == 0 || !made_.element.layout.has_end_point) return;
    const auto& tableau = kernel_.tableau;
    SX selection = SX::zeros(dcs_.selection.numel());
    for (int m = 0; m < tableau.stages(); ++m) {
      double weight = 1.0;
      for (int l = 0; l < tableau.stages(); ++l) {
        if (l != m) weight *= -tableau.c[l] / (tableau.c[m] - tableau.c[l]);
      }
      selection += weight * made_.element.stages[at(m)].selection;
    }
    const ElementPoint left{made_.element.left.t, made_.element.left.x, selection};
    const SX f = field_(std::vector<SX>{left.t, left.x, left.selection, made_.known}).front();
    const casadi::Function slopes("saltus_slopes", {dcs_.t, dcs_.x, made_.known},
                                  {SX::jacobian(dcs_.indicator, dcs_.x), SX::jacobian(dcs_.indicator, dcs_.t)});
    const std::vector<SX> at_left = slopes(std::vector<SX>{left.t, left.x, made_.known});
    SX rates = SX::mtimes(at_left[0], f) + at_left[1];
    for (const auto& part : dcs_.parts) {
      if (part.form != reformulation::Form::stewart) continue;
      const casadi::Slice range(part.first, part.first + part.count);
      rates(range) -= SX::dot(selection(range), rates(range));
    }
    made_.departure.equation(SX::densify(rates));
  }

  [[nodiscard]] std::vector<int> free_states() const {
    std::vector<int> free;
    for (std::size_t i = 0; i < ocp_.free_states.size(); ++i) {
      if (ocp_.free_states[i]) free.push_back(static_cast<int>(i));
    }
    return free;
  }

  static constexpr double inf = std::numeric_limits<double>::infinity();
  const model::Ocp& ocp_;
  const Dcs& dcs_;
  OcpKernel::Implementation& kernel_;
  SX inverse_ = SX::sym("inverse_intervals");
  casadi::Function outputs_, field_;
  ElementPoint node_;
  OcpExpressions made_;
};

}  // namespace

Expected<OcpExpressions> ocp_expressions(const model::Ocp& ocp, const Dcs& dcs, OcpKernel::Implementation& kernel) {
  return OcpExpressionBuilder(ocp, dcs, kernel).run();
}

}  // namespace saltus::discretization
