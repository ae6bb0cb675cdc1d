// --set optimize.KEY=VALUE.
#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/contains.hpp"
#include "saltus/base/text.hpp"
#include "saltus/expression/parser.hpp"
#include "saltus/io/constant_value_internal.hpp"
#include "saltus/io/optimize/toml_optimize_internal.hpp"
#include "saltus/io/option_text.hpp"
#include "saltus/io/setting_values_internal.hpp"
#include "saltus/pipeline/options/optimize_fields.hpp"

namespace saltus::io {
namespace {

constexpr std::string_view optimize_root = "optimize.";
constexpr std::string_view plant_root = "plant.";

/// Keys that are one expression each.
struct ExpressionKey {
  std::string_view key;
  expression::NodePtr& (*place)(model::OcpDescription&);
};
constexpr std::array expression_keys{
    ExpressionKey{"from", [](auto& problem) -> expression::NodePtr& { return problem.from; }},
    ExpressionKey{"horizon", [](auto& problem) -> expression::NodePtr& { return problem.horizon.value; }},
    ExpressionKey{"horizon.initial", [](auto& problem) -> expression::NodePtr& { return problem.horizon.value; }},
    ExpressionKey{"horizon.lower", [](auto& problem) -> expression::NodePtr& { return problem.horizon.lower; }},
    ExpressionKey{"horizon.upper", [](auto& problem) -> expression::NodePtr& { return problem.horizon.upper; }},
    ExpressionKey{"running_cost", [](auto& problem) -> expression::NodePtr& { return problem.running_cost; }},
    ExpressionKey{"terminal_cost", [](auto& problem) -> expression::NodePtr& { return problem.terminal_cost; }},
    ExpressionKey{"minimize_time", [](auto& problem) -> expression::NodePtr& { return problem.time_weight; }},
};

/// Keys that are read as in a file, in place of what it says: a word, or a list of comparisons.
constexpr std::array<std::string_view, 3> whole_keys{"path_constraints", "terminal_constraints", "path_constraints_at"};

/// A list, or one comparison or word.
std::string toml_of(std::string_view given) {
  const auto value = trimmed(given);
  const bool is_list = value.starts_with('[') && value.ends_with(']');
  return is_list ? std::string(value) : fmt::format("\"{}\"", value);
}

/// Behind what the file states of it: the last value counts.
Expected<void> set_plant(ModelFile& model, std::string_view name, std::string_view value, const SourceLocation& place) {
  auto tree = expression::parse(value, place);
  if (!tree) return tl::unexpected(tree.error());
  model.description.optimize->plant.push_back({std::string(name), std::move(*tree)});
  return {};
}

Expected<void> set_truth(std::string_view key, std::string_view value, bool& truth) {
  if (value != "true" && value != "false") {
    return refused_setting(key, ErrorCode::invalid_option, fmt::format("expected true or false, found {}", value), "");
  }
  truth = value == "true";
  return {};
}

/// horizon and minimize_time take true and false, and a horizon is positive.
Expected<void> set_problem_expression(ModelFile& model, const ExpressionKey& found, std::string_view key,
                                      std::string_view value) {
  auto& problem = *model.description.optimize;
  if (found.key == "minimize_time" && (value == "true" || value == "false")) {
    problem.time_weight = value == "true" ? expression::number(1.0, place_of_setting(key)) : nullptr;
    return {};
  }
  std::vector<std::string> tables;
  for (const auto& table : model.description.tables) tables.push_back(table.name);
  auto tree = expression::parse(value, place_of_setting(key), tables);
  if (!tree) return tl::unexpected(tree.error());
  const auto number = constant_value(**tree);
  if (found.key.starts_with("horizon") && number && !(*number > 0.0)) {
    return refused_setting(key, ErrorCode::invalid_option,
                           fmt::format("horizon: expected a length of time > 0, found {}", *number),
                           "a horizon is counted from `from`");
  }
  if (found.key == "horizon") {  // a number is a fixed one
    problem.horizon.free = false;
    problem.horizon.lower = problem.horizon.upper = nullptr;
  }
  found.place(problem) = std::move(*tree);
  return {};
}

}  // namespace

Expected<void> set_optimize_option(ModelFile& model, std::string_view key, std::string_view value,
                                   const SourceLocation& location) {
  if (!model.optimize) {
    return tl::unexpected(
        Error{ErrorCode::invalid_option,
              "the model has no table [optimize]",
              "state the problem in the file: horizon, control_intervals, a cost; options change what is stated",
              location,
              {}});
  }
  const auto path = key.substr(std::min(optimize_root.size(), key.size()));
  auto options = pipeline::with_value(*model.optimize, path, option_value(value));
  if (!options) {
    options.error().location = location;
    return tl::unexpected(options.error());
  }
  model.optimize = std::move(*options);
  model.optimize_locations.emplace_back(path, location);
  return {};
}

Expected<void> set_optimize(ModelFile& model, std::string_view key, std::string_view value) {
  const auto place = place_of_setting(key);
  const auto path = key.substr(std::min(optimize_root.size(), key.size()));
  if (!model.optimize) return set_optimize_option(model, key, value, place);
  if ((path == "horizon" || path == "mpcc" || path == "plant") && is_table_text(value)) {
    // What the model says of the plant is that table.
    if (path == "plant") model.description.optimize->plant.clear();
    return set_table(model, key, value);
  }
  if (path.starts_with(plant_root)) return set_plant(model, path.substr(plant_root.size()), value, place);
  if (path == "horizon.free") return set_truth(key, value, model.description.optimize->horizon.free);
  if (path == "initial_guess.result") {
    model.optimize->start_result = std::string(value);
    model.optimize_locations.emplace_back(path, place);
    return {};
  }
  for (const auto& candidate : expression_keys) {
    if (candidate.key == path) return set_problem_expression(model, candidate, key, value);
  }
  if (contains(whole_keys, path)) {
    const std::string text = toml_of(value);
    const bool is_whole = path == "path_constraints_at" || text.starts_with('[');
    return set_table(model, key, is_whole ? text : fmt::format("[{}]", text));
  }
  const auto head = path.substr(0, path.find('.'));
  for (const auto& known : pipeline::problem_keys()) {
    if (known.key != head) continue;
    return refused_setting(key, ErrorCode::invalid_option, fmt::format("'{}' cannot be set on the command line", path),
                           "write a parameter there, and set that: --set NAME=VALUE");
  }
  return set_optimize_option(model, key, value, place);
}

}  // namespace saltus::io
