#include "saltus/pipeline/options/optimize_fields.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include <fmt/format.h>

#include "saltus/pipeline/options/mpcc_options.hpp"
#include "saltus/pipeline/options/option_values_internal.hpp"

namespace saltus::pipeline {
namespace {

constexpr auto intervals_of = [](auto& o) -> auto& { return o.control_intervals; };
constexpr auto native_functions_of = [](auto& o) -> auto& { return o.native; };
constexpr auto start_values_of = [](auto& o) -> auto& { return o.start; };
constexpr auto verification_of = [](auto& o) -> auto& { return o.verification_tolerance; };

constexpr Choices<Native, 3> native_words{{"auto", "on", "off"}, {Native::automatic, Native::on, Native::off}};
constexpr Choices<StartValues, 2> start_words{{"neutral", "simulated"}, {StartValues::neutral, StartValues::simulated}};

/// A whole number >= 1, also if it is written 1e3.
std::optional<long> count_in(double number) {
  constexpr double most = 9e15;
  if (!(number >= 1.0 && number <= most && number == std::floor(number))) return std::nullopt;
  return static_cast<long>(number);
}

Expected<void> set_elements(OptimizeOptions& options, const OptionValue& value) {
  constexpr std::string_view expected = "a whole number >= 1, or a list of them with one per control interval";
  const auto* list = std::get_if<std::vector<double>>(&value);
  const std::vector<double> numbers = list != nullptr ? *list : std::vector<double>{number_in(value)};
  std::vector<long> counts;
  for (const double number : numbers) {
    const auto count = count_in(number);
    if (!count) return tl::unexpected(out_of_range(expected, value));
    counts.push_back(*count);
  }
  if (counts.empty()) return tl::unexpected(out_of_range(expected, value));
  options.elements = std::move(counts);
  return {};
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

Expected<void> set_switch_detection(OptimizeOptions& options, const OptionValue& value) {
  const auto* truth = std::get_if<bool>(&value);
  if (truth == nullptr) return tl::unexpected(out_of_range("true or false", value));
  options.switch_detection = *truth;
  return {};
}

Expected<void> set_closed_loop(OptimizeOptions& options, const OptionValue& value) {
  const auto* truth = std::get_if<bool>(&value);
  if (truth == nullptr) return tl::unexpected(out_of_range("true or false", value));
  options.closed_loop = *truth;
  return {};
}

Expected<void> set_time_limit(OptimizeOptions& options, const OptionValue& value) {
  if (const auto* word = std::get_if<std::string>(&value); word != nullptr && *word == "none") {
    options.mpcc.time_limit.reset();
    return {};
  }
  const auto seconds = number_within(Range::positive, value);
  if (!seconds) return tl::unexpected(out_of_range("a finite number > 0 or \"none\"", value));
  options.mpcc.time_limit = *seconds;
  return {};
}

void record_time_limit(const OptimizeOptions& options, std::string_view key, OptionRecord& record) {
  if (options.mpcc.time_limit) {
    record.emplace_back(key, *options.mpcc.time_limit);
  } else {
    record.emplace_back(key, std::string("none"));
  }
}

Expected<void> set_solver(OptimizeOptions& options, const OptionValue& value) {
  const auto* word = std::get_if<std::string>(&value);
  if (word != nullptr && *word == "structured") {
    return tl::unexpected(Error{ErrorCode::not_available,
                                "solver \"structured\" is not available in this version; a later one brings it",
                                "choose solver = \"ipopt\"",
                                {},
                                {}});
  }
  if (word == nullptr || *word != "ipopt") return tl::unexpected(out_of_range("\"ipopt\"", value));
  options.solver = *word;
  return {};
}

/// An option that [simulate.fesd] has, too: the same words and ranges, with the default of an optimisation.
OptimizeField element_option(std::string_view key, std::string doc = {}) {
  const auto shared_fields = element_fields();
  const auto name = fmt::format("fesd.{}", key);
  const auto shared =
      *std::find_if(shared_fields.begin(), shared_fields.end(), [&](const auto& field) { return field.key == name; });
  return {std::string(key), std::string(shared.expects), doc.empty() ? std::string(shared.doc) : std::move(doc),
          [shared](OptimizeOptions& options, const OptionValue& value) {
            SimulateOptions carrier;
            carrier.fesd = options.element;
            return shared.set(carrier, "", value).map([&] { options.element = carrier.fesd; });
          },
          [shared](const OptimizeOptions& options, std::string_view full_key, OptionRecord& record) {
            SimulateOptions carrier;
            carrier.fesd = options.element;
            shared.record(carrier, full_key, record);
          }};
}

OptimizeField mpcc_option(const MpccField& field) {
  return {fmt::format("mpcc.{}", field.key), std::string(field.expects), std::string(field.doc),
          [&field](OptimizeOptions& options, const OptionValue& value) {
            return field.set(options.mpcc, field.key, value);
          },
          [&field](const OptimizeOptions& options, std::string_view full_key, OptionRecord& record) {
            field.record(options.mpcc, full_key, record);
          }};
}

/// For setters that take a name, which no option of an optimisation has.
template <auto setter>
Expected<void> without_name(OptimizeOptions& options, const OptionValue& value) {
  return setter(options, "", value);
}

void append_grid(std::vector<OptimizeField>& list) {
  list.push_back({"control_intervals", "a whole number >= 1",
                  "Intervals of equal length, with one vector of controls each; there is no default.",
                  without_name<set_count<intervals_of, OptimizeOptions>>, record_intervals});
  list.push_back({"elements", "a whole number >= 1, or a list",
                  "Finite elements in each interval; of a list one number per interval.", set_elements,
                  record_elements});
}

void append_elements(std::vector<OptimizeField>& list) {
  list.push_back(element_option("scheme"));
  list.push_back(element_option("stages"));
  list.push_back({"switch_detection", "true, false",
                  "Elements end where the solution switches; false: equal elements, of order 1, to compare.",
                  set_switch_detection, [](const OptimizeOptions& options, std::string_view key, OptionRecord& record) {
                    record.emplace_back(key, options.switch_detection);
                  }});
  list.push_back(element_option("representation"));
  list.push_back(element_option("reformulation"));
  list.push_back(element_option("lifting"));
  list.push_back(element_option("cross_complementarity"));
  list.push_back(element_option("step_equilibration", "Lengths where nothing switches."));
  list.push_back(element_option(
      "step_bounds", "Lengths of elements are within (1 - this, 1 + this) times the mean of their interval."));
  list.push_back(element_option("rho"));
  list.push_back(element_option("equilibration_scale"));
}

std::vector<OptimizeField> all_fields() {
  std::vector<OptimizeField> list;
  append_grid(list);
  append_elements(list);
  list.push_back({"native", "auto, on, off", "Model functions as compiled code, as in a simulation.",
                  without_name<set_choice<native_functions_of, native_words, OptimizeOptions>>,
                  record_choice<native_functions_of, native_words, OptimizeOptions>});
  list.push_back({"start", "neutral, simulated",
                  "What selections and multipliers begin with: middle values, or those of a simulation of the guess.",
                  without_name<set_choice<start_values_of, start_words, OptimizeOptions>>,
                  record_choice<start_values_of, start_words, OptimizeOptions>});
  list.push_back({"closed_loop", "true or false",
                  "Simulate the controls with feedback from the states at the nodes, too, beside the open loop.",
                  set_closed_loop, [](const OptimizeOptions& options, std::string_view key, OptionRecord& record) {
                    record.emplace_back(key, options.closed_loop);
                  }});
  list.push_back({"verification_tolerance", "a finite number > 0",
                  "Of the defects of intervals that are simulated again, relative to the range of each state.",
                  without_name<set_number<verification_of, Range::positive, OptimizeOptions>>,
                  record_number<verification_of, OptimizeOptions>});
  list.push_back(
      {"time_limit", "none, or a number > 0", "Seconds, of all problems together.", set_time_limit, record_time_limit});
  list.push_back({"mpcc.solver", "ipopt", "Of the smooth problems.", set_solver,
                  [](const OptimizeOptions& options, std::string_view key, OptionRecord& record) {
                    record.emplace_back(key, options.solver);
                  }});
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
    ProblemKey{"terminal_constraints", "a list of comparisons", "Hold at the end."},
    ProblemKey{"path_complementarities", "a list of pairs",
               "[[\"a\", \"b\"]]: a >= 0, b >= 0, one of them 0, at every stage."},
    ProblemKey{"initial_guess", "a table", "Where to begin: { q = \"t\" }, or { result = \"r.json\" }."},
    ProblemKey{
        "plant", "a table",
        "Parameters and initial values of the system that `closed_loop` simulates, where they differ: { mu = 0.7 }."},
    ProblemKey{"least_squares", "[[optimize.least_squares]]", "Tables with of, reference, weight and at."},
};

Error unknown_optimize_key(std::string_view key) {
  auto known = optimize_keys();
  for (const auto& problem_key : keys_of_problem) known.emplace_back(problem_key.key);
  Error error{ErrorCode::unknown_name, fmt::format("unknown option optimize.{}", key), "", {}, {}};
  auto nearest = nearest_names(std::string(key), known);
  const auto last = key.substr(key.rfind('.') + 1);
  for (const auto& candidate : known) {  // the right name in the wrong table: optimize.sigma_final
    const bool same = std::string_view(candidate).substr(candidate.rfind('.') + 1) == last;
    if (same && std::find(nearest.begin(), nearest.end(), candidate) == nearest.end()) nearest.push_back(candidate);
  }
  error.remedy = nearest.empty() ? suggest(std::string(key), known)
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
    if (field.key == key) return field.set(options, value).map([&] { return std::move(options); });
  }
  return tl::unexpected(unknown_optimize_key(key));
}

OptionRecord option_record(const OptimizeOptions& options) { return record_of(options, "optimize", optimize_fields()); }

}  // namespace saltus::pipeline
