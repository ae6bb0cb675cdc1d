#include "saltus/pipeline/options/option_fields.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "saltus/pipeline/options/option_values_internal.hpp"

namespace saltus::pipeline {
namespace {

// Access to a member, for reading and writing alike: the only place that names it.
constexpr auto until_of = [](auto& o) -> auto& { return o.until; };
constexpr auto from_of = [](auto& o) -> auto& { return o.from; };
constexpr auto method_of = [](auto& o) -> auto& { return o.method; };
constexpr auto rtol_of = [](auto& o) -> auto& { return o.rtol; };
constexpr auto atol_of = [](auto& o) -> auto& { return o.atol; };
constexpr auto event_rows_of = [](auto& o) -> auto& { return o.event_rows; };
constexpr auto native_of = [](auto& o) -> auto& { return o.native; };
constexpr auto max_steps_of = [](auto& o) -> auto& { return o.max_steps; };
constexpr auto members_of = [](auto& o) -> auto& { return o.event.members; };
constexpr auto max_events_of = [](auto& o) -> auto& { return o.max_events; };
constexpr auto integrator_of = [](auto& o) -> auto& { return o.event.integrator; };
constexpr auto local_steps_of = [](auto& o) -> auto& { return o.event.local_steps; };
constexpr auto epsilon_of = [](auto& o) -> auto& { return o.smoothed.epsilon; };
constexpr auto selection_of = [](auto& o) -> auto& { return o.event.selection; };

void record_until(const SimulateOptions& options, std::string_view key, OptionRecord& record) {
  if (options.until) record.emplace_back(key, *options.until);
}

constexpr Choices<Method, 4> methods{{"event", "smoothed", "fesd", "timestepping"},
                                     {Method::event, Method::smoothed, Method::fesd, Method::timestepping}};
constexpr Choices<Integrator, 6> integrators{{"dopri5", "dop853", "radau5", "radau9", "radau13", "taylor"},
                                             {Integrator::dopri5, Integrator::dop853, Integrator::radau5,
                                              Integrator::radau9, Integrator::radau13, Integrator::taylor}};
/// What a word of other programs, or one in the wrong place, stands for; empty for others.
std::string_view integrator_meant(std::string word) {
  std::transform(word.begin(), word.end(), word.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  constexpr std::array<std::array<std::string_view, 2>, 10> elsewhere{{{"rk45", "dopri5"},
                                                                       {"ode45", "dopri5"},
                                                                       {"tsit5", "dopri5"},
                                                                       {"ode89", "dop853"},
                                                                       {"vern9", "dop853"},
                                                                       {"radau", "radau5"},
                                                                       {"bdf", "radau5"},
                                                                       {"lsoda", "radau5"},
                                                                       {"ode15s", "radau5"},
                                                                       {"rodas5", "radau5"}}};
  for (const auto& [name, integrator] : elsewhere) {
    if (name == word) return integrator;
  }
  const auto* found = std::find(integrators.names.begin(), integrators.names.end(), word);
  return found == integrators.names.end() ? std::string_view() : *found;
}

/// Of methods and integrators.
template <auto access, const auto& choices>
Expected<void> set_engine(SimulateOptions& options, std::string_view key, const OptionValue& value) {
  auto done = set_choice<access, choices>(options, key, value);
  const auto* word = std::get_if<std::string>(&value);
  if (done || word == nullptr || !done.error().remedy.empty()) return done;
  if (const auto meant = integrator_meant(*word); !meant.empty()) {
    done.error().remedy = fmt::format("did you mean the integrator {}?", meant);
  }
  return done;
}

constexpr Choices<Native, 3> natives{{"auto", "on", "off"}, {Native::automatic, Native::on, Native::off}};
constexpr Choices<Selection, 4> selections{
    {"active_dominant", "passive_dominant", "scaled", "report"},
    {Selection::active_dominant, Selection::passive_dominant, Selection::scaled, Selection::report}};

Expected<void> set_output_word(SimulateOptions& options, std::string_view, const OptionValue& value) {
  const auto* word = std::get_if<std::string>(&value);
  if (word == nullptr || (*word != "auto" && *word != "steps")) {
    return tl::unexpected(
        out_of_range("\"steps\", \"auto\", { every = a number > 0 }, { points = a whole number >= 2 } or { times = "
                     "[increasing numbers] }, the tables also with events = false, states = [names], surfaces = "
                     "[names]",
                     value));
  }
  options.output = *word == "auto" ? OutputGrid(Automatic{}) : OutputGrid(EveryStep{});
  // A word stands for the whole table: what a table before it left out is there again.
  options.event_rows = true;
  options.kept = {};
  return {};
}

Expected<void> set_output_every(SimulateOptions& options, std::string_view, const OptionValue& value) {
  return number_within(Range::positive, value).map([&](double interval) { options.output = EveryInterval{interval}; });
}

Expected<void> set_output_points(SimulateOptions& options, std::string_view, const OptionValue& value) {
  const double number = number_in(value);
  if (!(number >= 2.0 && number <= 1e9 && number == std::floor(number))) {
    return tl::unexpected(out_of_range("a whole number from 2 to 1000000000", value));
  }
  options.output = NumberOfPoints{static_cast<int>(number)};
  return {};
}

Expected<void> set_output_times(SimulateOptions& options, std::string_view, const OptionValue& value) {
  constexpr std::string_view expected = "a list of finite, increasing numbers";
  const auto* times = std::get_if<std::vector<double>>(&value);
  if (times == nullptr || times->empty()) return tl::unexpected(out_of_range(expected, value));
  for (std::size_t i = 0; i < times->size(); ++i) {
    const double time = (*times)[i];
    if (std::isfinite(time) && (i == 0 || (*times)[i - 1] < time)) continue;
    return tl::unexpected(Error{ErrorCode::invalid_option,
                                fmt::format("expected {}, found {} at place {}{}", expected, time, i + 1,
                                            i == 0 ? "" : fmt::format(", after {}", (*times)[i - 1])),
                                "sort the times and write each once",
                                {},
                                {}});
  }
  options.output = AtTimes{*times};
  return {};
}

/// A list of names; a word by itself is one name, and a list without anything in it can be one of numbers.
template <auto member>
Expected<void> set_kept(SimulateOptions& options, std::string_view, const OptionValue& value) {
  const auto* numbers = std::get_if<std::vector<double>>(&value);
  if (const auto* names = std::get_if<std::vector<std::string>>(&value)) {
    options.kept.*member = *names;
  } else if (const auto* name = std::get_if<std::string>(&value)) {
    options.kept.*member = std::vector{*name};
  } else if (numbers != nullptr && numbers->empty()) {
    options.kept.*member = std::vector<std::string>{};
  } else {
    return tl::unexpected(out_of_range("a list of names like [\"x\", \"v*\"]", value));
  }
  return {};
}

template <auto member>
void record_kept(const SimulateOptions& options, std::string_view key, OptionRecord& record) {
  if (options.kept.*member) record.emplace_back(key, *(options.kept.*member));
}

void record_output_word(const SimulateOptions& options, std::string_view key, OptionRecord& record) {
  if (std::holds_alternative<Automatic>(options.output)) record.emplace_back(key, std::string("auto"));
  if (std::holds_alternative<EveryStep>(options.output)) record.emplace_back(key, std::string("steps"));
}

template <class Grid>
void record_output(const SimulateOptions& options, std::string_view key, OptionRecord& record) {
  const auto* grid = std::get_if<Grid>(&options.output);
  if (grid == nullptr) return;
  if constexpr (std::is_same_v<Grid, EveryInterval>) record.emplace_back(key, grid->interval);
  if constexpr (std::is_same_v<Grid, NumberOfPoints>) record.emplace_back(key, std::int64_t{grid->points});
  if constexpr (std::is_same_v<Grid, AtTimes>) record.emplace_back(key, grid->times);
}

template <class Value>
void put(std::vector<std::pair<std::string, Value>>& entries, std::string_view name, Value value) {
  const auto same = [&](const auto& entry) { return entry.first == name; };
  const auto found = std::find_if(entries.begin(), entries.end(), same);
  if (found == entries.end()) {
    entries.emplace_back(name, value);
  } else {
    found->second = value;
  }
}

Expected<void> set_initial_mode(SimulateOptions& options, std::string_view name, const OptionValue& value) {
  const double number = number_in(value);
  if (number != -1.0 && number != 0.0 && number != 1.0) return tl::unexpected(out_of_range("-1, 0 or 1", value));
  put(options.initial_mode, name, static_cast<int>(number));
  return {};
}

Expected<void> set_scaling(SimulateOptions& options, std::string_view name, const OptionValue& value) {
  return number_within(Range::positive, value).map([&](double kappa) { put(options.event.scaling, name, kappa); });
}

void record_initial_mode(const SimulateOptions& options, std::string_view key, OptionRecord& record) {
  const auto prefix = key.substr(0, key.size() - 1);
  for (const auto& [name, sign] : options.initial_mode) {
    record.emplace_back(fmt::format("{}{}", prefix, name), std::int64_t{sign});
  }
}

void record_scaling(const SimulateOptions& options, std::string_view key, OptionRecord& record) {
  const auto prefix = key.substr(0, key.size() - 1);
  for (const auto& [name, kappa] : options.event.scaling) record.emplace_back(fmt::format("{}{}", prefix, name), kappa);
}

Expected<void> set_max_step(SimulateOptions& options, std::string_view, const OptionValue& value) {
  if (const auto* word = std::get_if<std::string>(&value); word != nullptr && *word == "none") {
    options.event.max_step.reset();
    return {};
  }
  const auto step = number_within(Range::positive, value);
  if (!step) return tl::unexpected(out_of_range("a finite number > 0 or \"none\"", value));
  options.event.max_step = *step;
  return {};
}

void record_max_step(const SimulateOptions& options, std::string_view key, OptionRecord& record) {
  if (options.event.max_step) {
    record.emplace_back(key, *options.event.max_step);
  } else {
    record.emplace_back(key, std::string("none"));
  }
}

Expected<void> set_branches(SimulateOptions& options, std::string_view, const OptionValue& value) {
  constexpr long all = 64;
  const auto* word = std::get_if<std::string>(&value);
  const auto* count = std::get_if<std::int64_t>(&value);
  if (word != nullptr && *word == "report") {
    options.event.trajectories = 1;
  } else if (word != nullptr && *word == "all") {
    options.event.trajectories = all;
  } else if (count != nullptr && *count >= 1) {
    options.event.trajectories = *count;
  } else {
    return tl::unexpected(out_of_range("\"report\", \"all\" or a whole number >= 1", value));
  }
  return {};
}

void record_branches(const SimulateOptions& options, std::string_view key, OptionRecord& record) {
  if (options.event.trajectories == 1) {
    record.emplace_back(key, std::string("report"));
  } else {
    record.emplace_back(key, std::int64_t{options.event.trajectories});
  }
}

Expected<void> set_members(SimulateOptions& options, std::string_view, const OptionValue& value) {
  const auto* count = std::get_if<std::int64_t>(&value);
  if (count == nullptr || *count < 0) return tl::unexpected(out_of_range("a whole number >= 0", value));
  options.event.members = *count;
  return {};
}

constexpr std::array fields{
    OptionField{"until", "a finite number > `from`", "End of the simulation; there is no default.",
                set_number<until_of, Range::finite>, record_until},
    number_field<from_of, Range::finite>("from", "a finite number", "Start of the simulation."),
    OptionField{"method", "event, smoothed, fesd, timestepping",
                "Event-driven; regularised; finite elements with switch detection; the same without it.",
                set_engine<method_of, methods>, record_choice<method_of, methods>},
    number_field<rtol_of, Range::positive>("rtol", "a finite number > 0",
                                           "Relative error tolerance of a step, per component of the state."),
    number_field<atol_of, Range::not_negative>("atol", "a finite number >= 0",
                                               "Absolute error tolerance of a step, in the units of the states."),
    OptionField{"output", "auto, steps",
                "Rows at steps, and between them so that straight lines are within 1e-3 of every column's range.",
                set_output_word, record_output_word},
    OptionField{"output.every", "a finite number > 0", "Instead: a row every so often, counted from `from`.",
                set_output_every, record_output<EveryInterval>},
    OptionField{"output.points", "a whole number >= 2", "Instead: so many rows, both ends among them.",
                set_output_points, record_output<NumberOfPoints>},
    OptionField{"output.times", "increasing numbers", "Instead: rows at these times, all within the span.",
                set_output_times, record_output<AtTimes>},
    truth_field<event_rows_of>(
        "output.events", "true, false",
        "Rows before and behind every event; false leaves them out, so that no time has two rows."),
    OptionField{"output.states", "names, or patterns like v*",
                "Rows have these states only; end state and events stay complete. Default: all.",
                set_kept<&KeptNames::states>, record_kept<&KeptNames::states>},
    OptionField{"output.surfaces", "names, or patterns like s*",
                "Rows have the modes and selections of these switching functions only. Default: all.",
                set_kept<&KeptNames::surfaces>, record_kept<&KeptNames::surfaces>},
    choice_field<native_of, natives>(
        "native", "auto, on, off",
        "Model functions as compiled code, bit-identical; auto: where it pays and there is a compiler."),
    count_field<max_steps_of>(
        "max_steps", "a whole number >= 1",
        "Stop with iteration_limit after so many steps (fesd: elements, and divided simulation steps)."),
    count_field<max_events_of>("max_events", "a whole number >= 1", "Stop with iteration_limit after so many events."),
    OptionField{"initial_mode.*", "-1, 0, 1",
                "Force the side of a switching function at the start (0: slide on it), or a mode by `indicator`.",
                set_initial_mode, record_initial_mode},
    OptionField{
        "event.integrator", "dopri5, dop853, radau5, radau9, radau13, taylor",
        "Runge-Kutta of order 5, of order 8, of order 5, 9, 13 for stiff models; Taylor series where modes are affine.",
        set_engine<integrator_of, integrators>, record_choice<integrator_of, integrators>},
    OptionField{"event.max_step", "none, or a number > 0", "Longest step.", set_max_step, record_max_step},
    truth_field<local_steps_of>("event.local_steps", "true, false",
                                "Of many states only those that a switch moves are integrated anew behind it."),
    choice_field<selection_of, selections>("event.selection", "active_dominant, passive_dominant, scaled, report",
                                           "Which motion, where that depends on how surfaces are scaled."),
    OptionField{"event.scaling.*", "a finite number > 0", "Scale of a surface for selection = \"scaled\".", set_scaling,
                record_scaling},
    OptionField{
        "event.branches", "report, all, or a whole number >= 1",
        "Other admissible motions: only listed in the events, or followed, so many trajectories at most (all: 64).",
        set_branches, record_branches},
    OptionField{"event.members", "a whole number >= 0",
                "Of every family of motions (departures at later times, spirals), with branches: followed so many.",
                set_members, record_count<members_of>},
    number_field<epsilon_of, Range::positive>(
        "smoothed.epsilon", "a finite number > 0",
        "Half width of the layer around every surface, in the units of its switching function."),
};

/// More rows than this do not fit into a result that anybody reads.
constexpr double most_rows = 2e7;

Error unknown_key(std::string_view key) {
  const auto last = std::string(key.substr(key.rfind('.') + 1));
  Error error{ErrorCode::unknown_name, fmt::format("unknown option simulate.{}", key), "", {}, {}};
  std::vector<std::string> nearest = nearest_names(std::string(key), simulate_keys());
  for (const auto& known : simulate_keys()) {  // the right name in the wrong table: simulate.integrator
    const auto known_last = known.substr(known.rfind('.') + 1);
    if (known_last == last && std::find(nearest.begin(), nearest.end(), known) == nearest.end())
      nearest.push_back(known);
  }
  error.remedy = nearest.empty() ? suggest(std::string(key), simulate_keys())
                                 : fmt::format("did you mean 'simulate.{}'?", fmt::join(nearest, "' or 'simulate."));
  return error;
}

}  // namespace

std::span<const OptionField> simulate_fields() {
  static const auto all = [] {
    std::vector<OptionField> list(fields.begin(), fields.end());
    const auto more = element_fields();
    list.insert(list.end(), more.begin(), more.end());
    return list;
  }();
  return all;
}

std::vector<std::string> simulate_keys() {
  std::vector<std::string> keys;
  for (const auto& field : simulate_fields()) {
    if (!field.key.ends_with('*')) keys.emplace_back(field.key);
  }
  return keys;
}

Expected<SimulateOptions> with_value(SimulateOptions options, std::string_view key, const OptionValue& value) {
  for (const auto& field : simulate_fields()) {
    const bool open = field.key.ends_with('*');
    const auto prefix = field.key.substr(0, field.key.size() - (open ? 1 : 0));
    const bool fits = open ? key.size() > prefix.size() && key.starts_with(prefix) : key == prefix;
    if (!fits) continue;
    return field.set(options, key.substr(prefix.size()), value).map([&] { return std::move(options); });
  }
  return tl::unexpected(unknown_key(key));
}

OptionRecord option_record(const SimulateOptions& options) { return record_of(options, "simulate", simulate_fields()); }

double number_of_rows(const OutputGrid& grid, double begin, double end) {
  if (const auto* points = std::get_if<NumberOfPoints>(&grid)) return static_cast<double>(points->points);
  if (const auto* every = std::get_if<EveryInterval>(&grid)) {
    return 1.0 + std::floor((end - begin) / every->interval * (1.0 + 1e-12));
  }
  const auto* at = std::get_if<AtTimes>(&grid);
  return at == nullptr ? 0.0 : static_cast<double>(at->times.size());
}

std::optional<OptionProblem> find_problem(const SimulateOptions& options) {
  const auto problem = [](std::string key, std::string message, std::string remedy) {
    return OptionProblem{std::move(key), {ErrorCode::invalid_option, std::move(message), std::move(remedy), {}, {}}};
  };
  if (!options.until) {
    return problem("until", "no end time", "write until = T in [simulate], or give --until T on the command line");
  }
  if (!(*options.until > options.from)) {
    return problem("until", fmt::format("until ({}) is not after from ({})", *options.until, options.from),
                   "choose until > from");
  }
  if (!(options.rtol + options.atol > 0.0)) {
    return problem("atol", "rtol and atol are both 0", "one of them must be positive, e.g. rtol = 1e-8");
  }
  if (options.method == Method::fesd && options.fesd.elements < 2) {
    return problem("fesd.elements", "switch detection needs at least 2 elements in a simulation step",
                   "choose elements = 2 or more, or method = \"timestepping\"");
  }
  for (const auto& [table, part] :
       {std::pair("fesd", &options.fesd), std::pair("timestepping", &options.timestepping)}) {
    constexpr long most_elements = 1000, most_steps = 1000000000;
    if (part->elements > most_elements || part->stages > most_elements || part->steps > most_steps) {
      return problem(fmt::format("{}.steps", table), fmt::format("[simulate.{}] asks for more than fits", table),
                     fmt::format("at most {} steps of {} elements are possible", most_steps, most_elements));
    }
  }
  if (options.method == Method::smoothed && !options.initial_mode.empty()) {
    return problem("method", "initial_mode has no meaning for method \"smoothed\", which decides no modes",
                   "leave initial_mode out, or use method = \"event\"");
  }
  if (!std::isfinite(*options.until - options.from)) {
    return problem("until", fmt::format("from {} to {} is longer than any number", options.from, *options.until),
                   "choose other units of time");
  }
  const double rows = number_of_rows(options.output, options.from, *options.until);
  if (!(rows <= most_rows)) {
    const bool points = std::holds_alternative<NumberOfPoints>(options.output);
    return problem(points ? "output.points" : "output.every", fmt::format("output of {:.3g} rows", rows),
                   fmt::format("at most {:.0e} are possible: choose {}", most_rows,
                               points ? "fewer points" : "a larger interval"));
  }
  if (const auto* grid = std::get_if<AtTimes>(&options.output)) {
    for (const double time : grid->times) {
      if (options.from <= time && time <= *options.until) continue;
      return problem(
          "output.times",
          fmt::format("output time {} lies outside the simulation from {} to {}", time, options.from, *options.until),
          "leave it out, or move `from` or `until`");
    }
  }
  return std::nullopt;
}

}  // namespace saltus::pipeline
