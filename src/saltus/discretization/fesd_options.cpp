#include "saltus/discretization/fesd_options.hpp"

#include "saltus/base/enum_names.hpp"

namespace saltus::discretization {
namespace {

constexpr EnumNames<CrossComplementarity::same_stage> cross_complementarities("stage_stage", "fe_stage", "stage_fe",
                                                                              "fe_fe", "paper", "same_stage");
constexpr EnumNames<StepEquilibration::paper> step_equilibrations("none", "heuristic_mean", "heuristic_diff",
                                                                  "l2_relaxed", "l2_relaxed_scaled", "direct", "mlcp",
                                                                  "paper");

}  // namespace

std::string_view name(Representation representation) {
  return representation == Representation::integral ? "integral" : "differential";
}

std::string_view name(CrossComplementarity cross_complementarity) {
  return cross_complementarities(cross_complementarity);
}

std::string_view name(StepEquilibration step_equilibration) { return step_equilibrations(step_equilibration); }

}  // namespace saltus::discretization
