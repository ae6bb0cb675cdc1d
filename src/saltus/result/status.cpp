#include "saltus/result/status.hpp"

#include "saltus/base/enum_names.hpp"

namespace saltus::result {
namespace {

constexpr EnumNames<Termination::stopped_by_event> terminations("completed", "stopped_by_user", "iteration_limit",
                                                                "time_limit", "step_size_too_small",
                                                                "no_admissible_mode", "evaluation_failed",
                                                                "factorization_failed", "not_converged", "infeasible",
                                                                "verification_failed", "outside_class",
                                                                "stopped_by_event");

}  // namespace

std::string_view name(Termination termination) { return terminations(termination); }
std::optional<Termination> termination_named(std::string_view text) { return terminations.named(text); }

bool is_done(Termination termination) {
  return termination == Termination::completed || termination == Termination::stopped_by_event;
}

}  // namespace saltus::result
