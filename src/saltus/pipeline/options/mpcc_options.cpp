#include "saltus/pipeline/options/mpcc_options.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "saltus/base/other_words.hpp"
#include "saltus/pipeline/options/option_values_internal.hpp"

namespace saltus::pipeline {
namespace {

using solver::FirstProblem;
using solver::SolveOptions;
using solver::Strategy;
using solver::homotopy::Relaxation;
using solver::homotopy::Steering;
using solver::homotopy::WarmStart;

constexpr auto starts_of = [](auto& o) -> auto& { return o.starts; };
constexpr auto seed_of = [](auto& o) -> auto& { return o.seed; };
constexpr auto strategy_of = [](auto& o) -> auto& { return o.strategy; };
constexpr auto sigma_initial_of = [](auto& o) -> auto& { return o.sigma_initial; };
constexpr auto sigma_factor_of = [](auto& o) -> auto& { return o.schedule.sigma_factor; };
constexpr auto sigma_final_of = [](auto& o) -> auto& { return o.schedule.sigma_final; };
constexpr auto compared_starts_of = [](auto& o) -> auto& { return o.compared_starts; };
constexpr auto relaxation_of = [](auto& o) -> auto& { return o.relaxation; };
constexpr auto crossover_of = [](auto& o) -> auto& { return o.crossover; };
constexpr auto iteration_limit_of = [](auto& o) -> auto& { return o.iteration_limit; };
constexpr auto tolerance_of = [](auto& o) -> auto& { return o.tolerance; };
constexpr auto steering_of = [](auto& o) -> auto& { return o.steering; };
constexpr auto first_of = [](auto& o) -> auto& { return o.first; };
constexpr auto warm_start_of = [](auto& o) -> auto& { return o.warm_start; };

constexpr double most_starts = 1000.0;
constexpr double most_iterations = std::numeric_limits<int>::max();

constexpr Choices<Strategy, 2> strategies{{"structured", "ipopt"}, {Strategy::structured, Strategy::ipopt}};
constexpr Choices<Steering, 3> steerings{{"direct", "l1", "linf"}, {Steering::direct, Steering::l1, Steering::linf}};
constexpr Choices<FirstProblem, 4> first_problems{
    {"auto", "relaxed", "branch", "modes"},
    {FirstProblem::automatic, FirstProblem::relaxed, FirstProblem::branch, FirstProblem::modes}};
constexpr Choices<WarmStart, 2> warm_starts{{"primal", "primal_dual"}, {WarmStart::primal, WarmStart::primal_dual}};

/// Their names stand beside the relaxations themselves.
const auto relaxations = [] {
  Choices<Relaxation, solver::homotopy::all_relaxations.size()> choices{{}, solver::homotopy::all_relaxations};
  std::transform(choices.values.begin(), choices.values.end(), choices.names.begin(),
                 [](Relaxation relaxation) { return name(relaxation); });
  return choices;
}();

const std::array fields_of_mpcc{
    choice_field<strategy_of, strategies, SolveOptions>(
        "solver",
        "All relaxed problems in one loop of the interior-point method (structured), or one after the other (ipopt)."),
    number_or_none_field<starts_of, auto_word, SolveOptions>(
        "starts", Numbers{.whole = true, .from = 1.0, .up_to = most_starts},
        "The problem is solved from its start and from random ones beside it (seeds 1, 2, …); the best is the answer. "
        "auto: from its start; foreign problems that it does not solve, from up to 24 random ones, until one does."),
    number_or_none_field<seed_of, none_word, SolveOptions>(
        "seed", Numbers{.whole = true, .from = 0.0, .up_to = most_starts},
        "Of these starts the problem is solved from that of one seed alone (0: its start), for machines that share "
        "them."),
    number_or_none_field<compared_starts_of, auto_word, SolveOptions>(
        "compared_starts", Numbers{.whole = true, .from = 0.0, .up_to = most_starts},
        "Random starts beside the start whose relaxed problems are compared; the path of the lowest objective goes on "
        "first (solver = structured, steering = direct). auto: 0."),
    choice_field<relaxation_of, relaxations, SolveOptions>("method", "How complementarities are relaxed by sigma."),
    choice_field<steering_of, steerings, SolveOptions>(
        "steering", "What makes sigma small: its bound alone, or a price on the sum or the largest of the products."),
    number_or_none_field<sigma_initial_of, auto_word, SolveOptions>(
        "sigma_initial", positive_number,
        "Sigma of the first relaxed problem; auto: the better of 100 and 0.1, where they have come to 0.1 (solver = "
        "ipopt: 1)."),
    number_field<sigma_factor_of, SolveOptions>("sigma_factor", Numbers{.above = 0.0, .below = 1.0},
                                                "From one relaxed problem to the next."),
    number_field<sigma_final_of, SolveOptions>("sigma_final", positive_number, "Sigma of the last relaxed problem."),
    choice_field<warm_start_of, warm_starts, SolveOptions>("warm_start", "What the next relaxed problem starts with."),
    choice_field<first_of, first_problems, SolveOptions>(
        "first",
        "The problem that is solved first. relaxed: that of sigma_initial. branch: every pair keeps the side that is "
        "zero "
        "at the start, for a start at a result of a similar problem. modes: sides are those of the states that "
        "initial_guess states, at a price that changes them; for optimal control only. auto: branch, where the start "
        "is a "
        "stored result with the same intervals and elements, and neither sigma_initial nor compared_starts is given; "
        "else "
        "relaxed."),
    truth_field<crossover_of, SolveOptions>(
        "crossover",
        "Problems with one side of every pair fixed, after the relaxed ones: exact zeros, and a certificate."),
    number_field<tolerance_of, SolveOptions>(
        "tolerance", positive_number, "Of feasibility, complementarity min(|G|, |H|) and stationarity of the answer."),
    number_field<iteration_limit_of, SolveOptions>("iteration_limit",
                                                   Numbers{.whole = true, .from = 1.0, .up_to = most_iterations},
                                                   "Of the solver, in all problems of a start together."),
};

}  // namespace

std::span<const MpccField> mpcc_fields() { return fields_of_mpcc; }

Expected<void> set_mpcc_option(SolveOptions& options, std::string_view key, const OptionValue& value) {
  std::vector<std::string> known;
  for (const auto& field : fields_of_mpcc) {
    if (field.key == key) return set_option(field, options, key, value);
    known.emplace_back(field.key);
  }
  return tl::unexpected(Error{ErrorCode::unknown_name,
                              fmt::format("unknown option mpcc.{}", key),
                              suggest_word(std::string(key), known),
                              {},
                              {}});
}

Expected<void> check_mpcc_options(const SolveOptions& options) {
  const double initial = options.sigma_initial.value_or(options.schedule.sigma_initial);
  const double final = options.schedule.sigma_final;
  if (final <= initial) return {};
  return tl::unexpected(Error{ErrorCode::invalid_option,
                              fmt::format("sigma_final ({}) is above sigma_initial ({})", final, initial),
                              "sigma falls: choose sigma_final <= sigma_initial",
                              {},
                              {}});
}

}  // namespace saltus::pipeline
