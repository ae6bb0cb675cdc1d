// Systems and their complementarity systems at points, for tests.
#pragma once

#include <algorithm>
#include <random>
#include <stdexcept>
#include <vector>

#include <casadi/core/function.hpp>

#include "saltus/base/at.hpp"
#include "saltus/model/builder.hpp"
#include "saltus/reformulation/dcs.hpp"

namespace saltus::reformulation {

inline constexpr ReformulationOptions as_step{.reformulation = Form::step, .lifting = std::nullopt};
inline constexpr ReformulationOptions as_stewart{.reformulation = Form::stewart};

inline model::System built(model::Builder& builder) {
  auto system = builder.build();
  if (!system) throw std::runtime_error(to_text(system.error()));
  return *std::move(system);
}

inline Dcs dcs_of(const model::System& system, const ReformulationOptions& options) {
  auto dcs = reformulate(system, options);
  if (!dcs) throw std::runtime_error(to_text(dcs.error()));
  return *std::move(dcs);
}

inline std::vector<double> uniform(int count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> draw(0.0, 1.0);
  std::vector<double> numbers(at(count));
  for (double& number : numbers) number = draw(random);
  return numbers;
}

/// The lifted variables of given selections: row k of their equations is beta_k less a product of selections and
/// earlier betas.
inline std::vector<double> lifted_at(const Dcs& dcs, const std::vector<double>& selection) {
  const casadi::Function lifting("lifting", {dcs.selection, dcs.lifted}, {casadi::SX::densify(dcs.lifting)});
  std::vector<double> lifted(static_cast<std::size_t>(dcs.lifted.numel()), 0.0);
  for (std::size_t k = 0; k < lifted.size(); ++k) {
    lifted[k] = -std::vector<double>(lifting(std::vector<casadi::DM>{selection, lifted}).front())[k];
  }
  return lifted;
}

/// An expression of x, selection and lifted at a point.
inline std::vector<double> value(const Dcs& dcs, const casadi::SX& expression, const std::vector<double>& x,
                                 const std::vector<double>& selection) {
  const casadi::Function function("value", {dcs.x, dcs.selection, dcs.lifted}, {casadi::SX::densify(expression)});
  return std::vector<double>(function(std::vector<casadi::DM>{x, selection, lifted_at(dcs, selection)}).front());
}

inline std::vector<double> field(const Dcs& dcs, const std::vector<double>& x, const std::vector<double>& selection) {
  return value(dcs, dcs.f, x, selection);
}

inline std::vector<double> indicators(const Dcs& dcs, const std::vector<double>& x) {
  return value(dcs, dcs.indicator, x, std::vector<double>(at(static_cast<int>(dcs.selection.numel())), 0.0));
}

}  // namespace saltus::reformulation
