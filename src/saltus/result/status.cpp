#include "saltus/result/status.hpp"

namespace saltus::result {

std::string_view name(Termination termination) {
  switch (termination) {
    case Termination::completed:
      return "completed";
    case Termination::stopped_by_user:
      return "stopped_by_user";
    case Termination::iteration_limit:
      return "iteration_limit";
    case Termination::time_limit:
      return "time_limit";
    case Termination::step_size_too_small:
      return "step_size_too_small";
    case Termination::no_admissible_mode:
      return "no_admissible_mode";
    case Termination::evaluation_failed:
      return "evaluation_failed";
    case Termination::factorization_failed:
      return "factorization_failed";
    case Termination::not_converged:
      return "not_converged";
    case Termination::infeasible:
      return "infeasible";
    case Termination::verification_failed:
      return "verification_failed";
    case Termination::outside_class:
      return "outside_class";
    case Termination::stopped_by_event:
      return "stopped_by_event";
  }
  __builtin_unreachable();
}

std::optional<Termination> termination_named(std::string_view name_of_one) {
  constexpr auto last = static_cast<int>(Termination::stopped_by_event);
  for (int i = 0; i <= last; ++i) {
    const auto termination = static_cast<Termination>(i);
    if (name(termination) == name_of_one) return termination;
  }
  return std::nullopt;
}

bool is_done(Termination termination) {
  return termination == Termination::completed || termination == Termination::stopped_by_event;
}

}  // namespace saltus::result
