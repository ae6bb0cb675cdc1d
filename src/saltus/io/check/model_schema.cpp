#include "saltus/io/check/model_schema.hpp"

#include <initializer_list>
#include <string_view>
#include <utility>

#include "saltus/io/check/option_schema_internal.hpp"
#include "saltus/io/json/json_reader_internal.hpp"
#include "saltus/pipeline/options/optimize_fields.hpp"
#include "saltus/pipeline/options/option_fields.hpp"

namespace saltus::io {
namespace {

using Members = std::initializer_list<std::pair<std::string_view, Json>>;

Json described(Json schema, std::string_view text) {
  schema["description"] = text;
  return schema;
}

Json reference(std::string_view definition) { return {{"$ref", fmt::format("#/$defs/{}", definition)}}; }

Json text(std::string_view meaning) { return described({{"type", "string"}}, meaning); }
Json truth(std::string_view meaning) { return described({{"type", "boolean"}}, meaning); }
Json one_of_words(const std::vector<std::string>& words, std::string_view meaning) {
  return described({{"enum", words}}, meaning);
}
Json list_of(Json item, std::string_view meaning) {
  return described({{"type", "array"}, {"items", std::move(item)}}, meaning);
}

/// A table with these keys and no others.
Json table(Members members, std::string_view meaning, const std::vector<std::string>& required = {}) {
  Json json = {{"type", "object"}, {"description", meaning}, {"properties", Json::object()}};
  for (const auto& [key, schema] : members) json["properties"][std::string(key)] = schema;
  json["additionalProperties"] = false;
  if (!required.empty()) json["required"] = required;
  return json;
}

/// A table of names that the user gives.
Json names(Json value, std::string_view meaning) {
  return {{"type", "object"},
          {"description", meaning},
          {"propertyNames", {{"pattern", "^[A-Za-z_][A-Za-z0-9_]*$"}}},
          {"additionalProperties", std::move(value)}};
}

/// A number or an expression, or a table with more about it.
Json or_table(Json in_table) { return {{"anyOf", Json::array({reference("expression"), std::move(in_table)})}}; }

Json bounded(bool may_be_free) {
  Json json = table({{"initial", reference("expression")},
                     {"lower", described(reference("expression"), "of [optimize]")},
                     {"upper", described(reference("expression"), "of [optimize]")},
                     {"unit", text("shown, not computed with")},
                     {"label", text("shown, not computed with")}},
                    "a value with bounds and names for people");
  if (may_be_free) json["properties"]["free"] = truth("[optimize] chooses it within its bounds");
  return json;
}

/// Puts a schema at a dotted key; tables on the way come into being. `*` stands for names of the model.
void put(Json& tables, std::string_view key, Json schema) {
  const auto dot = key.find('.');
  auto& entries = tables["properties"];
  if (dot == std::string_view::npos) {
    const std::string last(key);
    // `output` is a word, or a table of `output.every` and others.
    if (last == "*") {
      tables["additionalProperties"] = std::move(schema);
    } else if (entries.contains(last)) {
      entries[last] = {{"anyOf", Json::array({std::move(schema), entries[last]})}};
    } else {
      entries[last] = std::move(schema);
    }
    return;
  }
  const std::string first(key.substr(0, dot));
  if (!entries.contains(first)) {
    entries[first] = {{"type", "object"}, {"properties", Json::object()}, {"additionalProperties", false}};
  } else if (!entries[first].contains("properties")) {
    if (!entries[first].contains("anyOf")) {
      const Json word = entries[first];
      entries[first] = {{"anyOf", Json::array({word})}};
      entries[first]["anyOf"].push_back(
          {{"type", "object"}, {"properties", Json::object()}, {"additionalProperties", false}});
    }
    put(entries[first]["anyOf"].back(), key.substr(dot + 1), std::move(schema));
    return;
  }
  put(entries[first], key.substr(dot + 1), std::move(schema));
}

Json simulate_schema() {
  Json json = table({{"inputs", names(or_table(table({{"file", text("two columns, t and the value")},
                                                      {"result", text("a stored result")},
                                                      {"times", list_of({{"type", "number"}}, "increasing")},
                                                      {"values", list_of({{"type", "number"}}, "from its time on")}},
                                                     "piecewise constant samples")),
                                      "values of controls")}},
                    "how to simulate");
  for (const auto& field : pipeline::simulate_fields()) {
    put(json, field.key, described(option_schema(field.kind), fmt::format("{} ({})", field.doc, expects(field.kind))));
  }
  return json;
}

/// Of a key of [optimize] that states the problem.
Json problem_schema(std::string_view key) {
  const Json expression = reference("expression");
  const Json expressions = list_of(expression, "expressions");
  if (key == "horizon") {
    return or_table(table({{"free", truth("chosen within its bounds")},
                           {"initial", expression},
                           {"lower", expression},
                           {"upper", expression}},
                          "a length of time", {"initial"}));
  }
  if (key == "minimize_time") return {{"anyOf", Json::array({truth("the weight 1, or none"), expression})}};
  if (key == "path_constraints_at") return one_of_words({"intervals", "elements", "stages"}, "");
  if (key == "path_constraints" || key == "terminal_constraints") {
    const Json soft = table({{"constraint", text("a comparison")},
                             {"penalty", expression},
                             {"norm", one_of_words({"l1", "l2", "linf"}, "of its violation")}},
                            "a soft constraint", {"constraint", "penalty"});
    return list_of({{"anyOf", Json::array({text("a comparison"), soft})}}, "");
  }
  if (key == "path_complementarities") return list_of(expressions, "");
  if (key == "initial_guess") return names(expression, "");
  if (key != "least_squares") return expression;
  const Json measured = table({{"file", text("rows of t and the references")},
                               {"rows", list_of(list_of({{"type", "number"}}, "a row"), "the same here")}},
                              "measurements: one of both");
  const Json references = {{"anyOf", Json::array({expressions, measured})}};
  const Json weights = {{"anyOf", Json::array({expression, expressions})}};
  return list_of(table({{"of", expressions},
                        {"reference", references},
                        {"weight", list_of(weights, "numbers, or a matrix")},
                        {"at", one_of_words({"intervals", "stages", "end", "times"}, "where they are compared")}},
                       "squares of distances to a reference", {"of"}),
                 "");
}

Json optimize_schema() {
  Json json = table({}, "an optimal control problem");
  for (const auto& field : pipeline::optimize_fields()) {
    put(json, field.key, described(option_schema(field.kind), fmt::format("{} ({})", field.doc, expects(field.kind))));
  }
  for (const auto& key : pipeline::problem_keys()) {
    put(json, key.key, described(problem_schema(key.key), fmt::format("{} ({})", key.doc, key.expects)));
  }
  return json;
}

Json jumps_schema() {
  return list_of(table({{"name", text("unique")},
                        {"when", described(reference("expression"), "a condition, or a guard with `direction`")},
                        {"direction", one_of_words({"down", "up", "both"}, "of a guard")},
                        {"every", described(reference("expression"), "a period, instead of `when`")},
                        {"at", list_of(reference("expression"), "times, instead of `when`")},
                        {"set", names(reference("expression"), "states and their new values")},
                        {"at_start", truth("also where the condition holds at the start")},
                        {"priority", reference("expression")},
                        {"delay", reference("expression")},
                        {"persistent", truth("executed also if the condition no longer holds")},
                        {"values", one_of_words({"trigger", "execution"}, "when the values are evaluated")}},
                       "a jump of states", {"set"}),
                 "states that change at once");
}

Json modes_schema() {
  return list_of(table({{"when", described(reference("expression"), "a condition, or \"otherwise\"")},
                        {"indicator", described(reference("expression"), "the smallest of a group is active")},
                        {"group", text("groups are summed")},
                        {"name", text("of a mode with an indicator")},
                        {"dynamics", names(reference("expression"), "right-hand sides in this mode")}},
                       "a region with its own equations", {"dynamics"}),
                 "piecewise equations");
}

Json mechanics_schema() {
  const Json expression = reference("expression");
  const Json point = list_of(expression, "two coordinates");
  return table({{"positions", list_of({{"type", "string"}}, "names of states")},
                {"velocities", list_of({{"type", "string"}}, "names of states, in the same order")},
                {"mass", list_of(list_of(expression, "a row"), "a matrix over positions; the identity without")},
                {"potential", described(expression, "over positions; its gradient is a force")},
                {"coriolis", one_of_words({"none", "auto"}, "forces that follow from the mass matrix")},
                {"force", names(expression, "of velocities")},
                {"draw", list_of(table({{"line", list_of(point, "points")},
                                        {"point", point},
                                        {"radius", described(expression, "of a disc around `point`")}},
                                       "a line or a disc"),
                                 "what reports show")}},
               "bodies", {"positions", "velocities"});
}

Json contacts_schema() {
  const Json tangent = names(reference("expression"), "a row over the positions");
  return list_of(table({{"name", text("unique")},
                        {"gap", described(reference("expression"), "what is not negative, over positions")},
                        {"tangent", tangent},
                        {"tangents", list_of(tangent, "two, in space")},
                        {"friction", described(reference("expression"), "coefficient; 0 without")},
                        {"restitution", described(reference("expression"), "0 to 1; 0 without")}},
                       "where two bodies may touch", {"name", "gap"}),
                 "contacts of the bodies of [mechanics]");
}

Json hysteresis_schema() {
  return list_of(table({{"name", text("what is 0 or 1")},
                        {"input", described(reference("expression"), "over states and parameters")},
                        {"on", described(reference("expression"), "threshold at which it becomes 1")},
                        {"off", described(reference("expression"), "threshold at which it becomes 0")},
                        {"initial", described(reference("expression"), "0 or 1; 0 without")}},
                       "a relay with two thresholds", {"name", "input", "on", "off"}),
                 "relays with hysteresis");
}

Json time_freezing_schema() {
  const Json expression = reference("expression");
  return table({{"clock", text("the state that is physical time, where jumps are frozen by hand")},
                {"speed", table({{"lower", expression}, {"upper", expression}}, "bounds of the speed of time",
                                {"lower", "upper"})},
                {"a_n", described(expression, "rate of the auxiliary dynamics")},
                {"stiffness", described(expression, "of elastic impacts in earlier versions; has no effect")},
                {"stabilisation", or_table(table({{"initial", expression}, {"final", expression}},
                                                 "followed down by the homotopy", {"initial"}))},
                {"transfer", described(expression, "length of a switch of [[hysteresis]] in numerical time")},
                {"eps_t", described(expression, "tangential speed up to which a contact with two tangents sticks")},
                {"penetration", described(expression, "largest one; inf for none")},
                {"correction", described(expression, "of gaps that are held")}},
               "impacts and hysteresis for finite elements");
}

Json root_properties() {
  Json properties;
  properties["model"] = table({{"name", text("required")},
                               {"description", text("one line")},
                               {"inclusion", one_of_words({"filippov", "aizerman_pyatnitskii"}, "on surfaces")}},
                              "what the file is", {"name"});
  properties["parameters"] = names(or_table(bounded(true)), "constants");
  properties["states"] = names(or_table(bounded(true)), "names and initial values");
  properties["controls"] = names(or_table(bounded(false)), "piecewise constant inputs");
  properties["definitions"] = names(reference("expression"), "named intermediate expressions");
  properties["switching"] = names(reference("expression"), "named switching functions");
  properties["dynamics"] = names(reference("expression"), "right-hand side of every state");
  properties["modes"] = modes_schema();
  properties["jumps"] = jumps_schema();
  properties["outputs"] = names(
      {{"anyOf",
        Json::array({reference("expression"),
                     table({{"value", reference("expression")}, {"unit", text("shown")}, {"label", text("shown")}},
                           "a value with names for people", {"value"}),
                     list_of({{"type", "string"}}, "`record`: names of definitions")})}},
      "named quantities, recorded beside the states");
  properties["events"] =
      list_of(table({{"name", text("unique")},
                     {"when", described(reference("expression"), "its zeros, or the edges of a condition")},
                     {"direction", one_of_words({"up", "down", "both"}, "of the zero")},
                     {"stop", truth("end the simulation there")}},
                    "an event to record or to stop at", {"when"}),
              "zeros to record");
  properties["tables"] = names(table({{"x", list_of({{"type", "number"}}, "increasing")},
                                      {"y", list_of({{"type", "number"}}, "values")},
                                      {"file", text("two columns")},
                                      {"kind", one_of_words({"linear", "cubic"}, "between the points")}},
                                     "a function of one argument"),
                               "functions by points");
  properties["simulate"] = simulate_schema();
  properties["optimize"] = optimize_schema();
  properties["time_freezing"] = time_freezing_schema();
  properties["mechanics"] = mechanics_schema();
  properties["contacts"] = contacts_schema();
  properties["hysteresis"] = hysteresis_schema();
  return properties;
}

}  // namespace

std::string model_schema() {
  Json schema = {{"$schema", "https://json-schema.org/draft/2020-12/schema"},
                 {"title", "Saltus model file"},
                 {"type", "object"},
                 {"properties", root_properties()},
                 {"required", {"model"}},
                 {"additionalProperties", false}};
  schema["$defs"]["expression"] = {{"type", {"number", "string"}},
                                   {"description", "a number, or an expression in quotes"}};
  return schema.dump(2) + "\n";
}

}  // namespace saltus::io
