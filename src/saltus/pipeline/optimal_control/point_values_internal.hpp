// Outputs and selections of a system at single points, controls and parameters given.
#pragma once

#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/model/graph/model_function.hpp"
#include "saltus/model/system.hpp"

namespace saltus::pipeline {

/// Says where a system is evaluated; vectors as System::x, u, p.
struct ModelPoint {
  double t = 0.0;
  std::vector<double> x, u, p;
};

class PointValues {
 public:
  /// Fails (invalid_model) if the symbolic layer refuses an expression.
  [[nodiscard]] static Expected<PointValues> make(const model::System& system);

  /// Returns alpha_j in {0, 1/2, 1} by the sign of psi_j, inner functions first, constants of cells where their
  /// arguments are. Entries of `known` that are not NaN stay; regions that are not known have equal weights.
  /// @param known  as System::alpha; empty: nothing
  [[nodiscard]] std::vector<double> selections(const ModelPoint& point, std::vector<double> known = {});

  /// Evaluates all outputs.
  [[nodiscard]] std::vector<double> outputs(const ModelPoint& point);

 private:
  explicit PointValues(const model::System& system);
  void evaluate(model::ModelFunction& function, const ModelPoint& point, std::vector<double>& values);
  bool move_cells(const ModelPoint& point);
  void start_selections(std::vector<double> known);

  struct Region {
    std::size_t function = 0;
    double weight = 0.0;
  };
  std::vector<model::SwitchingFunction> switching_;
  std::vector<model::Cell> cells_;
  std::vector<Region> regions_;
  std::vector<double> alpha_, constants_, references_;
  std::vector<bool> is_known_;
  std::vector<double> psi_values_, argument_values_, output_values_;
  model::ModelFunction psi_, arguments_, outputs_;
};

}  // namespace saltus::pipeline
