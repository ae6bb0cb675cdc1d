// A model with everything the parts of the engine need of it.
#pragma once

#include <utility>

#include "saltus/discretization/butcher_tableau.hpp"
#include "saltus/discretization/point_functions.hpp"
#include "saltus/discretization/stage_kernel.hpp"
#include "saltus/fesd_integrator/element/facts.hpp"
#include "saltus/model/builder.hpp"
#include "saltus/reformulation/dcs.hpp"

namespace saltus::fesd_integrator {

struct Compiled {
  model::System system;
  reformulation::Dcs dcs;
  discretization::StageKernel kernel;
  discretization::PointFunctions functions;
  Facts facts;

  explicit Compiled(model::Builder& builder, reformulation::Form form = reformulation::Form::step)
      : system(*builder.build()),
        dcs(*reformulation::reformulate(system, {form, std::nullopt})),
        kernel(*discretization::StageKernel::compile(dcs, system.parameter_values)),
        functions(*discretization::PointFunctions::compile(dcs, system.parameter_values)),
        facts(fesd_integrator::facts(system, dcs)) {}

  [[nodiscard]] ActiveSet set(std::vector<int> modes) const { return {facts.parts, std::move(modes)}; }
};

inline discretization::ButcherTableau tableau(discretization::TableauFamily family, int stages) {
  return *discretization::butcher_tableau(family, stages);
}

/// x' = a - b sign x + c t.
inline Compiled scalar(double a, double b, double c = 0.0, reformulation::Form form = reformulation::Form::step) {
  model::Builder builder("scalar");
  const casadi::SX x = builder.state("x", {-1.0});
  casadi::SX rate = a - b * builder.sign(x);
  if (c != 0.0) rate += c * builder.time();
  builder.dynamics("x", rate);
  return Compiled(builder, form);
}

}  // namespace saltus::fesd_integrator
