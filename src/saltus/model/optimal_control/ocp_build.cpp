#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/expression/parser.hpp"
#include "saltus/model/optimal_control/initial_values_internal.hpp"
#include "saltus/model/optimal_control/ocp_checks_internal.hpp"
#include "saltus/model/optimal_control/ocp_quantities_internal.hpp"
#include "saltus/model/optimal_control/with_slacks_internal.hpp"
#include "saltus/model/time_freezing/time_freezing.hpp"

namespace saltus::model {
namespace {

using expression::NodePtr;
constexpr double unbounded = std::numeric_limits<double>::infinity();

NodePtr subtracted(const NodePtr& left, const NodePtr& right) {
  auto node = std::make_shared<expression::Node>();
  node->value = expression::Binary{expression::BinaryOperator::subtract, left, right};
  node->location = left->location;
  return node;
}

/// A constraint before its numbers are known: quantities of its bounds, -1 for none.
struct PlannedConstraint {
  const ConstraintDescription* stated = nullptr;
  std::vector<int> middles{};  ///< all of them are bounded
  int lower = -1, upper = -1;
  bool at_zero_lower = false, at_zero_upper = false;  ///< instead: 0
  int penalty = -1;
};

/// From trees to quantities, then, with the system built, from quantities to the problem.
class OcpBuild {
 public:
  OcpBuild(const Description& description, const std::vector<Override>& overrides)
      : initials_(description, overrides),
        stated_(*initials_.description().optimize),
        slacks_(initials_.description()),
        overrides_(initials_.overrides()),
        quantities_(slacks_.description()),
        guessed_(slacks_.description()) {}

  [[nodiscard]] Expected<Ocp> run() {
    if (initials_.error()) return tl::unexpected(*initials_.error());
    if (auto error = plan()) return tl::unexpected(*error);
    auto system = quantities_.build(overrides_);
    if (!system) return tl::unexpected(system.error());
    ocp_.system = std::move(*system);
    ocp_.user_outputs = quantities_.user_outputs();
    ocp_.problem_outputs = quantities_.count();
    ocp_.user_controls = slacks_.user_controls();
    ocp_.stage_slacks = slacks_.stage_slacks();
    using Step = std::optional<Error> (OcpBuild::*)();
    constexpr Step steps[] = {&OcpBuild::take_horizon,       &OcpBuild::take_costs, &OcpBuild::take_constraints,
                              &OcpBuild::take_least_squares, &OcpBuild::take_clock, &OcpBuild::take_guess,
                              &OcpBuild::take_free};
    for (const Step step : steps) {
      if (auto error = (this->*step)()) return tl::unexpected(*error);
    }
    if (auto error = take_physical()) return tl::unexpected(*error);
    for (std::size_t i = 0; i < squares_.size(); ++i) {
      if (auto error = check_times(ocp_.least_squares[i], *squares_[i].stated, ocp_)) return tl::unexpected(*error);
    }
    ocp_.warnings = ocp_.system.warnings;
    ocp_.places = switching_places(description());
    if (auto error = check(ocp_, slacks_.description())) return tl::unexpected(*error);
    return std::move(ocp_);
  }

 private:
  [[nodiscard]] const Description& description() const { return slacks_.description(); }

  std::optional<Error> plan() {
    from_ = stated_.from ? quantities_.add(stated_.from, "from") : -1;
    horizon_ = quantities_.add(stated_.horizon.value, stated_.horizon.free ? "horizon.initial" : "horizon");
    if (stated_.horizon.free) {
      horizon_lower_ = quantities_.add(stated_.horizon.lower, "horizon.lower");
      horizon_upper_ = quantities_.add(stated_.horizon.upper, "horizon.upper");
    }
    weight_ = stated_.time_weight ? quantities_.add(stated_.time_weight, "minimize_time") : -1;
    if (auto error = plan_cost(stated_.running_cost, "running_cost", running_)) return error;
    if (auto error = plan_cost(stated_.terminal_cost, "terminal_cost", terminal_)) return error;
    for (const auto& constraint : stated_.path_constraints) {
      if (auto error = plan_constraint(constraint, path_)) return error;
    }
    for (const auto& constraint : stated_.terminal_constraints) {
      if (auto error = plan_constraint(constraint, terminals_)) return error;
    }
    for (const auto& pair : stated_.path_complementarities) {
      complementarities_.emplace_back(quantities_.add(pair.first, "path_complementarities"),
                                      quantities_.add(pair.second, "path_complementarities"));
    }
    for (const auto& term : stated_.least_squares) plan_least_squares(term);
    for (const auto& guess : stated_.guess) guessed_.add(guess.expression, "initial_guess." + guess.name);
    for (const auto& parameter : description().free_parameters) {
      parameter_bounds_.emplace_back(
          quantities_.add(parameter.lower, fmt::format("the lower bound of {}", parameter.name)),
          quantities_.add(parameter.upper, fmt::format("the upper bound of {}", parameter.name)));
    }
    if (description().clock && description().clock->speed_lower) {
      speed_ = {quantities_.add(description().clock->speed_lower, "speed.lower"),
                quantities_.add(description().clock->speed_upper, "speed.upper")};
    }
    for (const auto& row : slacks_.rows()) {
      slack_rows_.emplace_back(quantities_.add(row.expression, "kink of controls"), row.at_stages);
    }
    return std::nullopt;
  }

  /// A cost that is minimised: kinks of controls enter it with a positive factor, or not at all.
  std::optional<Error> plan_cost(const NodePtr& cost, const std::string& name, int& quantity) {
    quantity = -1;
    if (!cost) return std::nullopt;
    auto smooth = &quantity == &running_ ? slacks_.in_running_cost(cost, name) : slacks_.in_terminal_cost(cost, name);
    if (!smooth) return smooth.error();
    quantity = quantities_.add(*smooth, name);
    return std::nullopt;
  }

  std::optional<Error> plan_constraint(const ConstraintDescription& stated, std::vector<PlannedConstraint>& list) {
    for (std::size_t i = 0; i + 1 < stated.sides.size(); ++i) {
      const bool two_sided = stated.sides.size() == 3;
      if (two_sided && i == 1 && merged_) break;
      if (auto error = plan_comparison(stated, i, list)) return error;
    }
    return std::nullopt;
  }

  /// Comparison number i of a constraint; both of a <= e <= b at once if a and b are constants.
  std::optional<Error> plan_comparison(const ConstraintDescription& stated, std::size_t i,
                                       std::vector<PlannedConstraint>& list) {
    const bool turned = stated.relations[i] == Relation::greater_equal;
    const NodePtr& small = stated.sides[turned ? i + 1 : i];
    const NodePtr& large = stated.sides[turned ? i : i + 1];
    const bool equal = stated.relations[i] == Relation::equal;
    PlannedConstraint plan{.stated = &stated};
    merged_ = stated.sides.size() == 3 && quantities_.is_constant(stated.sides.front()) &&
              quantities_.is_constant(stated.sides.back());
    if (merged_) {
      if (auto error = plan_middle(stated.sides[1], Curvature::linear, plan)) return error;
      plan.lower = quantities_.add(stated.sides[turned ? 2 : 0], "a bound of '" + stated.text + "'");
      plan.upper = quantities_.add(stated.sides[turned ? 0 : 2], "a bound of '" + stated.text + "'");
    } else if (quantities_.is_constant(large)) {
      if (auto error = plan_middle(small, equal ? Curvature::linear : Curvature::convex, plan)) return error;
      plan.upper = quantities_.add(large, "the bound of '" + stated.text + "'");
      if (equal) plan.lower = plan.upper;
    } else if (quantities_.is_constant(small)) {
      if (auto error = plan_middle(large, equal ? Curvature::linear : Curvature::concave, plan)) return error;
      plan.lower = quantities_.add(small, "the bound of '" + stated.text + "'");
      if (equal) plan.upper = plan.lower;
    } else {
      if (auto error = plan_middle(subtracted(small, large), equal ? Curvature::linear : Curvature::convex, plan))
        return error;
      plan.at_zero_upper = true;
      plan.at_zero_lower = equal;
    }
    if (stated.norm != ConstraintNorm::hard)
      plan.penalty = quantities_.add(stated.penalty, "penalty of '" + stated.text + "'");
    list.push_back(plan);
    return std::nullopt;
  }

  static Error soft_kink(const ConstraintDescription& stated) {
    return {ErrorCode::not_available,
            fmt::format("'{}' is soft and has a kink that mixes states and controls", stated.text),
            "state it hard, or soften a constraint for each side of the kink",
            stated.location,
            {"in [optimize]"}};
  }

  std::optional<Error> plan_middle(const NodePtr& expression, Curvature curvature, PlannedConstraint& plan) {
    const std::string place = "'" + plan.stated->text + "'";
    auto smooth = slacks_.in_constraint(expression, curvature, place);
    if (!smooth) return smooth.error();
    if (smooth->size() > 1 && plan.stated->norm != ConstraintNorm::hard) return soft_kink(*plan.stated);
    for (const auto& node : *smooth) plan.middles.push_back(quantities_.add(node, place));
    return std::nullopt;
  }

  struct PlannedSquares {
    const LeastSquaresDescription* stated = nullptr;
    std::vector<int> of, reference;
    std::vector<std::vector<int>> weight;
  };
  void plan_least_squares(const LeastSquaresDescription& stated) {
    PlannedSquares plan;
    plan.stated = &stated;
    for (const auto& node : stated.of) plan.of.push_back(quantities_.add(node, "least_squares of"));
    for (const auto& node : stated.reference)
      plan.reference.push_back(quantities_.add(node, "least_squares reference"));
    for (const auto& row : stated.weight) {
      plan.weight.emplace_back();
      for (const auto& node : row) plan.weight.back().push_back(quantities_.add(node, "a weight of least_squares"));
    }
    squares_.push_back(std::move(plan));
  }

  std::optional<Error> take_horizon() {
    if (from_ >= 0) {
      const auto from = quantities_.value(from_);
      if (!from) return from.error();
      ocp_.from = *from;
    }
    auto& horizon = ocp_.horizon;
    horizon.free = stated_.horizon.free;
    const auto value = quantities_.value(horizon_);
    if (!value) return value.error();
    horizon.value = *value;
    if (horizon.free) {
      const auto lower = quantities_.value(horizon_lower_);
      const auto upper = quantities_.value(horizon_upper_);
      if (!lower) return lower.error();
      if (!upper) return upper.error();
      horizon.lower = *lower;
      horizon.upper = *upper;
    }
    if (weight_ >= 0) {
      const auto weight = quantities_.value(weight_);
      if (!weight) return weight.error();
      ocp_.horizon.time_weight = *weight;
    }
    return check_horizon(horizon, stated_.horizon.location);
  }

  std::optional<Error> take_costs() {
    if (running_ >= 0) ocp_.running_cost = quantities_.output(running_);
    if (terminal_ >= 0) ocp_.terminal_cost = quantities_.output(terminal_);
    return std::nullopt;
  }

  std::optional<Error> take_constraints() {
    ocp_.path_at = stated_.path_constraints_at;
    for (const auto& [planned, list] : {std::pair{&path_, &ocp_.path}, std::pair{&terminals_, &ocp_.terminal}}) {
      for (const auto& plan : *planned) {
        OcpConstraint constraint{
            .name = plan.stated->text, .output = 0, .lower = -unbounded, .upper = unbounded, .norm = plan.stated->norm};
        for (const auto& [quantity, zero, bound] : {std::tuple{plan.lower, plan.at_zero_lower, &constraint.lower},
                                                    std::tuple{plan.upper, plan.at_zero_upper, &constraint.upper}}) {
          if (zero) *bound = 0.0;
          if (quantity < 0) continue;
          const auto value = quantities_.value(quantity);
          if (!value) return value.error();
          *bound = *value;
        }
        if (plan.penalty >= 0) {
          const auto penalty = quantities_.value(plan.penalty);
          if (!penalty) return penalty.error();
          constraint.penalty = *penalty;
        }
        if (auto error = check_constraint(constraint, plan.stated->location)) return error;
        for (const int middle : plan.middles) {
          constraint.output = quantities_.output(middle);
          list->push_back(constraint);
        }
      }
    }
    for (const auto& [row, at_stages] : slack_rows_) {
      ocp_.path.push_back({.name = "kink of controls",
                           .output = quantities_.output(row),
                           .lower = -unbounded,
                           .upper = 0.0,
                           .is_slack = true,
                           .at_stages = at_stages});
    }
    for (const auto& [first, second] : complementarities_) {
      ocp_.complementarities.emplace_back(quantities_.output(first), quantities_.output(second));
    }
    return std::nullopt;
  }

  std::optional<Error> take_least_squares() {
    for (const auto& plan : squares_) {
      OcpLeastSquares term;
      term.at = plan.stated->at;
      term.times = plan.stated->times;
      for (const int quantity : plan.of) term.of.push_back(quantities_.output(quantity));
      for (const int quantity : plan.reference) term.reference.push_back(quantities_.output(quantity));
      const auto n = static_cast<linalg::Index>(term.of.size());
      const auto& samples = plan.stated->samples;
      term.samples.resize(static_cast<linalg::Index>(samples.size()), samples.empty() ? 0 : n);
      for (std::size_t row = 0; row < samples.size(); ++row) {
        if (static_cast<linalg::Index>(samples[row].size()) != n) return wrong_sample_width(*plan.stated, row);
        for (linalg::Index i = 0; i < n; ++i)
          term.samples(static_cast<linalg::Index>(row), i) = samples[row][static_cast<std::size_t>(i)];
      }
      term.weight = linalg::Matrix::identity(n, n);
      const bool diagonal = plan.weight.size() == 1 && n != 1;
      for (std::size_t row = 0; row < plan.weight.size(); ++row) {
        for (std::size_t i = 0; i < plan.weight[row].size(); ++i) {
          const auto value = quantities_.value(plan.weight[row][i]);
          if (!value) return value.error();
          const auto column = static_cast<linalg::Index>(i);
          const linalg::Index place = diagonal ? column : static_cast<linalg::Index>(row);
          if (place < n && column < n) term.weight(place, column) = *value;
        }
      }
      if (auto error = check_least_squares(term, *plan.stated)) return error;
      ocp_.least_squares.push_back(std::move(term));
    }
    return std::nullopt;
  }

  std::optional<Error> take_guess() {
    if (stated_.guess.empty()) return std::nullopt;
    auto built = guessed_.build(overrides_);
    if (!built) return built.error();
    ocp_.guess.system = std::make_shared<const System>(std::move(*built));
    for (int i = 0; i < guessed_.count(); ++i) {
      auto guess = guess_of(stated_.guess[at(i)], ocp_, guessed_.output(i));
      if (!guess) return guess.error();
      ocp_.guess.list.push_back(*guess);
    }
    return std::nullopt;
  }

  std::optional<Error> take_free() {
    for (const auto& state : description().states) ocp_.free_states.push_back(state.free);
    const auto& system = ocp_.system;
    ocp_.free_states.resize(system.state_names.size(), false);
    if (auto error = check_initial_states(ocp_, description())) return error;
    take_initial_values();
    ocp_.free_parameters.assign(system.parameter_names.size(), false);
    ocp_.parameter_lower = ocp_.parameter_upper = system.parameter_values;
    for (std::size_t i = 0; i < parameter_bounds_.size(); ++i) {
      const auto& stated = description().free_parameters[i];
      const auto lower = quantities_.value(parameter_bounds_[i].first);
      const auto upper = quantities_.value(parameter_bounds_[i].second);
      if (!lower) return lower.error();
      if (!upper) return upper.error();
      const auto found = std::find(system.parameter_names.begin(), system.parameter_names.end(), stated.name);
      const auto index = static_cast<std::size_t>(found - system.parameter_names.begin());
      ocp_.free_parameters[index] = true;
      ocp_.parameter_lower[index] = *lower;
      ocp_.parameter_upper[index] = *upper;
      if (auto error = check_range(fmt::format("parameter '{}'", stated.name), system.parameter_values[index], *lower,
                                   *upper, stated.location))
        return error;
    }
    return std::nullopt;
  }

  void take_initial_values() {
    const auto place = [](const std::vector<std::string>& names, const std::string& name) {
      return static_cast<int>(std::find(names.begin(), names.end(), name) - names.begin());
    };
    for (const auto& state : initials_.states()) {
      ocp_.initial_values.push_back({place(ocp_.system.state_names, state),
                                     place(ocp_.system.parameter_names, InitialValues::parameter_of(state))});
    }
  }

  [[nodiscard]] bool is_chosen(const std::string& name) const {
    const auto& states = description().states;
    return is_free(description(), name) ||
           std::any_of(states.begin(), states.end(), [&](const auto& one) { return one.free && one.name == name; });
  }

  static Error chosen_in_plant(const std::string& name, const SourceLocation& location) {
    return {ErrorCode::invalid_model,
            fmt::format("'{}' is free: the plant has the value that the optimisation chooses", name),
            "leave it out of plant",
            location,
            {"in [optimize.plant]"}};
  }

  std::optional<Error> take_physical() {
    const auto build = [&](const std::vector<Override>& overrides, std::shared_ptr<const System>& place) {
      auto built = quantities_.build_physical(overrides);
      if (built) place = std::make_shared<const System>(std::move(*built));
      return built ? std::nullopt : std::optional(built.error());
    };
    if (ocp_.system.freezing) {
      if (auto error = build(overrides_, ocp_.physical)) return error;
    }
    if (stated_.plant.empty()) return std::nullopt;
    for (const auto& [name, value] : stated_.plant) {
      if (is_chosen(name)) return chosen_in_plant(name, value->location);
    }
    auto overrides = overrides_;
    const auto plant = initials_.with_parameters(stated_.plant);
    overrides.insert(overrides.end(), plant.begin(), plant.end());
    auto error = build(overrides, ocp_.plant);
    if (error) error->context = {"in [optimize.plant]"};
    return error;
  }

  std::optional<Error> take_clock() {
    if (!description().clock && !ocp_.system.freezing) return std::nullopt;
    OcpClock clock;
    if (ocp_.system.freezing) {
      clock.state = ocp_.system.freezing->clock;
      clock.speed_upper = FreezingNumbers{}.speed_upper;
      ocp_.system.initial_state[at(clock.state)] = ocp_.from;
    } else {
      const auto& stated = *description().clock;
      const auto& names = ocp_.system.state_names;
      const auto found = std::find(names.begin(), names.end(), stated.clock);
      if (found == names.end()) {
        return Error{ErrorCode::unknown_name,
                     fmt::format("expected the name of a state as clock, found '{}'", stated.clock),
                     suggest(stated.clock, names),
                     stated.location,
                     {"in [time_freezing]"}};
      }
      clock.state = static_cast<int>(found - names.begin());
    }
    if (speed_.first >= 0) {
      const auto lower = quantities_.value(speed_.first);
      const auto upper = quantities_.value(speed_.second);
      if (!lower) return lower.error();
      if (!upper) return upper.error();
      clock.speed_lower = *lower;
      clock.speed_upper = *upper;
    }
    ocp_.clock = clock;
    return std::nullopt;
  }

  InitialValues initials_;
  const OcpDescription& stated_;
  ControlSlacks slacks_;
  const std::vector<Override>& overrides_;
  OcpQuantities quantities_, guessed_;
  Ocp ocp_;
  int from_ = -1, horizon_ = -1, horizon_lower_ = -1, horizon_upper_ = -1, weight_ = -1, running_ = -1, terminal_ = -1;
  bool merged_ = false;  ///< both comparisons of the constraint planned last are one
  std::vector<PlannedConstraint> path_, terminals_;
  std::vector<std::pair<int, int>> complementarities_, parameter_bounds_;
  std::vector<PlannedSquares> squares_;
  std::vector<std::pair<int, bool>> slack_rows_;  ///< quantity; whether at stages
  std::pair<int, int> speed_{-1, -1};
};

}  // namespace

Expected<Ocp> build_ocp(const Description& description, const std::vector<Override>& overrides) {
  if (!description.optimize) {
    return tl::unexpected(Error{ErrorCode::invalid_model,
                                fmt::format("the model '{}' has no table [optimize]", description.name),
                                "state the problem in [optimize]: horizon, control_intervals, a cost, constraints",
                                {description.file, 1, 1},
                                {}});
  }
  try {
    return OcpBuild(description, overrides).run();
  } catch (const std::exception& exception) {
    return tl::unexpected(
        Error{ErrorCode::invalid_model,
              fmt::format("CasADi refused the problem of '{}': {}", description.name, exception.what()),
              "simplify the expression it names",
              {description.file, 0, 0},
              {}});
  }
}

}  // namespace saltus::model
