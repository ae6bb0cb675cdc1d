// What the certificate and the verification of an optimisation say, in words for people.
#pragma once

#include <string>
#include <vector>

#include "saltus/result/result.hpp"

namespace saltus::report {

/// Holds a sentence, and whether what it says is good.
struct Finding {
  enum class Tone { good, neutral, bad };
  Tone tone = Tone::neutral;
  std::string text;
};

/// Says feasibility, complementarity, stationarity; then whether it is B-stationary, and what that means.
/// @param tolerance  of the residuals, optimize.mpcc.tolerance
[[nodiscard]] std::vector<Finding> certificate_findings(const result::Certificate& certificate, double tolerance);

/// Says the same of an optimum, and what no certificate looks at: impacts on the other side of a node.
[[nodiscard]] std::vector<Finding> certificate_findings(const result::Result& result);

/// Returns what the event-driven simulation says of intervals, switches, constraints between the nodes, and the whole
/// horizon.
[[nodiscard]] std::vector<Finding> verification_findings(const result::Optimization& optimization);

/// Returns terms that are not zero, with their names, in the order of the result file.
[[nodiscard]] std::vector<std::pair<std::string, double>> objective_terms(const result::ObjectiveTerms& terms);

}  // namespace saltus::report
