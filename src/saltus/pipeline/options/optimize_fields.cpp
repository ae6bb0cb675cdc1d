#include "saltus/pipeline/options/optimize_fields.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/contains.hpp"
#include "saltus/base/other_words.hpp"
#include "saltus/pipeline/options/mpcc_options.hpp"
#include "saltus/pipeline/options/option_values_internal.hpp"

namespace saltus::pipeline {
namespace {

constexpr auto intervals_of = [](auto& o) -> auto& { return o.control_intervals; };
constexpr auto native_functions_of = [](auto& o) -> auto& { return o.native; };
constexpr auto start_values_of = [](auto& o) -> auto& { return o.start; };
constexpr auto detection_of = [](auto& o) -> auto& { return o.switch_detection; };
constexpr auto closed_loop_of = [](auto& o) -> auto& { return o.closed_loop; };
constexpr auto feedback_of = [](auto& o) -> auto& { return o.feedback; };
constexpr auto time_limit_of = [](auto& o) -> auto& { return o.mpcc.time_limit; };
constexpr auto verification_of = [](auto& o) -> auto& { return o.verification_tolerance; };

constexpr Choices<Native, 3> native_words{{"auto", "on", "off"}, {Native::automatic, Native::on, Native::off}};
constexpr Choices<Feedback, 2> feedback_words{{"optimal", "tracking"}, {Feedback::optimal, Feedback::tracking}};
constexpr Choices<StartValues, 2> start_words{{"neutral", "simulated"}, {StartValues::neutral, StartValues::simulated}};

void set_elements(OptimizeOptions& options, std::string_view, const OptionValue& value) {
  const auto* list = std::get_if<std::vector<double>>(&value);
  const std::vector<double> numbers = list != nullptr ? *list : std::vector<double>{number_in(value)};
  options.elements.clear();
  for (const double number : numbers) options.elements.push_back(static_cast<long>(number));
}

void record_elements(const OptimizeOptions& options, std::string_view key, OptionRecord& record) {
  if (options.elements.size() == 1) {
    record.emplace_back(key, std::int64_t{options.elements.front()});
  } else {
    record.emplace_back(key, std::vector<double>(options.elements.begin(), options.elements.end()));
  }
}

void record_intervals(const OptimizeOptions& options, std::string_view key, OptionRecord& record) {
  if (options.control_intervals > 0) record.emplace_back(key, std::int64_t{options.control_intervals});
}

using OwnField = FieldOf<OptimizeOptions>;
constexpr std::array grid_fields{
    OwnField{"control_intervals",
             {.number = counting_number},
             "Intervals of equal length, with one vector of controls each; there is no default.",
             set_number<intervals_of, OptimizeOptions>,
             record_intervals},
    OwnField{"elements",
             {.number = counting_number, .list = ListOf::the_same},
             "Finite elements in each interval; of a list one number per interval.",
             set_elements,
             record_elements},
};
constexpr auto detection_field = truth_field<detection_of, OptimizeOptions>(
    "switch_detection", "Elements end where the solution switches; false: equal elements, of order 1, to compare.");
constexpr std::array method_fields{
    choice_field<native_functions_of, native_words, OptimizeOptions>(
        "native", "Model functions as compiled code, as in a simulation."),
    choice_field<start_values_of, start_words, OptimizeOptions>(
        "start", "What selections and multipliers begin with: middle values, or those of a simulation of the guess."),
    truth_or_none_field<closed_loop_of, auto_word, OptimizeOptions>(
        "closed_loop",
        "Simulate the controls with feedback from the states, too, beside the open loop; auto: where bodies touch, and "
        "with `plant`."),
    choice_field<feedback_of, feedback_words, OptimizeOptions>(
        "feedback",
        "Gains of `closed_loop`: how the optimal controls change with the states at nodes, or a controller that tracks "
        "the plan from element to element."),
    number_field<verification_of, OptimizeOptions>(
        "verification_tolerance", positive_number,
        "Of the defects of intervals that are simulated again, relative to the range of each state."),
    number_or_none_field<time_limit_of, none_word, OptimizeOptions>("time_limit", positive_number,
                                                                    "Seconds, of all problems together."),
};

OptimizeField own_option(const OwnField& field) {
  return {std::string(field.key), field.kind, std::string(field.doc), field.set, field.record, field.explain};
}

/// An option that [simulate.fesd] has, too: the same words and ranges, with the default of an optimisation.
OptimizeField element_option(std::string_view key, std::string doc = {}) {
  const auto shared_fields = element_fields();
  const auto name = fmt::format("fesd.{}", key);
  const auto shared =
      *std::find_if(shared_fields.begin(), shared_fields.end(), [&](const auto& field) { return field.key == name; });
  return {std::string(key), shared.kind, doc.empty() ? std::string(shared.doc) : std::move(doc),
          [shared](OptimizeOptions& options, std::string_view, const OptionValue& value) {
            SimulateOptions carrier;
            carrier.fesd = options.element;
            shared.set(carrier, "", value);
            options.element = carrier.fesd;
          },
          [shared](const OptimizeOptions& options, std::string_view full_key, OptionRecord& record) {
            SimulateOptions carrier;
            carrier.fesd = options.element;
            shared.record(carrier, full_key, record);
          }};
}

OptimizeField mpcc_option(const MpccField& field) {
  return {fmt::format("mpcc.{}", field.key), field.kind, std::string(field.doc),
          [&field](OptimizeOptions& options, std::string_view name, const OptionValue& value) {
            field.set(options.mpcc, name, value);
          },
          [&field](const OptimizeOptions& options, std::string_view full_key, OptionRecord& record) {
            field.record(options.mpcc, full_key, record);
          }};
}

void append_elements(std::vector<OptimizeField>& list) {
  list.push_back(element_option("scheme"));
  list.push_back(element_option("stages"));
  list.push_back(own_option(detection_field));
  for (const std::string_view key : {"representation", "reformulation", "lifting", "cross_complementarity"})
    list.push_back(element_option(key));
  list.push_back(element_option("step_equilibration", "Lengths where nothing switches."));
  list.push_back(element_option(
      "step_bounds", "Lengths of elements are within (1 - this, 1 + this) times the mean of their interval."));
  list.push_back(element_option("rho"));
  list.push_back(element_option("equilibration_scale"));
}

std::vector<OptimizeField> all_fields() {
  std::vector<OptimizeField> list;
  for (const auto& field : grid_fields) list.push_back(own_option(field));
  append_elements(list);
  for (const auto& field : method_fields) list.push_back(own_option(field));
  for (const auto& field : mpcc_fields()) list.push_back(mpcc_option(field));
  return list;
}

constexpr std::array keys_of_problem{
    ProblemKey{"horizon", "an expression > 0, or a table",
               "Length of time; { free = true, initial, lower, upper } where it is chosen. There is no default."},
    ProblemKey{"from", "an expression", "Time at the start; 0 without."},
    ProblemKey{"running_cost", "an expression", "Its integral over time is minimised."},
    ProblemKey{"terminal_cost", "an expression", "Its value at the end is added."},
    ProblemKey{"minimize_time", "true, false, or an expression", "Adds the horizon; true is the weight 1."},
    ProblemKey{"path_constraints", "a list of comparisons", "Hold along the solution: \"q <= 3\", \"-1 <= v <= 2\"."},
    ProblemKey{"path_constraints_at", "intervals, elements, stages", "Where they are required; intervals without."},
    ProblemKey{"terminal_constraints", "a list of comparisons", "Hold at the end; initial(q) is q at the start."},
    ProblemKey{"path_complementarities", "a list of pairs",
               "[[\"a\", \"b\"]]: a >= 0, b >= 0, one of them 0, at every stage; controls in them are constant in an "
               "interval."},
    ProblemKey{"initial_guess", "a table", "Where to begin: { q = \"t\" }, or { result = \"r.json\" }."},
    ProblemKey{
        "plant", "a table",
        "Parameters and initial values of the system that `closed_loop` simulates, where they differ: { mu = 0.7 }."},
    ProblemKey{"least_squares", "[[optimize.least_squares]]",
               "Tables with of, reference, weight and at; \"times\" are those of measurements in a file."},
};

/// Words of simulations, and what is meant by them here.
struct OtherWord {
  std::string_view words;  ///< between spaces
  std::string_view remedy;
};
constexpr std::array other_words{
    OtherWord{
        " until T tf t_end duration ",
        "the length of time is `horizon`: write horizon = 2, or { free = true, initial = 2, lower = 1, upper = 5 }"},
    OtherWord{" rtol atol ",
              "how fine the grid is say control_intervals, elements and stages; mpcc.tolerance is that of the optimum, "
              "verification_tolerance that of its simulation (rtol is one of [simulate])"},
};

Error unknown_optimize_key(std::string_view key) {
  auto known = optimize_keys();
  for (const auto& problem_key : keys_of_problem) known.emplace_back(problem_key.key);
  Error error{ErrorCode::unknown_name, fmt::format("unknown option optimize.{}", key), "", {}, {}};
  for (const auto& [words, remedy] : other_words) {
    if (words.find(fmt::format(" {} ", key)) == std::string_view::npos) continue;
    error.remedy = remedy;
    return error;
  }
  auto nearest = nearest_words(std::string(key), known);
  const auto last = key.substr(key.rfind('.') + 1);
  for (const auto& candidate : known) {  // the right name in the wrong table: optimize.sigma_final
    const bool same = std::string_view(candidate).substr(candidate.rfind('.') + 1) == last;
    if (same && !contains(nearest, candidate)) nearest.push_back(candidate);
  }
  error.remedy = nearest.empty() ? suggest_word(std::string(key), known)
                                 : fmt::format("did you mean 'optimize.{}'?", fmt::join(nearest, "' or 'optimize."));
  return error;
}

}  // namespace

std::span<const OptimizeField> optimize_fields() {
  static const std::vector<OptimizeField> fields_of_optimize = all_fields();
  return fields_of_optimize;
}

std::span<const ProblemKey> problem_keys() { return keys_of_problem; }

std::vector<std::string> optimize_keys() {
  std::vector<std::string> keys;
  for (const auto& field : optimize_fields()) keys.push_back(field.key);
  return keys;
}

Expected<OptimizeOptions> with_value(OptimizeOptions options, std::string_view key, const OptionValue& value) {
  for (const auto& field : optimize_fields()) {
    if (field.key == key) return set_option(field, options, "", value).map([&] { return std::move(options); });
  }
  return tl::unexpected(unknown_optimize_key(key));
}

OptionRecord option_record(const OptimizeOptions& options) { return record_of(options, "optimize", optimize_fields()); }

}  // namespace saltus::pipeline
