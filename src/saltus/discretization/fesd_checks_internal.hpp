// Ranges of the options of elements.
#pragma once

#include <string>
#include <utility>

#include "saltus/base/error.hpp"
#include "saltus/discretization/fesd_options.hpp"

namespace saltus::discretization {

/// Refuses (invalid_option) weights and gamma_h outside their ranges.
[[nodiscard]] Expected<void> check(const FesdOptions& options);

/// Returns an error about [optimize]. Built member by member: g++ 12 takes the aggregate for uninitialised.
[[nodiscard]] inline Error ocp_refusal(ErrorCode code, std::string message, std::string remedy) {
  Error error;
  error.code = code;
  error.message = std::move(message);
  error.remedy = std::move(remedy);
  error.context.emplace_back("in [optimize]");
  return error;
}

}  // namespace saltus::discretization
