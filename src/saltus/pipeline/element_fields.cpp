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

template <auto part>
Expected<void> set_step_bounds(SimulateOptions& options, std::string_view, const OptionValue& value) {
  const double number = number_in(value);
  if (!(number > 0.0 && number <= 1.0)) return tl::unexpected(out_of_range("a number > 0 and <= 1", value));
  part(options).step_bounds = number;
  return {};
}

template <auto part>
Expected<void> set_error_limit(SimulateOptions& options, std::string_view, const OptionValue& value) {
  if (const auto* word = std::get_if<std::string>(&value); word != nullptr && *word == "off") {
    part(options).error_limit.reset();
    return {};
  }
  if (!is_fesd<part>) return tl::unexpected(out_of_range("\"off\": lengths are fixed", value));
  const auto number = number_within(Range::positive, value);
  if (!number) return tl::unexpected(out_of_range("a finite number > 0, or \"off\"", value));
  part(options).error_limit = *number;
  return {};
}

template <auto part>
void record_error_limit(const SimulateOptions& options, std::string_view key, OptionRecord& record) {
  if (part(options).error_limit) {
    record.emplace_back(key, *part(options).error_limit);
  } else {
    record.emplace_back(key, std::string("off"));
  }
}

template <auto part>
Expected<void> set_lifting(SimulateOptions& options, std::string_view, const OptionValue& value) {
  if (const auto* word = std::get_if<std::string>(&value); word != nullptr && *word == "off") {
    part(options).lifting.reset();
    return {};
  }
  const double number = number_in(value);
  if (!(number >= 2.0 && number <= 64.0 && number == std::floor(number))) {
    return tl::unexpected(out_of_range("a whole number from 2 to 64 or \"off\"", value));
  }
  part(options).lifting = static_cast<long>(number);
  return {};
}

template <auto part>
void record_lifting(const SimulateOptions& options, std::string_view key, OptionRecord& record) {
  if (part(options).lifting) {
    record.emplace_back(key, std::int64_t{*part(options).lifting});
  } else {
    record.emplace_back(key, std::string("off"));
  }
}

template <auto part>
constexpr std::array fields_of{
    choice_field<option_of<part, &ElementOptions::scheme>, schemes>(
        "scheme", "radau_iia, gauss_legendre, lobatto_iiia, lobatto_iiic, explicit",
        "Runge-Kutta method of the elements."),
    count_field<option_of<part, &ElementOptions::stages>>(
        "stages", "a whole number >= 1",
        "Its stages: radau_iia and gauss_legendre have 1 to 9, the Lobatto methods 2 to 5, explicit 1 to 4."),
    count_field<option_of<part, &ElementOptions::steps>>("steps", "a whole number >= 1",
                                                         "Simulation steps, of equal length."),
    count_field<option_of<part, &ElementOptions::elements>>("elements", "a whole number >= 1",
                                                            "Elements in each; at least 2 with switch detection."),
    choice_field<option_of<part, &ElementOptions::representation>, representations>(
        "representation", "integral, differential",
        "Unknowns of an element: stage states or stage slopes; the solutions are the same."),
    OptionField{"error_limit", is_fesd<part> ? "a finite number > 0, or \"off\"" : "\"off\"",
                is_fesd<part>
                    ? "Of the estimated errors of all elements, relative to the states: steps are divided for it."
                    : "Lengths are fixed.",
                set_error_limit<part>, record_error_limit<part>},
    OptionField{"step_bounds", "a number > 0 and <= 1",
                is_fesd<part>
                    ? "Lengths of elements are within (1 - this, 1 + this) times their mean, unless a step is divided."
                    : "Lengths are fixed: every value holds.",
                set_step_bounds<part>, record_number<option_of<part, &ElementOptions::step_bounds>>},
    number_field<option_of<part, &ElementOptions::rho>, Range::positive>(
        "rho", "a finite number > 0", "Weight of the objective terms of step_equilibration."),
    number_field<option_of<part, &ElementOptions::equilibration_scale>, Range::positive>(
        "equilibration_scale", "a finite number > 0", "Scale of step_equilibration = \"l2_relaxed_scaled\"."),
    choice_field<option_of<part, &ElementOptions::reformulation>, reformulations>(
        "reformulation", "step, stewart", "How set-valued selections are written with complementarities."),
    choice_field<option_of<part, &ElementOptions::cross_complementarity>, cross_complementarities>(
        "cross_complementarity", "stage_stage, fe_stage, stage_fe, fe_fe, paper",
        "Which products are summed up; the solutions are the same."),
    choice_field<option_of<part, &ElementOptions::step_equilibration>, step_equilibrations>(
        "step_equilibration", "direct, mlcp, none, heuristic_mean|diff, l2_relaxed[_scaled], paper",
        is_fesd<part> ? "Lengths where nothing switches: the first two are exact, the others slow, for studies."
                      : "Lengths are fixed: all mean the same."),
    OptionField{"lifting", "a whole number >= 2, or \"off\"",
                "Most factors in products of selections, longer ones are lifted; the solutions are the same.",
                set_lifting<part>, record_lifting<part>},
    truth_field<option_of<part, &ElementOptions::sensitivities>>(
        "sensitivities", "true, false",
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
