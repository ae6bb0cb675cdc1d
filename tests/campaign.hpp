// How much of a campaign a test does.
#pragma once

#include <cstdlib>
#include <string_view>

namespace saltus {

/// What SALTUS_CAMPAIGNS says: `whole` at night, `few` under the sanitizers, nothing else.
[[nodiscard]] inline std::string_view wanted_campaigns() {
  const char* wanted = std::getenv("SALTUS_CAMPAIGNS");
  return wanted == nullptr ? std::string_view() : std::string_view(wanted);
}

/// Is `whole` in the nightly tests; else a tenth of it, for `make test`.
template <class Number>
[[nodiscard]] Number of_campaign(Number whole) {
  return wanted_campaigns() == "whole" ? whole : whole / 10;
}

/// Is `all`, and a fifth of it under the sanitizers, where a system takes ten times as long: they look for faults of
/// memory, and every family meets all of its code in the first systems.
template <class Number>
[[nodiscard]] Number of_short_campaign(Number all) {
  return wanted_campaigns() == "few" ? all / 5 : all;
}

}  // namespace saltus
