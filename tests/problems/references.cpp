#include "problems/references.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <limits>
#include <ostream>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "source_folder.hpp"

namespace saltus::problems {
namespace {

using nlohmann::json;

ReferenceEvent event_of(const json& entry) {
  ReferenceEvent event{.t = entry.at("t"),
                       .kind = entry.at("kind"),
                       .surfaces = entry.at("surfaces"),
                       .mode_before = std::nullopt,
                       .mode_after = entry.at("mode_after"),
                       .x = entry.at("x"),
                       .x_after = entry.contains("x_after") ? entry.at("x_after") : entry.at("x"),
                       .unique = true,
                       .alternatives = {}};
  if (!entry.at("mode_before").is_null()) event.mode_before = entry.at("mode_before").get<std::vector<int>>();
  if (entry.contains("unique")) event.unique = entry.at("unique").get<bool>();
  if (entry.contains("regions_after")) event.regions_after = entry.at("regions_after");
  const json alternatives = entry.value("alternatives", json::array());
  for (const json& other : alternatives) {
    event.alternatives.push_back({.mode = other.at("mode"), .alpha = other.at("alpha")});
  }
  return event;
}

/// Selections that are not determined are null, and not a number here.
std::vector<double> selections_of(const json& list) {
  std::vector<double> alpha;
  for (const json& value : list) {
    alpha.push_back(value.is_null() ? std::numeric_limits<double>::quiet_NaN() : value.get<double>());
  }
  return alpha;
}

ReferenceProblem problem_of(const json& entry) {
  ReferenceProblem problem;
  problem.model = entry.at("model");
  problem.variant = entry.value("case", "");
  problem.until = entry.at("until");
  problem.digits = entry.at("digits");
  const json overrides = entry.value("overrides", json::object());
  for (const auto& [name, value] : overrides.items()) {
    problem.overrides.emplace_back(name, value.get<double>());
  }
  const json initial_mode = entry.value("initial_mode", json::object());
  for (const auto& [name, value] : initial_mode.items()) {
    problem.initial_mode.emplace_back(name, value.get<int>());
  }
  for (const json& event : entry.at("events")) problem.events.push_back(event_of(event));
  problem.final_x = entry.at("final").at("x").get<std::vector<double>>();
  problem.final_mode = entry.at("final").at("mode").get<std::vector<int>>();
  problem.final_alpha = selections_of(entry.at("final").at("alpha"));
  problem.final_theta = entry.at("final").value("theta", std::vector<double>{});
  return problem;
}

std::vector<ReferenceProblem> read() {
  std::ifstream file(tests::source_folder("tests/problems/references.json"));
  if (!file) throw std::runtime_error("cannot open tests/problems/references.json");
  std::vector<ReferenceProblem> problems;
  const json document = json::parse(file);
  for (const json& entry : document.at("problems")) problems.push_back(problem_of(entry));
  return problems;
}

}  // namespace

const std::vector<ReferenceProblem>& references() {
  static const std::vector<ReferenceProblem> problems = read();
  return problems;
}

const ReferenceProblem& reference(const std::string& model) {
  const auto is_plain = [&](const ReferenceProblem& p) { return p.model == model && p.variant.empty(); };
  const auto found = std::find_if(references().begin(), references().end(), is_plain);
  if (found == references().end()) throw std::runtime_error("no reference for model " + model);
  return *found;
}

std::string test_name(const ReferenceProblem& problem) {
  std::string name = problem.variant.empty() ? problem.model : problem.model + " " + problem.variant;
  const auto is_other = [](unsigned char c) { return std::isalnum(c) == 0; };
  std::replace_if(name.begin(), name.end(), is_other, '_');
  return name;
}

void PrintTo(const ReferenceProblem& problem, std::ostream* out) { *out << test_name(problem); }

std::vector<std::string> catalogue() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(tests::source_folder("models"))) {
    if (entry.path().extension() == ".toml") names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace saltus::problems
