// Optimization -> JSON.
#include "saltus/io/json/json_optimization_internal.hpp"
#include "saltus/io/json/json_parts_internal.hpp"

namespace saltus::io {
namespace {

Json terms_json(const result::ObjectiveTerms& terms) {
  return {{"running", terms.running},
          {"terminal", terms.terminal},
          {"least_squares", terms.least_squares},
          {"time", terms.time},
          {"penalties", terms.penalties}};
}

Json multipliers_json(const std::vector<result::ConstraintMultiplier>& multipliers) {
  Json json = Json::array();
  for (const auto& one : multipliers) json.push_back({{"name", one.name}, {"time", one.time}, {"value", one.value}});
  return json;
}

Json open_loop_json(const result::OpenLoop& open_loop) {
  return {{"end_state_error", open_loop.end_state_error},
          {"terminal_violation", open_loop.terminal_violation},
          {"termination", name(open_loop.termination)},
          {"amplification", open_loop.amplification},
          {"message", open_loop.message},
          {"t", open_loop.t},
          {"x", open_loop.x}};
}

Json verification_json(const result::Verification& verification) {
  Json json = {{"tolerance", verification.tolerance},
               {"interval_defect", verification.interval_defect},
               {"interval", verification.interval < 0 ? Json() : Json(verification.interval)},
               {"state", verification.state},
               {"switch_time_error", verification.switch_time_error},
               {"switches_missed", verification.switches_missed},
               {"switches_extra", verification.switches_extra},
               {"path_violation", verification.path_violation},
               {"message", verification.message},
               {"open_loop", open_loop_json(verification.open_loop)}};
  if (verification.closed_loop) json["closed_loop"] = open_loop_json(*verification.closed_loop);
  if (verification.penetration) {
    json["penetration"] = {{"solution", verification.penetration->solution},
                           {"simulation", verification.penetration->simulation}};
  }
  return json;
}

}  // namespace

Json homotopy_json(const std::vector<result::HomotopyStep>& steps) {
  Json list = Json::array();
  for (const auto& step : steps) {
    Json json = {{"phase", name(step.phase)},
                 {"solver", step.solver},
                 {"sigma", step.sigma},
                 {"iterations", step.iterations},
                 {"objective", step.objective},
                 {"primal_infeasibility", step.primal_infeasibility},
                 {"complementarity_residual", step.complementarity_residual},
                 {"termination", name(step.termination)},
                 {"seconds", step.seconds}};
    if (!step.message.empty()) json["message"] = step.message;
    list.push_back(std::move(json));
  }
  return list;
}

Json certificate_json(const result::Certificate& certificate) {
  const auto& type = certificate.stationarity_type;
  return {{"primal_infeasibility", certificate.primal_infeasibility},
          {"complementarity_residual", certificate.complementarity_residual},
          {"stationarity", certificate.stationarity},
          {"biactive", certificate.biactive},
          {"stationarity_type", type ? Json(name(*type)) : Json()},
          {"b_stationary", or_null(certificate.b_stationary)},
          {"lpcc_decrease", or_null(certificate.lpcc_decrease)}};
}

Json optimization_statistics_json(const result::OptimizationStatistics& statistics) {
  return {{"iterations", statistics.iterations},
          {"variables", statistics.variables},
          {"equations", statistics.equations},
          {"pairs", statistics.pairs},
          {"build_seconds", statistics.build_seconds},
          {"evaluation_seconds", statistics.evaluation_seconds},
          {"linear_algebra_seconds", statistics.linear_algebra_seconds},
          {"wall_seconds", statistics.wall_seconds}};
}

Json start_values_json(const result::Optimization& optimization) {
  return {{"nodes", optimization.nodes},
          {"state_lower", optimization.state_lower},
          {"state_upper", optimization.state_upper},
          {"control_lower", optimization.control_lower},
          {"control_upper", optimization.control_upper},
          {"primal", optimization.primal},
          {"dual_rows", optimization.dual_rows},
          {"dual_lower", optimization.dual_lower},
          {"dual_upper", optimization.dual_upper}};
}

void add_optimization(Json& json, const result::Optimization& optimization) {
  json["objective"] = optimization.objective;
  json["objective_terms"] = terms_json(optimization.terms);
  json["horizon"] = optimization.horizon;
  json["parameters"] = numbers_json(optimization.parameters);
  json["u"] = optimization.u;
  json["grid"] = optimization.grid;
  json["h"] = optimization.h;
  if (!optimization.speed_of_time.empty()) json["speed_of_time"] = optimization.speed_of_time;
  json["multipliers"] = multipliers_json(optimization.multipliers);
  json["homotopy"] = homotopy_json(optimization.homotopy);
  json["certificate"] = certificate_json(optimization.certificate);
  if (optimization.verification) json["verification"] = verification_json(*optimization.verification);
}

}  // namespace saltus::io
