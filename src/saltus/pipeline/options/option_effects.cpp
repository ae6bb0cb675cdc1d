#include "saltus/pipeline/options/option_effects.hpp"

#include <array>

#include <fmt/format.h>

#include "saltus/base/enum_names.hpp"

namespace saltus::pipeline {
namespace {

constexpr EnumNames<Method::smoothed> method_names("event", "fesd", "timestepping", "smoothed");

/// Of the method "event", which the other methods do not look at; "smoothed" takes its steps with that engine.
std::string without_event_method(Method method, std::string_view key) {
  if (method == Method::smoothed && key == "event.max_step") return "";
  if (method == Method::smoothed && key == "event.integrator") return "method \"smoothed\" takes its steps with radau5";
  return fmt::format("it is for method \"event\", and this is method \"{}\"", name(method));
}

std::string within_elements(const SimulateOptions& options, std::string_view key) {
  const bool fixed = options.method == Method::timestepping;
  const auto equilibration = options.fesd.step_equilibration;
  if (fixed && (key == "step_bounds" || key == "rho" || key == "equilibration_scale" || key == "step_equilibration")) {
    return "elements of method \"timestepping\" have fixed lengths";
  }
  const bool scaled = equilibration == StepEquilibration::l2_relaxed_scaled;
  const bool weighted = scaled || equilibration == StepEquilibration::l2_relaxed ||
                        equilibration == StepEquilibration::heuristic_mean ||
                        equilibration == StepEquilibration::heuristic_diff;
  if (key == "rho" && !weighted) return "this step_equilibration has no objective terms to be weighted";
  if (key == "equilibration_scale" && !scaled) return "it is the scale of step_equilibration = \"l2_relaxed_scaled\"";
  return "";
}

}  // namespace

std::string_view name(Method method) { return method_names(method); }

bool is_of_method(const SimulateOptions& options, std::string_view key) {
  return key.substr(0, key.find('.')) == name(options.method) && key.find('.') != std::string_view::npos;
}

std::string without_effect(const SimulateOptions& options, std::string_view key) {
  const bool elements = options.method == Method::fesd || options.method == Method::timestepping;
  if (elements && (key == "rtol" || key == "atol")) {
    return fmt::format("the accuracy of method \"{}\" is that of its steps (steps, stages)", name(options.method));
  }
  if (key.starts_with("event.scaling.") && options.method == Method::event &&
      options.event.selection != Selection::scaled)
    return "it is for selection = \"scaled\"";
  if (key == "event.members" && options.method == Method::event && options.event.trajectories == 1)
    return "members of families are followed where branches are (--branch all)";
  const auto table = key.substr(0, key.find('.'));
  if (elements && is_of_method(options, key)) return within_elements(options, key.substr(table.size() + 1));
  if (table == "event" && options.method != Method::event) return without_event_method(options.method, key);
  constexpr std::array others{"smoothed", "fesd", "timestepping"};
  for (const std::string_view other : others) {
    if (table == other && table != name(options.method)) {
      return fmt::format("it is for method \"{}\", and this is method \"{}\"", other, name(options.method));
    }
  }
  return "";
}

}  // namespace saltus::pipeline
