// How much of a campaign a test does.
#pragma once

#include <cstdlib>
#include <string_view>

namespace saltus {

/// Is `whole` in the nightly tests, which set SALTUS_CAMPAIGNS=whole; else a tenth of it, for `make test`.
template <class Number>
[[nodiscard]] Number of_campaign(Number whole) {
  const char* wanted = std::getenv("SALTUS_CAMPAIGNS");
  return wanted != nullptr && std::string_view(wanted) == "whole" ? whole : whole / 10;
}

}  // namespace saltus
