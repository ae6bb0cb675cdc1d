// [optimize] and [time_freezing].
#include <algorithm>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "saltus/expression/parser.hpp"
#include "saltus/io/constant_value_internal.hpp"
#include "saltus/io/optimize/toml_optimize_internal.hpp"
#include "saltus/io/toml/toml_sections_internal.hpp"
#include "saltus/io/toml/toml_words_internal.hpp"
#include "saltus/pipeline/options/optimize_fields.hpp"

namespace saltus::io {
namespace {

using result::OptionValue;

Error problem_mistake(std::string message, std::string remedy, const SourceLocation& location) {
  return {ErrorCode::invalid_option, std::move(message), std::move(remedy), location, {}};
}

const std::vector<std::pair<std::string, model::ConstraintPoints>> constraint_points{
    {"intervals", model::ConstraintPoints::intervals},
    {"elements", model::ConstraintPoints::elements},
    {"stages", model::ConstraintPoints::stages}};

/// One of the options of the numerical method.
void read_option_of_optimize(TomlReader& reader, const std::string& key, const TomlEntry& entry, ModelFile& model) {
  const auto known = pipeline::with_value(*model.optimize, key, false);
  const bool unknown = !known && known.error().code == ErrorCode::unknown_name;
  const auto value =
      unknown ? std::optional<OptionValue>(std::in_place, false) : read_option_value(reader, entry.value);
  if (!value) return;
  auto options = pipeline::with_value(*model.optimize, key, *value);
  if (options) {
    model.optimize = std::move(*options);
    model.optimize_locations.emplace_back(key, entry.value.location);
    return;
  }
  auto error = options.error();
  error.location = unknown ? entry.location : entry.value.location;
  if (!unknown && error.code != ErrorCode::not_available)
    error.message = fmt::format("{}: {}", entry.key, error.message);
  reader.fail(std::move(error));
}

void read_mpcc(TomlReader& reader, const TomlEntry& entry, ModelFile& model) {
  const auto* table = reader.table(entry.value, "the table [optimize.mpcc]");
  if (table == nullptr) return;
  for (const auto& field : *table) read_option_of_optimize(reader, fmt::format("mpcc.{}", field.key), field, model);
}

/// true, false, or a weight.
expression::NodePtr read_time_weight(TomlReader& reader, const TomlValue& value) {
  const auto* truth = std::get_if<bool>(&value.value);
  if (truth == nullptr) return reader.expression(value);
  return *truth ? expression::number(1.0, value.location) : nullptr;
}

/// [["q", "u"], ["v", "w"]].
void read_complementarities(TomlReader& reader, const TomlEntry& entry, model::OcpDescription& problem) {
  constexpr std::string_view expected = "a list of pairs, e.g. [[\"q\", \"u\"]]";
  const auto* list = std::get_if<TomlArray>(&entry.value.value);
  if (list == nullptr) {
    reader.wrong_type(expected, entry.value);
    return;
  }
  for (const auto& element : *list) {
    const auto* pair = std::get_if<TomlArray>(&element.value);
    if (pair == nullptr) {
      reader.wrong_type("a pair of expressions, e.g. [\"q\", \"u\"]", element);
    } else if (pair->size() != 2) {
      reader.fail(problem_mistake(fmt::format("a complementarity has two sides, found {}", pair->size()),
                                  "write [\"q\", \"u\"] for 0 <= q _|_ u >= 0", element.location));
    } else {
      problem.path_complementarities.push_back(
          {reader.expression((*pair)[0]), reader.expression((*pair)[1]), element.location});
    }
  }
}

/// { q = "t" } or { result = "r.json" }.
void read_guess(TomlReader& reader, const TomlEntry& entry, ModelFile& model) {
  const auto* table = reader.table(entry.value, "a table like { q = \"t\" } or { result = \"r.json\" }");
  if (table == nullptr) return;
  for (const auto& field : *table) {
    if (field.key != "result") {
      model.description.optimize->guess.push_back({field.key, reader.expression(field.value), field.location});
    } else if (table->size() > 1) {
      reader.fail(problem_mistake("initial_guess has a result and other entries",
                                  "write either { result = \"r.json\" } or expressions", field.location));
    } else {
      const auto name = reader.string(field.value, "a file name in quotes");
      model.optimize->start_result = beside(reader.file(), name).string();
      model.optimize_locations.emplace_back("initial_guess.result", field.value.location);
    }
  }
}

/// { mu = 0.7 }.
void read_plant(TomlReader& reader, const TomlEntry& entry, model::OcpDescription& problem) {
  const auto* table = reader.table(entry.value, "a table of parameters and initial values like { mu = 0.7 }");
  if (table == nullptr) return;
  for (const auto& field : *table) problem.plant.push_back({field.key, reader.expression(field.value)});
}

void read_all_least_squares(TomlReader& reader, const TomlEntry& entry, model::OcpDescription& problem) {
  for (const auto& value : reader.tables(entry.value, "optimize.least_squares"))
    problem.least_squares.push_back(read_least_squares(reader, value));
}

/// A number or { free = true, initial, lower, upper }.
model::HorizonDescription read_horizon(TomlReader& reader, const TomlEntry& entry) {
  model::HorizonDescription horizon;
  horizon.location = entry.value.location;
  const auto* table = std::get_if<TomlTable>(&entry.value.value);
  if (table == nullptr) horizon.value = reader.expression(entry.value);
  for (const auto& field : table != nullptr ? *table : TomlTable{}) {
    if (field.key == "initial") {
      horizon.value = reader.expression(field.value);
    } else if (field.key == "lower") {
      horizon.lower = reader.bound(field.value);
    } else if (field.key == "upper") {
      horizon.upper = reader.bound(field.value);
    } else if (field.key == "free") {
      horizon.free = reader.boolean(field.value);
    } else {
      reader.unknown_key(field, {"free", "initial", "lower", "upper"});
    }
  }
  if (!horizon.value) {
    reader.fail(problem_mistake("the horizon has no initial value",
                                "write horizon = { free = true, initial = 10, lower = 1, upper = 100 }",
                                horizon.location));
    return horizon;
  }
  if (!horizon.free) horizon.lower = horizon.upper = nullptr;
  if (horizon.free) check_free(reader, "the horizon", horizon.value, horizon.lower, horizon.upper, horizon.location);
  for (const auto& bound : {horizon.value, horizon.lower}) {
    const auto number = bound ? constant_value(*bound) : std::nullopt;
    if (!number || *number > 0.0) continue;
    reader.fail(problem_mistake(fmt::format("horizon: expected a length of time > 0, found {}", *number),
                                "write horizon = 10, counted from `from`", bound->location));
  }
  return horizon;
}

/// What is minimised and constrained; whether the key was one of those.
bool read_problem_key(TomlReader& reader, const TomlEntry& entry, ModelFile& model) {
  auto& problem = *model.description.optimize;
  const auto& [key, location, value] = entry;
  if (key == "from") {
    problem.from = reader.expression(value);
  } else if (key == "horizon") {
    problem.horizon = read_horizon(reader, entry);
  } else if (key == "running_cost") {
    problem.running_cost = reader.expression(value);
  } else if (key == "terminal_cost") {
    problem.terminal_cost = reader.expression(value);
  } else if (key == "minimize_time") {
    problem.time_weight = read_time_weight(reader, value);
  } else if (key == "path_constraints") {
    problem.path_constraints = read_constraints(reader, entry);
  } else if (key == "terminal_constraints") {
    problem.terminal_constraints = read_constraints(reader, entry);
  } else if (key == "path_constraints_at") {
    problem.path_constraints_at = read_enum(reader, value, constraint_points, problem.path_constraints_at);
  } else if (key == "path_complementarities") {
    read_complementarities(reader, entry, problem);
  } else if (key == "initial_guess") {
    read_guess(reader, entry, model);
  } else if (key == "plant") {
    read_plant(reader, entry, problem);
  } else if (key == "least_squares") {
    read_all_least_squares(reader, entry, problem);
  } else {
    return false;
  }
  return true;
}

/// { lower = 1, upper = 100 }.
void read_speed(TomlReader& reader, const TomlEntry& entry, model::ClockDescription& clock) {
  const auto* table = reader.table(entry.value, "a table { lower = 1, upper = 100 }");
  if (table == nullptr) return;
  for (const auto& field : *table) {
    if (field.key == "lower") {
      clock.speed_lower = reader.expression(field.value);
    } else if (field.key == "upper") {
      clock.speed_upper = reader.expression(field.value);
    } else {
      reader.unknown_key(field, {"lower", "upper"});
    }
  }
  if (!clock.speed_lower || !clock.speed_upper) {
    reader.fail(
        problem_mistake("speed needs two bounds", "write speed = { lower = 1, upper = 100 }", entry.value.location));
    return;
  }
  const auto lower = constant_value(*clock.speed_lower), upper = constant_value(*clock.speed_upper);
  if (lower && !(*lower > 0.0)) {
    reader.fail(problem_mistake(fmt::format("speed: expected lower > 0, found {}", *lower),
                                "time goes on: choose a positive bound", entry.value.location));
  } else if (lower && upper && *lower > *upper) {
    reader.fail(problem_mistake(fmt::format("speed: lower ({}) is above upper ({})", *lower, *upper),
                                "choose lower <= upper", entry.value.location));
  }
}

}  // namespace

void check_free(TomlReader& reader, const std::string& what, const expression::NodePtr& initial,
                const expression::NodePtr& lower, const expression::NodePtr& upper, const SourceLocation& location) {
  if (reader.failed()) return;
  if (!lower || !upper) {
    reader.fail(problem_mistake(fmt::format("{} is free and has no {} bound", what,
                                            lower   ? "upper"
                                            : upper ? "lower"
                                                    : "lower and no upper"),
                                "what is optimised needs finite numbers or expressions for `lower` and `upper`",
                                location));
    return;
  }
  const auto from = constant_value(*lower), to = constant_value(*upper);
  if (from && to && *from > *to) {
    reader.fail(problem_mistake(fmt::format("{}: lower ({}) is above upper ({})", what, *from, *to),
                                "choose lower <= initial <= upper", location));
  }
  const auto begin = initial ? constant_value(*initial) : std::nullopt;
  if (begin && ((from && *begin < *from) || (to && *begin > *to))) {
    reader.fail(problem_mistake(fmt::format("{}: initial ({}) is {}", what, *begin,
                                            from && *begin < *from ? fmt::format("below lower ({})", *from)
                                                                   : fmt::format("above upper ({})", *to)),
                                "choose lower <= initial <= upper", location));
  }
}

void read_optimize_key(TomlReader& reader, const TomlEntry& entry, ModelFile& model) {
  if (entry.key == "mpcc") {
    read_mpcc(reader, entry, model);
  } else if (!read_problem_key(reader, entry, model)) {
    read_option_of_optimize(reader, entry.key, entry, model);
  }
}

void read_optimize(TomlReader& reader, const TomlEntry& entry, ModelFile& model) {
  const auto* table = reader.table(entry.value, "the table [optimize]");
  if (table == nullptr) return;
  model.optimize.emplace();
  model.description.optimize.emplace();
  model.description.optimize->location = entry.location;
  for (const auto& field : *table) read_optimize_key(reader, field, model);
}

constexpr double unlimited = std::numeric_limits<double>::infinity();

/// A key of [time_freezing] that is a number or an expression of parameters; nothing if it is no such key.
expression::NodePtr* freezing_number(model::ClockDescription& clock, const std::string& key) {
  for (const auto& [name, node] : {std::pair{"a_n", &clock.a_n}, std::pair{"stiffness", &clock.stiffness},
                                   std::pair{"transfer", &clock.transfer}, std::pair{"penetration", &clock.penetration},
                                   std::pair{"correction", &clock.correction}, std::pair{"eps_t", &clock.eps_t}}) {
    if (key == name) return node;
  }
  return nullptr;
}

void read_freezing_number(TomlReader& reader, const TomlEntry& field, expression::NodePtr& node) {
  const bool may_be_infinite = field.key == "penetration";
  node = may_be_infinite ? reader.bound(field.value) : reader.expression(field.value);
  if (!node) node = expression::number(unlimited, field.value.location);
  const auto value = node ? constant_value(*node) : std::nullopt;
  const bool may_vanish =
      field.key == "stabilisation" || field.key == "initial" || field.key == "final" || field.key == "correction";
  if (!value || *value > 0.0 || (may_vanish && *value == 0.0)) return;
  reader.fail(with_context({ErrorCode::invalid_model,
                            fmt::format("{} is {}", field.key, *value),
                            may_vanish ? "it is a number that is 0 or positive" : "it is a positive number",
                            field.value.location,
                            {}},
                           "in [time_freezing]"));
}

/// A number, or { initial = a, final = b }.
void read_stabilisation(TomlReader& reader, const TomlEntry& field, model::ClockDescription& clock) {
  const auto* table = std::get_if<TomlTable>(&field.value.value);
  clock.stabilisation_initial = nullptr;
  if (table == nullptr) return read_freezing_number(reader, field, clock.stabilisation);
  for (const auto& entry : *table) {
    if (entry.key == "initial") {
      read_freezing_number(reader, entry, clock.stabilisation_initial);
    } else if (entry.key == "final") {
      read_freezing_number(reader, entry, clock.stabilisation);
    } else {
      reader.unknown_key(entry, {"initial", "final"});
    }
  }
  if (clock.stabilisation_initial) return;
  reader.fail(with_context({ErrorCode::invalid_model,
                            "stabilisation has no `initial`",
                            "write { initial = 10, final = 0 }, or a number",
                            field.value.location,
                            {}},
                           "in [time_freezing]"));
}

void read_time_freezing(TomlReader& reader, const TomlEntry& entry, ModelFile& model) {
  const auto* table = reader.table(entry.value, "the table [time_freezing]");
  if (table == nullptr) return;
  auto clock = model.description.clock.value_or(model::ClockDescription{});
  clock.location = entry.location;
  for (const auto& field : *table) {
    if (field.key == "clock") {
      clock.clock = reader.string(field.value, "the name of a state in quotes");
      clock.location = field.value.location;
    } else if (field.key == "speed") {
      read_speed(reader, field, clock);
    } else if (field.key == "stabilisation") {
      read_stabilisation(reader, field, clock);
    } else if (auto* number = freezing_number(clock, field.key)) {
      read_freezing_number(reader, field, *number);
    } else {
      reader.unknown_key(field, {"clock", "speed", "a_n", "stiffness", "stabilisation", "eps_t", "transfer",
                                 "penetration", "correction"});
    }
  }
  model.description.clock = std::move(clock);
}

}  // namespace saltus::io
