// What all parts of a run work with: the functions of the model, and the solver of elements.
#pragma once

#include "saltus/discretization/point_functions.hpp"
#include "saltus/discretization/stage_kernel.hpp"
#include "saltus/fesd_integrator/element/element.hpp"
#include "saltus/fesd_integrator/element/facts.hpp"
#include "saltus/fesd_integrator/element/projected_field.hpp"
#include "saltus/fesd_integrator/integration.hpp"
#include "saltus/fesd_integrator/watch/held_values.hpp"
#include "saltus/fesd_integrator/watch/watch.hpp"

namespace saltus::fesd_integrator {

struct RunContext {
  RunContext(const discretization::StageKernel& stages, const discretization::PointFunctions& points,
             const Facts& known, const IntegrationOptions& asked)
      : kernel(stages),
        functions(points),
        facts(known),
        options(asked),
        solver(stages, asked.tableau),
        watch(stages, solver),
        projected(stages),
        held(points, known.held) {
    stages.size(at_point);
  }

  const discretization::StageKernel& kernel;
  const discretization::PointFunctions& functions;
  const Facts& facts;
  const IntegrationOptions& options;
  ElementSolver solver;
  Watch watch;
  ProjectedField projected;
  HeldValues held;
  discretization::StageValues at_point;  ///< work space of whoever evaluates the model at one point
};

}  // namespace saltus::fesd_integrator
