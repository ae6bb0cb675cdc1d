// The gaps of contacts at given states.
#pragma once

#include <vector>

#include "saltus/model/graph/model_function.hpp"
#include "saltus/model/system.hpp"
#include "saltus/result/result.hpp"

namespace saltus::pipeline {

/// Is made and dropped under the SymbolicLock.
class Gaps {
 public:
  /// @param parameters  values of System::p
  Gaps(const model::System& system, std::vector<double> parameters);

  /// Returns how deep bodies are in each other: the largest -gap of all contacts, 0 without any.
  /// @param x  of which the states of the system are the first ones
  [[nodiscard]] double depth(double t, const std::vector<double>& x);
  /// Returns how deep they are over all rows.
  [[nodiscard]] double depth(const result::Trajectory& trajectory);

 private:
  std::vector<double> parameters_, gaps_;
  model::ModelFunction function_;
};

}  // namespace saltus::pipeline
