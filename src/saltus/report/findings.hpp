// What is said of an optimum in words, for whoever shows it.
#pragma once

#include <string>
#include <vector>

#include "saltus/result/result.hpp"

namespace saltus::report {

/// Holds a sentence about the "certificate", or about the "simulation" that verifies, and whether it is "good",
/// "neutral" or "bad".
struct SaidOfOptimum {
  std::string about, tone, text;
};

/// Returns all of them; none for a result that is no optimum.
[[nodiscard]] std::vector<SaidOfOptimum> said_of_optimum(const result::Result& result);

}  // namespace saltus::report
