#include <array>
#include <cmath>
#include <exception>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/pipeline/optimal_control/point_values_internal.hpp"

namespace saltus::pipeline {

using casadi::SX;
using model::ModelFunction;
using model::SwitchingRole;

PointValues::PointValues(const model::System& system) : switching_(system.switching), cells_(system.cells) {
  std::vector<SX> psi, arguments, constants, references;
  for (const auto& function : switching_) {
    psi.push_back(function.role == SwitchingRole::region ? SX(0.0) : function.psi);
  }
  for (const auto& cell : cells_) {
    arguments.push_back(cell.argument);
    constants.push_back(cell.symbols);
    constants_.resize(constants_.size() + at(cell.symbols.numel()));
  }
  for (const auto& group : system.mode_groups) {
    if (group.first < 0) continue;
    references.push_back(group.reference);
    for (int i = 0; i < group.regions; ++i) {
      references_.push_back(i == 0 ? 1.0 : 0.0);
      regions_.push_back({at(group.first + i), 1.0 / group.regions});
    }
  }
  const auto stacked = [](const std::vector<SX>& parts) { return parts.empty() ? SX(0, 1) : SX::vertcat(parts); };
  const std::vector<SX> in{system.t,     system.x,           system.u,           system.p,
                           system.alpha, stacked(constants), stacked(references)};
  psi_ = ModelFunction("saltus_point_psi", in, {stacked(psi)});
  arguments_ = ModelFunction("saltus_point_arguments", in, {stacked(arguments)});
  outputs_ = ModelFunction("saltus_point_outputs", in, {system.outputs});
  psi_values_.resize(psi.size());
  argument_values_.resize(arguments.size());
  output_values_.resize(at(system.outputs.numel()));
}

Expected<PointValues> PointValues::make(const model::System& system) {
  try {
    return PointValues(system);
  } catch (const std::exception& exception) {
    return tl::unexpected(
        Error{ErrorCode::invalid_model,
              fmt::format("CasADi refused the expressions of the initial guess: {}", exception.what()),
              "",
              {},
              {}});
  }
}

void PointValues::evaluate(ModelFunction& function, const ModelPoint& point, std::vector<double>& values) {
  function(std::array<const double*, 7>{&point.t, point.x.data(), point.u.data(), point.p.data(), alpha_.data(),
                                        constants_.data(), references_.data()},
           std::array<double*, 1>{values.data()});
}

/// @return whether a constant has changed
bool PointValues::move_cells(const ModelPoint& point) {
  bool changed = false;
  evaluate(arguments_, point, argument_values_);
  std::size_t next = 0;
  for (std::size_t c = 0; c < cells_.size(); ++c) {
    const auto& table = *cells_[c].table;
    const long cell = table.cell(argument_values_[c]);
    for (int column = 0; column < table.columns; ++column, ++next) {
      const double constant = table.constant(cell, column);
      changed = changed || constant != constants_[next];
      constants_[next] = constant;
    }
  }
  return changed;
}

void PointValues::start_selections(std::vector<double> known) {
  known.resize(switching_.size(), std::numeric_limits<double>::quiet_NaN());
  alpha_ = std::move(known);
  is_known_.assign(alpha_.size(), false);
  for (std::size_t j = 0; j < alpha_.size(); ++j) {
    is_known_[j] = std::isfinite(alpha_[j]);
    if (!is_known_[j]) alpha_[j] = 0.5;
  }
  for (const auto& [function, weight] : regions_) {
    if (!is_known_[function]) alpha_[function] = weight;
    is_known_[function] = true;
  }
}

std::vector<double> PointValues::selections(const ModelPoint& point, std::vector<double> known) {
  start_selections(std::move(known));
  // Each pass settles at least the next cell or function, as they hold earlier ones only.
  for (std::size_t pass = 0; pass <= cells_.size() + switching_.size(); ++pass) {
    bool changed = !cells_.empty() && move_cells(point);
    if (!switching_.empty()) evaluate(psi_, point, psi_values_);
    for (std::size_t j = 0; j < switching_.size(); ++j) {
      if (is_known_[j] || std::isnan(psi_values_[j])) continue;
      const bool is_discrete = switching_[j].role == SwitchingRole::discrete;
      const double at_zero = is_discrete ? switching_[j].alpha_at_zero : 0.5;
      const double alpha = psi_values_[j] > 0.0 ? 1.0 : psi_values_[j] < 0.0 ? 0.0 : at_zero;
      changed = changed || alpha != alpha_[j];
      alpha_[j] = alpha;
    }
    if (!changed) break;
  }
  return alpha_;
}

std::vector<double> PointValues::outputs(const ModelPoint& point) {
  static_cast<void>(selections(point));
  if (!output_values_.empty()) evaluate(outputs_, point, output_values_);
  return output_values_;
}

}  // namespace saltus::pipeline
