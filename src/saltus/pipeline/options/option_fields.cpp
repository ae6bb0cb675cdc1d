#include "saltus/pipeline/options/option_fields.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/contains.hpp"
#include "saltus/base/other_words.hpp"
#include "saltus/pipeline/options/option_values_internal.hpp"

namespace saltus::pipeline {
namespace {

// Access to a member, for reading and writing alike: the only place that names it.
constexpr auto until_of = [](auto& o) -> auto& { return o.until; };
constexpr auto from_of = [](auto& o) -> auto& { return o.from; };
constexpr auto begun_of = [](auto& o) -> auto& { return o.begun; };
constexpr auto method_of = [](auto& o) -> auto& { return o.method; };
constexpr auto rtol_of = [](auto& o) -> auto& { return o.rtol; };
constexpr auto atol_of = [](auto& o) -> auto& { return o.atol; };
constexpr auto continuous_of = [](auto& o) -> auto& { return o.continuous; };
constexpr auto error_estimate_of = [](auto& o) -> auto& { return o.error_estimate; };
constexpr auto native_of = [](auto& o) -> auto& { return o.native; };
constexpr auto max_steps_of = [](auto& o) -> auto& { return o.max_steps; };
constexpr auto members_of = [](auto& o) -> auto& { return o.event.members; };
constexpr auto max_events_of = [](auto& o) -> auto& { return o.max_events; };
constexpr auto integrator_of = [](auto& o) -> auto& { return o.event.integrator; };
constexpr auto local_steps_of = [](auto& o) -> auto& { return o.event.local_steps; };
constexpr auto epsilon_of = [](auto& o) -> auto& { return o.smoothed.epsilon; };
constexpr auto max_step_of = [](auto& o) -> auto& { return o.event.max_step; };
constexpr auto selection_of = [](auto& o) -> auto& { return o.event.selection; };

void record_until(const SimulateOptions& options, std::string_view key, OptionRecord& record) {
  if (options.until) record.emplace_back(key, *options.until);
}

constexpr Choices<Method, 4> methods{{"event", "smoothed", "fesd", "timestepping"},
                                     {Method::event, Method::smoothed, Method::fesd, Method::timestepping}};
constexpr Choices<Integrator, 7> integrators{
    {"auto", name(ode::Method::dopri5), name(ode::Method::dop853), name(ode::Method::radau5), name(ode::Method::radau9),
     name(ode::Method::radau13), name(ode::Method::taylor)},
    {Integrator::automatic, Integrator::dopri5, Integrator::dop853, Integrator::radau5, Integrator::radau9,
     Integrator::radau13, Integrator::taylor}};
/// An integrator where a method is expected.
void name_integrator(Error& error, const OptionValue& value) {
  const auto* word = std::get_if<std::string>(&value);
  if (word == nullptr || !error.remedy.empty()) return;
  const auto meant = nearest_words(*word, {integrators.names.begin(), integrators.names.end()});
  if (!meant.empty()) error.remedy = fmt::format("did you mean the integrator {}?", meant.front());
}

constexpr Choices<Native, 3> natives{{"auto", "on", "off"}, {Native::automatic, Native::on, Native::off}};
constexpr Choices<Selection, 4> selections{
    {"active_dominant", "passive_dominant", "scaled", "report"},
    {Selection::active_dominant, Selection::passive_dominant, Selection::scaled, Selection::report}};

constexpr std::array<std::string_view, 2> output_words{"auto", "steps"}, branch_words{"report", "all"};
constexpr std::array signs{-1, 0, 1};

void set_output_word(SimulateOptions& options, std::string_view, const OptionValue& value) {
  options.output = std::get<std::string>(value) == "auto" ? OutputGrid(Automatic{}) : OutputGrid(EveryStep{});
  // A word stands for the whole table: what a table before it left out is there again.
  options.event_rows = std::nullopt;
  options.kept = {};
}

void set_event_rows(SimulateOptions& options, std::string_view, const OptionValue& value) {
  options.event_rows = std::get<bool>(value);
}

void record_event_rows(const SimulateOptions& options, std::string_view key, OptionRecord& record) {
  record.emplace_back(key, has_event_rows(options));
}

void name_output_tables(Error& error, const OptionValue&) {
  error.remedy =
      "or write a table: { every = a number }, { points = a whole number } or { times = [increasing numbers] }, also "
      "with events = false, states = [names], surfaces = [names]";
}

template <class Grid>
void set_output(SimulateOptions& options, std::string_view, const OptionValue& value) {
  if constexpr (std::is_same_v<Grid, EveryInterval>) options.output = EveryInterval{number_in(value)};
  if constexpr (std::is_same_v<Grid, NumberOfPoints>) {
    options.output = NumberOfPoints{static_cast<int>(number_in(value))};
  }
  if constexpr (std::is_same_v<Grid, AtTimes>) options.output = AtTimes{std::get<std::vector<double>>(value)};
}

/// A list of names; a word by itself is one name, and a list without anything in it can be one of numbers.
template <auto member>
void set_kept(SimulateOptions& options, std::string_view, const OptionValue& value) {
  auto& kept = (options.kept.*member).emplace();
  if (const auto* names = std::get_if<std::vector<std::string>>(&value)) kept = *names;
  if (const auto* name = std::get_if<std::string>(&value)) kept = {*name};
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

/// No file has what it asks for.
void record_error_estimate(const SimulateOptions& options, std::string_view key, OptionRecord& record) {
  if (options.error_estimate) record.emplace_back(key, true);
}

void record_continuous(const SimulateOptions& options, std::string_view key, OptionRecord& record) {
  if (options.continuous) record.emplace_back(key, true);
}

void set_initial_mode(SimulateOptions& options, std::string_view name, const OptionValue& value) {
  put(options.initial_mode, name, static_cast<int>(number_in(value)));
}

void set_scaling(SimulateOptions& options, std::string_view name, const OptionValue& value) {
  put(options.event.scaling, name, number_in(value));
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

void set_branches(SimulateOptions& options, std::string_view, const OptionValue& value) {
  constexpr long all = 64;
  const auto* word = std::get_if<std::string>(&value);
  options.event.trajectories = word == nullptr ? static_cast<long>(number_in(value)) : *word == "all" ? all : 1;
}

void record_branches(const SimulateOptions& options, std::string_view key, OptionRecord& record) {
  if (options.event.trajectories == 1) {
    record.emplace_back(key, std::string("report"));
  } else {
    record.emplace_back(key, std::int64_t{options.event.trajectories});
  }
}

constexpr std::array fields{
    OptionField{"until",
                {.number = Numbers{.above_option = "from"}},
                "End of the simulation; there is no default, but the last of `output.times` where they are given.",
                set_number<until_of, SimulateOptions>,
                record_until},
    number_field<from_of>("from", any_number, "Start of the simulation."),
    number_or_none_field<begun_of, none_word>(
        "begun", any_number,
        "Of a run that goes on: start of the first one. `every` counts from there; what was due by `from` is done."),
    choice_field<method_of, methods>(
        "method", "Event-driven; regularised; finite elements with switch detection; the same without it.",
        name_integrator),
    number_field<rtol_of>("rtol", positive_number, "Relative error tolerance of a step, per component of the state."),
    number_field<atol_of>("atol", not_negative_number,
                          "Absolute error tolerance of a step, in the units of the states."),
    OptionField{"output",
                {.words = output_words},
                "Rows at steps, and between them so that straight lines are within 1e-3 of every column's range.",
                set_output_word,
                record_output_word,
                name_output_tables},
    OptionField{"output.every",
                {.number = positive_number},
                "Instead: a row every so often, counted from `from`.",
                set_output<EveryInterval>,
                record_output<EveryInterval>},
    OptionField{"output.points",
                {.number = Numbers{.whole = true, .from = 2.0, .up_to = 1e9}},
                "Instead: so many rows, both ends among them.",
                set_output<NumberOfPoints>,
                record_output<NumberOfPoints>},
    OptionField{
        "output.times",
        {.list = ListOf::increasing_numbers},
        "Instead: exactly these rows within the span, at a jump the one after it; those at events with events = true.",
        set_output<AtTimes>,
        record_output<AtTimes>},
    OptionField{"output.events",
                {.truth = true},
                "Rows before and after every event; without them (with `times` unless true) no time has two rows.",
                set_event_rows,
                record_event_rows},
    OptionField{"output.states",
                {.list = ListOf::names, .pattern = "v*"},
                "Rows have these states only; end state and events stay complete. Default: all.",
                set_kept<&KeptNames::states>,
                record_kept<&KeptNames::states>},
    OptionField{"output.surfaces",
                {.list = ListOf::names, .pattern = "s*"},
                "Rows have the modes and selections of these switching functions only. Default: all.",
                set_kept<&KeptNames::surfaces>,
                record_kept<&KeptNames::surfaces>},
    OptionField{"error_estimate",
                {.truth = true},
                "Errors of rows, event times and the end by a second run at smaller tolerances. Default: false.",
                set_truth<error_estimate_of, SimulateOptions>,
                record_error_estimate},
    OptionField{"continuous",
                {.truth = true},
                "Polynomials of all steps are kept, for x(t) in programs. Default: false.",
                set_truth<continuous_of, SimulateOptions>,
                record_continuous},
    choice_field<native_of, natives>(
        "native", "Model functions as compiled code, bit-identical; auto: where it pays and there is a compiler."),
    number_field<max_steps_of>(
        "max_steps", counting_number,
        "Stop with iteration_limit after so many steps (fesd: elements, and divided simulation steps)."),
    number_field<max_events_of>("max_events", counting_number, "Stop with iteration_limit after so many events."),
    OptionField{"initial_mode.*",
                {.values = signs},
                "Force the side of a switching function at the start (0: slide on it), or a mode by `indicator`.",
                set_initial_mode,
                record_initial_mode},
    choice_field<integrator_of, integrators>(
        "event.integrator", "Chosen (auto), or Runge-Kutta of order 5, 8, 5, 9, 13 (radau: stiff), or Taylor series."),
    number_or_none_field<max_step_of, none_word>("event.max_step", positive_number, "Longest step."),
    truth_field<local_steps_of>("event.local_steps",
                                "Of many states only those that a switch moves are integrated again after it."),
    choice_field<selection_of, selections>("event.selection",
                                           "Which motion, where that depends on how surfaces are scaled."),
    OptionField{"event.scaling.*",
                {.number = positive_number},
                "Scale of a surface for selection = \"scaled\".",
                set_scaling,
                record_scaling},
    OptionField{
        "event.branches",
        {.words = branch_words, .number = counting_number},
        "Other admissible motions: only listed in the events, or followed, so many trajectories at most (all: 64).",
        set_branches,
        record_branches},
    number_field<members_of>(
        "event.members", Numbers{.whole = true, .from = 0.0},
        "Of every family of motions (departures at later times, spirals), with branches: followed so many."),
    number_field<epsilon_of>("smoothed.epsilon", positive_number,
                             "Half width of the layer around every surface, in the units of its switching function."),
};

/// More rows than this do not fit into a result that anybody reads.
constexpr double most_rows = 2e7;

Error unknown_key(std::string_view key) {
  const auto last = std::string(key.substr(key.rfind('.') + 1));
  Error error{ErrorCode::unknown_name, fmt::format("unknown option simulate.{}", key), "", {}, {}};
  std::vector<std::string> nearest = nearest_words(std::string(key), simulate_keys());
  for (const auto& known : simulate_keys()) {  // the right name in the wrong table: simulate.integrator
    const auto known_last = known.substr(known.rfind('.') + 1);
    if (known_last == last && !contains(nearest, known)) nearest.push_back(known);
  }
  error.remedy = nearest.empty() ? suggest_word(std::string(key), simulate_keys())
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
    return set_option(field, options, key.substr(prefix.size()), value).map([&] { return std::move(options); });
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

namespace {

OptionProblem problem(std::string key, std::string message, std::string remedy) {
  return {std::move(key), {ErrorCode::invalid_option, std::move(message), std::move(remedy), {}, {}}};
}

/// Of the times between which it is simulated.
std::optional<OptionProblem> find_problem_of_span(const SimulateOptions& options) {
  const auto until = end_time(options);
  if (!until) {
    return problem("until", "no end time", "write until = T in [simulate], or give --until T on the command line");
  }
  if (!(*until > options.from)) {
    return problem("until", fmt::format("until ({}) is not after from ({})", *until, options.from),
                   "choose until > from");
  }
  if (options.begun && *options.begun > options.from) {
    return problem("begun", fmt::format("begun ({}) is after from ({})", *options.begun, options.from),
                   "a run goes on at the end of one that began before");
  }
  if (!std::isfinite(*until - options.from)) {
    return problem("until", fmt::format("from {} to {} is longer than any number", options.from, *until),
                   "choose other units of time");
  }
  return std::nullopt;
}

std::optional<OptionProblem> find_problem_of_tolerances(const SimulateOptions& options) {
  if (options.rtol == 0.0 && options.atol == 0.0) {
    return problem("atol", "rtol and atol are both 0", "one of them must be positive, e.g. rtol = 1e-8");
  }
  return std::nullopt;
}

/// Of options one by one, which a program may have set to anything.
std::optional<OptionProblem> find_problem_of_values(const SimulateOptions& options) {
  for (const auto& field : simulate_fields()) {
    OptionRecord record;
    field.record(options, field.key, record);
    for (const auto& [key, value] : record) {
      if (auto fits = check(field.kind, value); !fits)
        return problem(key, fmt::format("{}: {}", key, fits.error().message), fits.error().remedy);
    }
  }
  return std::nullopt;
}

}  // namespace

std::optional<OptionProblem> find_problem(const SimulateOptions& options) {
  if (auto found = find_problem_of_span(options)) return found;
  if (auto found = find_problem_of_tolerances(options)) return found;
  if (auto found = find_problem_of_values(options)) return found;
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
  const double until = *end_time(options);
  const double rows = number_of_rows(options.output, options.from, until);
  if (!(rows <= most_rows)) {
    const bool points = std::holds_alternative<NumberOfPoints>(options.output);
    return problem(points ? "output.points" : "output.every", fmt::format("output of {:.3g} rows", rows),
                   fmt::format("at most {:.0e} are possible: choose {}", most_rows,
                               points ? "fewer points" : "a larger interval"));
  }
  if (const auto* grid = std::get_if<AtTimes>(&options.output)) {
    for (const double time : grid->times) {
      if (options.from <= time && time <= until) continue;
      return problem("output.times",
                     fmt::format("output time {} lies outside the simulation from {} to {}", time, options.from, until),
                     "leave it out, or move `from` or `until`");
    }
  }
  return std::nullopt;
}

}  // namespace saltus::pipeline
