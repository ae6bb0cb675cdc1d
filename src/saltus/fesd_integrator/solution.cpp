#include "saltus/fesd_integrator/solution.hpp"

#include <algorithm>
#include <utility>

#include "saltus/base/symbolic_lock.hpp"
#include "saltus/fesd_integrator/element/element_piece.hpp"
#include "saltus/fesd_integrator/record/recorder.hpp"
#include "saltus/fesd_integrator/run/context_internal.hpp"
#include "saltus/fesd_integrator/run/element_interior_internal.hpp"
#include "saltus/fesd_integrator/run/position_internal.hpp"

namespace saltus::fesd_integrator {

struct Solution::Implementation {
  Implementation(discretization::StageKernel stages, discretization::PointFunctions points, const Facts& known,
                 const IntegrationOptions& asked, std::vector<ElementPiece> of)
      : kernel(std::move(stages)),
        functions(std::move(points)),
        facts(known),
        options(asked),
        context(kernel, functions, facts, options),
        interior(context, position),
        pieces(std::move(of)) {}

  void write(double t, Recorder& recorder);

  discretization::StageKernel kernel;
  discretization::PointFunctions functions;
  Facts facts;
  IntegrationOptions options;
  RunContext context;
  Position position;
  ElementInterior interior;
  std::vector<ElementPiece> pieces;
};

void Solution::Implementation::write(double t, Recorder& recorder) {
  const auto behind = std::upper_bound(pieces.begin(), pieces.end(), t,
                                       [](double time, const ElementPiece& piece) { return time < piece.begin; });
  if (behind == pieces.begin() || !(t < (behind - 1)->end)) return;
  const auto& [begin, end, is_first, element, selections, set, stage_sets, held] = *(behind - 1);
  if (is_first && t == begin) return recorder.row(t, element.x, set, selections, held.data());
  context.held.put(held);
  position.continue_with(set, selections);
  interior.take_stage_sets(stage_sets);
  interior.go_to(element, selections, (t - element.t) / element.h);
  recorder.row(t, interior.x(), interior.set(), interior.selections(), held.data());
}

Solution::Solution(discretization::StageKernel kernel, discretization::PointFunctions functions, const Facts& facts,
                   const IntegrationOptions& options, std::vector<ElementPiece> pieces)
    : implementation_(std::make_unique<Implementation>(std::move(kernel), std::move(functions), facts, options,
                                                       std::move(pieces))) {}

Solution::~Solution() {
  const SymbolicLock lock;
  implementation_.reset();
}

result::Trajectory Solution::rows(const std::vector<double>& times) {
  Recorder recorder(implementation_->functions, implementation_->facts);
  for (const double t : times) implementation_->write(t, recorder);
  return std::move(recorder.trajectory());
}

}  // namespace saltus::fesd_integrator
