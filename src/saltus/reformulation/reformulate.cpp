#include <utility>

#include "saltus/reformulation/dcs.hpp"
#include "saltus/reformulation/unnesting_internal.hpp"

namespace saltus::reformulation {
namespace {

Error no_jumps() {
  return {ErrorCode::not_available,
          "finite elements with switch detection do not cover models with [[jumps]]",
          "use --method event",
          {},
          {}};
}

/// What does not depend on the form.
Dcs common_part(const model::System& system, const Unnested& unnested) {
  Dcs dcs;
  dcs.t = system.t;
  dcs.x = system.x;
  dcs.u = system.u;
  dcs.p = system.p;
  dcs.held = column(unnested.held);
  dcs.held_symbols = unnested.held_symbols;
  dcs.surfaces = unnested.surfaces;
  dcs.lifted = SX(0, 1);
  dcs.lifting = SX(0, 1);
  return dcs;
}

void append(std::vector<SXElem>& to, const std::vector<SXElem>& from) { to.insert(to.end(), from.begin(), from.end()); }

}  // namespace

Expected<Dcs> reformulate(const model::System& system, const ReformulationOptions&) {
  if (!system.jumps.empty()) return tl::unexpected(no_jumps());
  auto unnested = unnest(system);
  if (!unnested) return tl::unexpected(unnested.error());
  Dcs dcs = common_part(system, *unnested);
  std::vector<SXElem> selection = unnested->surface_symbols, indicator;
  DcsPart steps{.form = Form::step, .first = 0, .count = static_cast<int>(selection.size())};
  for (int j = 0; j < steps.count; ++j) {
    steps.surfaces.push_back(j);
    indicator.push_back(entry(dcs.surfaces[static_cast<std::size_t>(j)].psi));
  }
  if (steps.count > 0) dcs.parts.push_back(steps);
  for (const auto& part : unnested->indicator_parts) {
    const auto count = static_cast<int>(part.theta.size());
    dcs.parts.push_back({.form = Form::stewart,
                         .first = static_cast<int>(selection.size()),
                         .count = count,
                         .mode_group = part.mode_group});
    append(selection, part.theta);
    append(indicator, part.indicator);
  }
  dcs.selection = column(selection);
  dcs.indicator = column(indicator);
  dcs.surface_alpha = column(unnested->surface_symbols);
  dcs.f = unnested->f;
  dcs.alpha = unnested->alpha;
  dcs.outputs = unnested->outputs;
  dcs.input = unnested->input;
  dcs.events = std::move(unnested->events);
  return dcs;
}

}  // namespace saltus::reformulation
