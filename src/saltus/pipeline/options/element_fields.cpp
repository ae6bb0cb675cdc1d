// Options of the methods made of finite elements, one table for both.
#include <array>
#include <string>
#include <type_traits>

#include "saltus/pipeline/options/option_values_internal.hpp"

namespace saltus::pipeline {
namespace {

constexpr Choices<Scheme, 5> schemes{
    {"radau_iia", "gauss_legendre", "lobatto_iiia", "lobatto_iiic", "explicit"},
    {Scheme::radau_iia, Scheme::gauss_legendre, Scheme::lobatto_iiia, Scheme::lobatto_iiic, Scheme::explicit_rk}};
constexpr Choices<Representation, 2> representations{{"integral", "differential"},
                                                     {Representation::integral, Representation::differential}};
constexpr Choices<Reformulation, 2> reformulations{{"step", "stewart"}, {Reformulation::step, Reformulation::stewart}};
constexpr Choices<CrossComplementarity, 5> cross_complementarities{
    {"stage_stage", "fe_stage", "stage_fe", "fe_fe", "paper"},
    {CrossComplementarity::stage_stage, CrossComplementarity::fe_stage, CrossComplementarity::stage_fe,
     CrossComplementarity::fe_fe, CrossComplementarity::paper}};
constexpr Choices<StepEquilibration, 8> step_equilibrations{
    {"direct", "mlcp", "none", "heuristic_mean", "heuristic_diff", "l2_relaxed", "l2_relaxed_scaled", "paper"},
    {StepEquilibration::direct, StepEquilibration::mlcp, StepEquilibration::none, StepEquilibration::heuristic_mean,
     StepEquilibration::heuristic_diff, StepEquilibration::l2_relaxed, StepEquilibration::l2_relaxed_scaled,
     StepEquilibration::paper}};

/// The options of one of the two methods.
constexpr auto of_fesd = [](auto& o) -> auto& { return o.fesd; };
constexpr auto of_timestepping = [](auto& o) -> auto& { return o.timestepping; };

template <auto part>
constexpr bool is_fesd = std::is_same_v<std::remove_const_t<decltype(part)>, std::remove_const_t<decltype(of_fesd)>>;
template <auto part, auto member>
constexpr auto option_of = [](auto& o) -> auto& {
  return part(o).*member;
};

void say_lengths_are_fixed(Error& error, const OptionValue&) { error.remedy = "lengths are fixed"; }

/// Lengths of the elements of timestepping are fixed: no errors limit them.
template <auto part>
constexpr OptionField error_limit_field() {
  constexpr auto error_limit = option_of<part, &ElementOptions::error_limit>;
  auto field = number_or_none_field<error_limit, off_word>(
      "error_limit", positive_number,
      "Of the estimated errors of all elements, relative to the states: steps are divided for it.");
  if (is_fesd<part>) return field;
  field.kind.number.reset();
  field.doc = "Lengths are fixed.";
  field.explain = say_lengths_are_fixed;
  return field;
}

constexpr double most_factors = 64.0;  // of products that are not lifted

template <auto part>
const std::array fields_of{
    choice_field<option_of<part, &ElementOptions::scheme>, schemes>("scheme", "Runge-Kutta method of the elements."),
    number_field<option_of<part, &ElementOptions::stages>>(
        "stages", counting_number,
        "Its stages: radau_iia and gauss_legendre have 1 to 9, the Lobatto methods 2 to 5, explicit 1 to 4."),
    number_field<option_of<part, &ElementOptions::steps>>("steps", counting_number,
                                                          "Simulation steps, of equal length."),
    number_field<option_of<part, &ElementOptions::elements>>("elements", counting_number,
                                                             "Elements in each; at least 2 with switch detection."),
    choice_field<option_of<part, &ElementOptions::representation>, representations>(
        "representation", "Unknowns of an element: stage states or stage slopes; the solutions are the same."),
    error_limit_field<part>(),
    number_field<option_of<part, &ElementOptions::step_bounds>>(
        "step_bounds", Numbers{.above = 0.0, .up_to = 1.0},
        is_fesd<part>
            ? "Lengths of elements are within (1 - this, 1 + this) times their mean, unless a step is divided."
            : "Lengths are fixed: every value holds."),
    number_field<option_of<part, &ElementOptions::rho>>("rho", positive_number,
                                                        "Weight of the objective terms of step_equilibration."),
    number_field<option_of<part, &ElementOptions::equilibration_scale>>(
        "equilibration_scale", positive_number, "Scale of step_equilibration = \"l2_relaxed_scaled\"."),
    choice_field<option_of<part, &ElementOptions::reformulation>, reformulations>(
        "reformulation", "How set-valued selections are written with complementarities."),
    choice_field<option_of<part, &ElementOptions::cross_complementarity>, cross_complementarities>(
        "cross_complementarity", "Which products are summed up; the solutions are the same."),
    choice_field<option_of<part, &ElementOptions::step_equilibration>, step_equilibrations>(
        "step_equilibration",
        is_fesd<part> ? "Lengths where nothing switches: the first two are exact, the others slow, for studies."
                      : "Lengths are fixed: all mean the same."),
    number_or_none_field<option_of<part, &ElementOptions::lifting>, off_word>(
        "lifting", Numbers{.whole = true, .from = 2.0, .up_to = most_factors},
        "Most factors in a product of selections; longer ones get variables of their own, with "
        "the same solutions."),
    truth_field<option_of<part, &ElementOptions::sensitivities>>(
        "sensitivities",
        "Derivatives of the end state with respect to initial state and parameters, of the discretisation."),
};

}  // namespace

std::span<const OptionField> element_fields() {
  static const auto names = [] {
    std::vector<std::string> list;
    for (const std::string_view table : {"fesd", "timestepping"}) {
      for (const auto& field : fields_of<of_fesd>) list.push_back(fmt::format("{}.{}", table, field.key));
    }
    return list;
  }();
  static const auto all = [] {
    std::vector<OptionField> list(fields_of<of_fesd>.begin(), fields_of<of_fesd>.end());
    list.insert(list.end(), fields_of<of_timestepping>.begin(), fields_of<of_timestepping>.end());
    for (std::size_t i = 0; i < list.size(); ++i) list[i].key = names[i];
    return list;
  }();
  return all;
}

}  // namespace saltus::pipeline
