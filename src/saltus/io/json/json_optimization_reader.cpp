// JSON -> Optimization.
#include <limits>

#include "saltus/io/json/json_optimization_internal.hpp"
#include "saltus/io/json/json_parts_internal.hpp"

namespace saltus::io {
namespace {

void read_count(JsonReader& reader, const Json& json, const std::string& path, const char* key, int& count) {
  const std::size_t number = read_number(reader, json, path, key);
  constexpr auto largest = std::numeric_limits<int>::max();
  if (number > static_cast<std::size_t>(largest)) {
    reader.fail(path + "/" + key, fmt::format("expected a number up to {}, found {}", largest, number));
  } else {
    count = static_cast<int>(number);
  }
}

void read_termination(JsonReader& reader, const Json& json, const std::string& path, result::Termination& termination) {
  reader.read_word(json, path, "termination", result::termination_named, "termination", termination);
}

void read_terms(JsonReader& reader, const Json& json, const std::string& path, result::ObjectiveTerms& terms) {
  reader.read_member(json, path, "running", terms.running);
  reader.read_member(json, path, "terminal", terms.terminal);
  reader.read_member(json, path, "least_squares", terms.least_squares);
  reader.read_member(json, path, "time", terms.time);
  reader.read_member(json, path, "penalties", terms.penalties);
}

result::ConstraintMultiplier read_multiplier(JsonReader& reader, const Json& json, const std::string& path) {
  result::ConstraintMultiplier multiplier;
  reader.read_member(json, path, "name", multiplier.name);
  reader.read_member(json, path, "time", multiplier.time);
  reader.read_member(json, path, "value", multiplier.value);
  return multiplier;
}

result::HomotopyStep read_homotopy_step(JsonReader& reader, const Json& json, const std::string& path) {
  result::HomotopyStep step;
  reader.read_word(json, path, "phase", result::homotopy_phase_named, "phase", step.phase);
  reader.read_member(json, path, "solver", step.solver);
  reader.read_member(json, path, "sigma", step.sigma);
  read_count(reader, json, path, "iterations", step.iterations);
  reader.read_member(json, path, "objective", step.objective);
  reader.read_member(json, path, "primal_infeasibility", step.primal_infeasibility);
  reader.read_member(json, path, "complementarity_residual", step.complementarity_residual);
  read_termination(reader, json, path, step.termination);
  reader.read_member(json, path, "seconds", step.seconds);
  reader.read_if_there(json, path, "message", step.message);
  return step;
}

void read_stationarity_type(JsonReader& reader, const Json& json, const std::string& path,
                            std::optional<result::StationarityType>& type) {
  std::optional<std::string> word;
  reader.read_member(json, path, "stationarity_type", word);
  if (!word) return;
  type = result::stationarity_type_named(*word);
  if (!type) reader.fail(path + "/stationarity_type", fmt::format("'{}' is no type of stationarity", *word));
}

void read_certificate(JsonReader& reader, const Json& json, const std::string& path, result::Certificate& certificate) {
  reader.read_member(json, path, "primal_infeasibility", certificate.primal_infeasibility);
  reader.read_member(json, path, "complementarity_residual", certificate.complementarity_residual);
  reader.read_member(json, path, "stationarity", certificate.stationarity);
  read_count(reader, json, path, "biactive", certificate.biactive);
  read_stationarity_type(reader, json, path, certificate.stationarity_type);
  reader.read_member(json, path, "b_stationary", certificate.b_stationary);
  reader.read_member(json, path, "lpcc_decrease", certificate.lpcc_decrease);
}

void read_open_loop(JsonReader& reader, const Json& json, const std::string& path, result::OpenLoop& open_loop) {
  reader.read_member(json, path, "end_state_error", open_loop.end_state_error);
  reader.read_member(json, path, "terminal_violation", open_loop.terminal_violation);
  read_termination(reader, json, path, open_loop.termination);
  reader.read_member(json, path, "amplification", open_loop.amplification);
  reader.read_member(json, path, "message", open_loop.message);
  reader.read_member(json, path, "t", open_loop.t);
  reader.read_member(json, path, "x", open_loop.x);
}

void read_penetration(JsonReader& reader, const Json& json, const std::string& path,
                      std::optional<result::Penetration>& penetration) {
  penetration.emplace();
  reader.read_member(json, path, "solution", penetration->solution);
  reader.read_member(json, path, "simulation", penetration->simulation);
}

void read_verification(JsonReader& reader, const Json& json, const std::string& path,
                       result::Verification& verification) {
  reader.read_member(json, path, "tolerance", verification.tolerance);
  reader.read_member(json, path, "interval_defect", verification.interval_defect);
  const auto* interval = reader.member(json, path, "interval");
  if (interval != nullptr && !interval->is_null()) {
    read_count(reader, json, path, "interval", verification.interval);
  }
  reader.read_member(json, path, "state", verification.state);
  reader.read_member(json, path, "switch_time_error", verification.switch_time_error);
  read_count(reader, json, path, "switches_missed", verification.switches_missed);
  read_count(reader, json, path, "switches_extra", verification.switches_extra);
  reader.read_member(json, path, "path_violation", verification.path_violation);
  reader.read_member(json, path, "message", verification.message);
  read_part(reader, json, path, "open_loop", read_open_loop, verification.open_loop);
  if (!json.is_object()) return;
  if (json.contains("closed_loop")) {
    read_part(reader, json, path, "closed_loop", read_open_loop, verification.closed_loop.emplace());
  }
  if (json.contains("penetration")) {
    read_part(reader, json, path, "penetration", read_penetration, verification.penetration);
  }
}

void read_optimization_statistics(JsonReader& reader, const Json& json, const std::string& path,
                                  result::OptimizationStatistics& statistics) {
  read_count(reader, json, path, "iterations", statistics.iterations);
  read_count(reader, json, path, "variables", statistics.variables);
  read_count(reader, json, path, "equations", statistics.equations);
  read_count(reader, json, path, "pairs", statistics.pairs);
  reader.read_member(json, path, "build_seconds", statistics.build_seconds);
  reader.read_member(json, path, "evaluation_seconds", statistics.evaluation_seconds);
  reader.read_member(json, path, "linear_algebra_seconds", statistics.linear_algebra_seconds);
  reader.read_member(json, path, "wall_seconds", statistics.wall_seconds);
}

void read_start_values(JsonReader& reader, const Json& json, const std::string& path, result::Optimization& values) {
  reader.read_member(json, path, "nodes", values.nodes);
  reader.read_member(json, path, "state_lower", values.state_lower);
  reader.read_member(json, path, "state_upper", values.state_upper);
  reader.read_member(json, path, "control_lower", values.control_lower);
  reader.read_member(json, path, "control_upper", values.control_upper);
  reader.read_member(json, path, "primal", values.primal);
  reader.read_member(json, path, "dual_rows", values.dual_rows);
  reader.read_member(json, path, "dual_lower", values.dual_lower);
  reader.read_member(json, path, "dual_upper", values.dual_upper);
}

}  // namespace

void read_optimization(JsonReader& reader, const Json& json, const std::string& path,
                       result::Optimization& optimization) {
  reader.read_member(json, path, "objective", optimization.objective);
  read_part(reader, json, path, "objective_terms", read_terms, optimization.terms);
  reader.read_member(json, path, "horizon", optimization.horizon);
  read_part(reader, json, path, "parameters", read_numbers, optimization.parameters);
  reader.read_member(json, path, "u", optimization.u);
  reader.read_member(json, path, "grid", optimization.grid);
  reader.read_member(json, path, "h", optimization.h);
  reader.read_if_there(json, path, "speed_of_time", optimization.speed_of_time);
  if (const auto* multipliers = reader.member(json, path, "multipliers")) {
    read_list(reader, *multipliers, path + "/multipliers", optimization.multipliers, read_multiplier);
  }
  if (const auto* homotopy = reader.member(json, path, "homotopy")) {
    read_list(reader, *homotopy, path + "/homotopy", optimization.homotopy, read_homotopy_step);
  }
  read_part(reader, json, path, "certificate", read_certificate, optimization.certificate);
  if (json.is_object() && json.contains("verification")) {
    read_part(reader, json, path, "verification", read_verification, optimization.verification.emplace());
  }
  read_part(reader, json, path, "statistics", read_optimization_statistics, optimization.statistics);
  read_part(reader, json, path, "start_values", read_start_values, optimization);
}

}  // namespace saltus::io
