#include "saltus/pipeline/bodies/drawing.hpp"

#include <algorithm>
#include <array>

#include "saltus/base/symbolic_lock.hpp"
#include "saltus/model/graph/model_function.hpp"
#include "saltus/model/system.hpp"

namespace saltus::pipeline {

using casadi::SX;

std::optional<result::Drawing> drawing_of(const model::System& system, const std::vector<double>& parameters,
                                          const result::Trajectory& trajectory) {
  if (system.drawing.empty()) return std::nullopt;
  const SymbolicLock lock;
  result::Drawing drawing;
  std::vector<SX> numbers;
  for (const auto& [points, radius] : system.drawing) {
    drawing.shapes.push_back({!radius.is_empty(), static_cast<std::size_t>(points.size2())});
    numbers.push_back(SX::vec(SX::densify(points)));
    if (!radius.is_empty()) numbers.push_back(radius);
  }
  model::ModelFunction function("saltus_drawing", {system.x, system.p}, {SX::vertcat(numbers)});
  std::vector<double> x(system.state_names.size(), 0.0);
  for (std::size_t i = 0; i < trajectory.t.size(); ++i) {
    const std::vector<double> row = trajectory.x[i];
    std::copy_n(row.begin(), std::min(row.size(), x.size()), x.begin());
    auto& values = drawing.rows.emplace_back(drawing.width());
    const double* const from = x.data();
    function(std::array{from, parameters.data()}, std::array{values.data()});
  }
  return drawing;
}

std::optional<result::Drawing> drawing_of(const model::System& system, const result::Trajectory& trajectory) {
  return drawing_of(system, system.parameter_values, trajectory);
}

}  // namespace saltus::pipeline
