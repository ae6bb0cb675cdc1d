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
  /// Holds the least and the greatest multiplier of a row; not finite: without a limit.
  struct Range {
    int row = 0;
    std::string name;
    std::vector<double> range;
  };
  std::vector<double> rows, lower, upper, G, H;
  std::vector<Range> not_unique;  ///< rows whose number above is one of many
};

/// Counts what bounds alone decide.
struct PresolveCounts {
  int fixed_variables = 0;              ///< bounds are equal
  int empty_rows = 0;                   ///< without a variable, or without a bound
  int forced_pairs = 0;                 ///< one side is never zero, so that the other one is
  int fixed_pairs = 0;                  ///< one side is always zero
  std::vector<std::string> infeasible;  ///< contradictions, by the names of rows
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
  PresolveCounts presolve;
  MpccMultipliers multipliers;
  std::vector<HomotopyStep> homotopy;
  std::vector<StartOutcome> starts;  ///< where there were several
  OptimizationStatistics statistics;
};

}  // namespace saltus::result
