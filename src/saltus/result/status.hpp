// Why a computation stopped.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace saltus::result {

enum class Termination {
  completed,
  stopped_by_user,
  iteration_limit,
  time_limit,
  step_size_too_small,
  no_admissible_mode,
  evaluation_failed,
  factorization_failed,
  not_converged,
  infeasible,
  verification_failed,
  outside_class,
  stopped_by_event,
};
[[nodiscard]] std::string_view name(Termination termination);
/// Returns the inverse of name; nullopt if there is none of that name.
[[nodiscard]] std::optional<Termination> termination_named(std::string_view name);

/// Returns whether the command did what was asked (exit code 0): completed or stopped_by_event.
[[nodiscard]] bool is_done(Termination termination);

struct Status {
  Termination termination = Termination::completed;
  std::string message;  ///< what happened where, and what to try
  double time_reached = 0.0;
};

}  // namespace saltus::result
