// What the solution of a foreign MPCC leaves; plain data.
#pragma once

#include <string>
#include <vector>

#include "saltus/result/optimization.hpp"
#include "saltus/result/status.hpp"

namespace saltus::result {

/// Holds the multipliers of L = f + rows'g + lower'(l - x) + upper'(x - u) - G'G - H'H; f is the negative of an
/// objective that is maximised.
struct MpccMultipliers {
  std::vector<double> rows, lower, upper, G, H;
};

struct MpccResult {
  std::string file;
  std::string sha256;              ///< of the file's bytes
  Status status;                   ///< its time has no meaning
  double objective = 0.0;          ///< in the file's own sense
  std::vector<double> x;           ///< the file's variables in its order
  std::vector<std::string> names;  ///< empty if the file has none
  Certificate certificate;
  double tolerance = 0.0;  ///< of its residuals
  MpccMultipliers multipliers;
  std::vector<HomotopyStep> homotopy;
  std::vector<StartOutcome> starts;  ///< where there were several
  OptimizationStatistics statistics;
};

}  // namespace saltus::result
