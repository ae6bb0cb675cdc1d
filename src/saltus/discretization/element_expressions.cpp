#include <string>
#include <utility>

#include <casadi/core/function.hpp>

#include "saltus/base/at.hpp"
#include "saltus/discretization/dcs_expressions_internal.hpp"
#include "saltus/discretization/element_expressions_internal.hpp"
#include "saltus/linalg/factors.hpp"

namespace saltus::discretization {
namespace {

using casadi::SX;
using reformulation::Dcs;
using reformulation::Form;

/// f, the indicators and the lifting at one point; in a simulation with controls replaced by their inputs.
casadi::Function point_function(const Dcs& dcs, const SX& known, const SharedInputs* shared) {
  std::vector<SX> out{dcs.f, dcs.indicator, dcs.lifting};
  if (dcs.u.numel() > 0 && shared == nullptr)
    out = SX::substitute(out, std::vector<SX>{dcs.u}, std::vector<SX>{SX::densify(dcs.input)});
  return casadi::Function("saltus_point", {dcs.t, dcs.x, dcs.selection, dcs.lifted, known}, out);
}

ElementVariables element_variables(const ElementLayout& layout, const SX& v) {
  const auto matrix = [&v](const VariableBlock& block) {
    return SX::reshape(v(casadi::Slice(block.first, block.end())), block.size, block.count);
  };
  return {v(layout.h),
          matrix(layout.stage),
          matrix(layout.selection),
          matrix(layout.lifted),
          matrix(layout.lambda),
          matrix(layout.simplex),
          matrix(layout.end_state),
          matrix(layout.end_time),
          matrix(layout.correction)};
}

struct PointValues {
  SX f, indicator, lifting;
};

class ElementBuilder {
 public:
  ElementBuilder(const Dcs& dcs, const ButcherTableau& tableau, const FesdOptions& options, const SharedInputs* shared)
      : dcs_(dcs),
        tableau_(tableau),
        options_(options),
        shared_(shared),
        known_(shared == nullptr ? SX::vertcat({dcs.p, dcs.held}) : SX::vertcat({dcs.p, dcs.held, dcs.u})) {
    point_ = point_function(dcs, known_, shared);
    result_.pairs = selection_pairs(dcs);
    result_.depends_on_time = SX::depends_on(SX::vertcat({call(dcs.t, dcs.x, dcs.selection, dcs.lifted).f,
                                                          call(dcs.t, dcs.x, dcs.selection, dcs.lifted).indicator}),
                                             dcs.t) ||
                              (shared != nullptr && shared->needs_time);
    for (const auto& part : dcs.parts) {
      if (part.form == Form::stewart) ++simplices_;
    }
    result_.parameters = SX::vertcat({known_, mean_h_});
    find_layout();
  }

  ElementExpressions build() {
    const int n_lambda = static_cast<int>(result_.pairs.size());
    left_x_ = SX::sym("x_left", dcs_.x.numel());
    left_t_ = SX::sym("t_left", result_.depends_on_time ? 1 : 0);
    const SX left_lambda = SX::sym("lambda_left", n_lambda);
    const SX v = SX::sym("v", result_.layout.size);
    variables_ = element_variables(result_.layout, v);
    h_ = shared_ == nullptr ? variables_.h : shared_->length_factor * variables_.h;
    const SX shared = shared_ == nullptr ? SX(0, 1) : shared_->symbols;
    result_.element_inputs = SX::vertcat({left_x_, left_t_, left_lambda, shared, v});
    add_runge_kutta_equations();
    add_algebraic_equations();
    const ElementPairs pairs = element_pairs(result_.pairs, variables_, left_lambda);
    add_cross_complementarities(options_.cross_complementarity, pairs, result_.element);
    add_correction_complementarities(pairs);
    if (options_.step_equilibration == StepEquilibration::heuristic_mean && moves() && shared_ == nullptr) {
      result_.element.objective = options_.rho_h * SX::sq(variables_.h - mean_h_);
    }
    take_points();
    build_boundary(left_lambda, v);
    return std::move(result_);
  }

 private:
  [[nodiscard]] int stages() const { return tableau_.stages(); }
  [[nodiscard]] bool is_integral() const { return options_.representation == Representation::integral; }
  [[nodiscard]] bool ends_at_stage() const { return tableau_.ends_at_last_stage(); }
  [[nodiscard]] bool moves() const { return options_.cross_complementarity != CrossComplementarity::same_stage; }
  /// On curved surfaces the end of a collocation step with c_ns != 1 leaves them. The stages of an explicit method set
  /// its end on the surface by themselves (half-explicit).
  [[nodiscard]] bool corrects() const {
    if (ends_at_stage() || !tableau_.is_collocation() || !moves()) return false;
    const SX indicator = call(dcs_.t, dcs_.x, dcs_.selection, dcs_.lifted).indicator;
    return !SX::is_linear(indicator, SX::vertcat({dcs_.t, dcs_.x}));
  }

  [[nodiscard]] PointValues call(const SX& t, const SX& x, const SX& selection, const SX& lifted) const {
    const std::vector<SX> values = point_(std::vector<SX>{t, x, selection, lifted, known_});
    return {values[0], values[1], values[2]};
  }

  void find_layout() {
    auto& layout = result_.layout;
    layout.stages = stages();
    // Without cross complementarities nothing tells lambda_n and lambda_p of an end apart that is no stage.
    layout.has_end_point = !ends_at_stage() && moves();
    const auto n_x = static_cast<int>(dcs_.x.numel());
    const auto n_selections = static_cast<int>(dcs_.selection.numel());
    int next = 1;
    const auto block = [&next](int count, int size) {
      const VariableBlock made{next, count, size};
      next = made.end();
      return made;
    };
    layout.stage = block(stages(), n_x);
    layout.selection = block(stages(), n_selections);
    layout.lifted = block(stages(), static_cast<int>(dcs_.lifted.numel()));
    layout.lambda = block(layout.points(), static_cast<int>(result_.pairs.size()));
    layout.simplex = block(layout.points(), simplices_);
    layout.end_state = block(ends_at_stage() && is_integral() ? 0 : 1, n_x);
    layout.end_time = block(result_.depends_on_time ? 1 : 0, 1);
    layout.correction = block(corrects() ? 2 : 0, n_selections);
    layout.size = next;
  }

  [[nodiscard]] SX stage_time(int m) const { return result_.depends_on_time ? left_t_ + tableau_.c[m] * h_ : SX(0.0); }
  [[nodiscard]] SX column(const SX& matrix, int m) const { return matrix(casadi::Slice(), m); }

  void add_runge_kutta_equations() {
    const bool invertible = linalg::FullLu(tableau_.A).is_invertible();
    const linalg::Matrix inverse = invertible ? linalg::inverse(tableau_.A) : linalg::Matrix();
    const SX& h = h_;
    std::vector<SX> increments;  // x_m - x_left
    std::vector<SX> slopes;
    for (int m = 0; m < stages(); ++m) {
      SX increment = is_integral() ? column(variables_.stage, m) - left_x_ : SX::zeros(dcs_.x.numel());
      if (!is_integral()) {
        for (int j = 0; j < stages(); ++j) increment += h * tableau_.A(m, j) * column(variables_.stage, j);
      }
      const SX x = is_integral() ? column(variables_.stage, m) : left_x_ + increment;
      result_.stages.push_back({stage_time(m), x, column(variables_.selection, m)});
      at_stages_.push_back(call(stage_time(m), x, column(variables_.selection, m), column(variables_.lifted, m)));
      increments.push_back(increment);
      slopes.push_back(is_integral() ? at_stages_.back().f : column(variables_.stage, m));
    }
    for (int m = 0; m < stages(); ++m) {
      const SX& f = at_stages_[at(m)].f;
      if (!is_integral()) {
        result_.element.equation(column(variables_.stage, m) - f);
      } else if (invertible) {
        // Collocation: A^-1 (X - x_left) = h F, each row with the model of one stage only.
        result_.element.equation(combination(inverse.row(m), increments) - h * f);
      } else {
        result_.element.equation(increments[at(m)] - h * combination(tableau_.A.row(m), slopes));
      }
    }
    if (result_.layout.end_state.count > 0) {
      SX end = left_x_;
      if (is_integral() && invertible) {
        end += combination(tableau_.b.transpose() * inverse, increments);
      } else {
        end += h * combination(tableau_.b, slopes);
      }
      result_.element.equation(variables_.end_state - end - correction());
    }
    if (result_.depends_on_time) result_.element.equation(variables_.end_time - left_t_ - h_);
  }

  [[nodiscard]] SX combination(linalg::ConstView weights, const std::vector<SX>& terms) const {
    SX sum = SX::zeros(dcs_.x.numel());
    for (int j = 0; j < stages(); ++j) sum += weights[j] * terms[at(j)];
    return sum;
  }

  /// f_alpha mu of the projection of index-2 equations onto their constraints ([hairer1996], section VII.4).
  [[nodiscard]] SX correction() const {
    if (result_.layout.correction.count == 0) return SX::zeros(dcs_.x.numel());
    const SX f = without_lifting(dcs_, call(dcs_.t, dcs_.x, dcs_.selection, dcs_.lifted).f);
    const SX directions = SX::substitute(
        std::vector<SX>{SX::jacobian(f, dcs_.selection)}, std::vector<SX>{dcs_.t, dcs_.x, dcs_.selection},
        std::vector<SX>{result_.depends_on_time ? variables_.end_time : SX(0.0), variables_.end_state,
                        column(variables_.selection, stages() - 1)})[0];
    return SX::mtimes(directions, column(variables_.correction, 0) - column(variables_.correction, 1));
  }

  /// Indicators and multipliers at all points; weights of regions sum up to 1; lifted variables are their products.
  void add_algebraic_equations() {
    for (int point = 0; point < result_.layout.points(); ++point) {
      const bool is_stage = point < stages();
      const SX indicator = is_stage
                               ? at_stages_[at(point)].indicator
                               : call(result_.depends_on_time ? variables_.end_time : SX(0.0), variables_.end_state,
                                      SX::zeros(dcs_.selection.numel()), SX::zeros(dcs_.lifted.numel()))
                                     .indicator;
      int lambda = 0;
      int simplex = 0;
      for (const auto& part : dcs_.parts) {
        for (int i = part.first; i < part.first + part.count; ++i) {
          if (part.form == Form::step) {  // psi = lambda_p - lambda_n
            result_.element.equation(indicator(i) + variables_.lambda(lambda, point) -
                                     variables_.lambda(lambda + 1, point));
            lambda += 2;
          } else {  // g - lambda + mu = 0
            result_.element.equation(indicator(i) - variables_.lambda(lambda++, point) +
                                     variables_.simplex(simplex, point));
          }
        }
        if (part.form == Form::stewart) {
          if (is_stage) {
            result_.element.equation(
                SX::sum1(variables_.selection(casadi::Slice(part.first, part.first + part.count), point)) - 1.0);
          }
          ++simplex;
        }
      }
      if (is_stage) result_.element.equation(at_stages_[at(point)].lifting);
    }
  }

  /// The end is corrected only along selections that slide, all of whose multipliers are zero in the element.
  void add_correction_complementarities(const ElementPairs& pairs) {
    if (result_.layout.correction.count == 0) return;
    const SX sums = SX::sum2(pairs.lambda);
    SX of_selection = SX::zeros(dcs_.selection.numel());
    for (std::size_t k = 0; k < result_.pairs.size(); ++k) {
      of_selection(result_.pairs[k].selection) += sums(static_cast<casadi_int>(k));
    }
    for (casadi_int i = 0; i < dcs_.selection.numel(); ++i) {
      const SX plus = variables_.correction(i, 0);
      const SX minus = variables_.correction(i, 1);
      result_.element.pair(plus + minus, of_selection(i));
      result_.element.pair(plus, minus);
    }
    for (const auto& part : dcs_.parts) {  // weights stay in their simplex
      if (part.form != Form::stewart) continue;
      const casadi::Slice range(part.first, part.first + part.count);
      result_.element.equation(SX::sum1(variables_.correction(range, 0) - variables_.correction(range, 1)));
    }
  }

  void take_points() {
    result_.h = h_;
    result_.left = {result_.depends_on_time ? left_t_ : SX(0.0), left_x_, SX(0, 1)};
    result_.end = {result_.depends_on_time ? variables_.end_time : SX(0.0),
                   result_.layout.end_state.count > 0 ? variables_.end_state : column(variables_.stage, stages() - 1),
                   column(variables_.selection, stages() - 1)};
  }

  void build_boundary(const SX& left_lambda, const SX& v) {
    const SX after = SX::sym("v_after", result_.layout.size);
    const ElementVariables next = element_variables(result_.layout, after);
    const int n_pairs = static_cast<int>(result_.pairs.size());
    if (moves()) result_.boundary_own_bounds = boundary_bounds(options_.step_equilibration, n_pairs);
    const SX own = SX::sym("boundary", result_.boundary_own_bounds.lower.size());
    const SX at_boundary = column(variables_.lambda, result_.layout.points() - 1);
    const Boundary boundary{element_pairs(result_.pairs, variables_, left_lambda),
                            element_pairs(result_.pairs, next, at_boundary), variables_.h, next.h, own};
    result_.boundary_inputs = SX::vertcat({left_lambda, v, after, own});
    if (!moves()) return;
    if (options_.cross_complementarity == CrossComplementarity::paper) {
      add_paper_cross_complementarity(boundary, result_.neighbours);
    }
    add_step_equilibration(options_, result_.pairs, boundary, result_.boundary);
  }

  const Dcs& dcs_;
  const ButcherTableau& tableau_;
  const FesdOptions& options_;
  const SharedInputs* shared_;  ///< null in a simulation
  SX known_;
  SX h_;
  SX mean_h_ = SX::sym("mean_h");
  casadi::Function point_;
  int simplices_ = 0;
  SX left_x_, left_t_;
  ElementVariables variables_;
  std::vector<PointValues> at_stages_;
  ElementExpressions result_;
};

}  // namespace

std::vector<SelectionPair> selection_pairs(const Dcs& dcs) {
  std::vector<SelectionPair> pairs;
  for (const auto& part : dcs.parts) {
    for (int i = part.first; i < part.first + part.count; ++i) {
      pairs.push_back({i, false, part.form == Form::stewart});
      if (part.form == Form::step) pairs.push_back({i, true, false});
    }
  }
  return pairs;
}

Expected<ElementExpressions> element_expressions(const Dcs& dcs, const ButcherTableau& tableau,
                                                 const FesdOptions& options, const SharedInputs* shared) {
  if (tableau.family == TableauFamily::lobatto_iiia && dcs.selection.numel() > 0) {
    Error error;
    error.code = ErrorCode::not_available;
    error.message =
        "Lobatto IIIA as a problem with complementarities: while the state slides, the selections of its first stage "
        "are in no equation";
    error.remedy = "use radau_iia, gauss_legendre or lobatto_iiic";
    return tl::unexpected(std::move(error));
  }
  return ElementBuilder(dcs, tableau, options, shared).build();
}

}  // namespace saltus::discretization
