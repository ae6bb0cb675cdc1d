#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/base/contracts.hpp"
#include "saltus/reformulation/forms_internal.hpp"
#include "saltus/reformulation/surface_roots_internal.hpp"

namespace saltus::reformulation {
namespace {

Error no_jumps() {
  return {ErrorCode::not_available, "finite elements do not cover models with [[jumps]]", "use --method event", {}, {}};
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

/// Outputs, events and the alphas of columns, in what the surfaces' alphas are in this form.
void take_rest(Unnested& unnested, Dcs& dcs) {
  Replacement replacement;
  if (!unnested.surface_symbols.empty()) replacement.set(column(unnested.surface_symbols), dcs.surface_alpha);
  dcs.alpha = replacement.of(unnested.alpha);
  dcs.outputs = replacement.of(unnested.outputs);
  dcs.input = replacement.of(unnested.input);
  dcs.events = std::move(unnested.events);
  for (auto& event : dcs.events) {
    event.value = replacement.of(event.value);
    event.guards = replacement.of(event.guards);
  }
}

}  // namespace

void add_group(GroupSizes group, Sizes& sizes) {
  const Counts& counts = group.counts;
  sizes.total.alpha += counts.alpha;
  sizes.total.theta += counts.theta;
  sizes.total.beta += counts.beta;
  sizes.total.algebraic += counts.algebraic;
  sizes.total.complementarities += counts.complementarities;
  sizes.total.equations += counts.equations;
  sizes.groups.push_back(std::move(group));
}

std::vector<std::string> names_of(const FieldGroup& group, const Unnested& unnested) {
  std::vector<std::string> names;
  for (const int surface : group.surfaces) names.push_back(unnested.surfaces[at(surface)].name);
  return names;
}

void add_indicator_part(const IndicatorPart& part, const model::System& system, Collected& collected,
                        Reformulated& result) {
  const auto count = static_cast<int>(part.theta.size());
  result.dcs.parts.push_back({.form = Form::stewart,
                              .first = static_cast<int>(collected.selection.size()),
                              .count = count,
                              .mode_group = part.mode_group});
  collected.selection.insert(collected.selection.end(), part.theta.begin(), part.theta.end());
  collected.indicator.insert(collected.indicator.end(), part.indicator.begin(), part.indicator.end());
  Counts counts;
  counts.theta = count;
  counts.algebraic = 2 * count + 1;
  counts.complementarities = count;
  counts.equations = count + 1;
  add_group({system.mode_groups[at(part.mode_group)].mode_names, Form::stewart, counts}, result.sizes);
}

namespace {

/// What all forms have in common, and most of the work.
Expected<Unnested> taken_apart(const model::System& system) {
  if (!system.jumps.empty()) return tl::unexpected(no_jumps());
  auto unnested = unnest(system);
  if (unnested) take_roots(system, *unnested);
  return unnested;
}

Expected<Reformulated> in_form(const model::System& system, Unnested unnested, const ReformulationOptions& options) {
  SALTUS_ASSERT(!options.lifting || *options.lifting >= 2);
  Reformulated result{common_part(system, unnested), {}};
  auto collected = options.reformulation == Form::step
                       ? Expected<Collected>(fill_step_form(system, unnested, options.lifting, result))
                       : fill_stewart_form(system, unnested, result);
  if (!collected) return tl::unexpected(collected.error());
  result.dcs.selection = column(collected->selection);
  result.dcs.indicator = column(collected->indicator);
  finish_roots(unnested, result.dcs);
  take_rest(unnested, result.dcs);
  return result;
}

}  // namespace

Expected<Reformulated> reformulated(const model::System& system, const ReformulationOptions& options) {
  auto unnested = taken_apart(system);
  if (!unnested) return tl::unexpected(unnested.error());
  return in_form(system, std::move(*unnested), options);
}

Expected<Dcs> reformulate(const model::System& system, const ReformulationOptions& options) {
  return reformulated(system, options).map([](Reformulated&& result) { return std::move(result.dcs); });
}

Expected<Sizes> sizes_of(const model::System& system, const ReformulationOptions& options) {
  return std::move(sizes_of_all(system, std::span(&options, 1)).front());
}

std::vector<Expected<Sizes>> sizes_of_all(const model::System& system, std::span<const ReformulationOptions> options) {
  const auto unnested = taken_apart(system);
  std::vector<Expected<Sizes>> all;
  for (const auto& one : options) {
    if (!unnested) {
      all.emplace_back(tl::unexpected(unnested.error()));
      continue;
    }
    all.push_back(in_form(system, *unnested, one).map([](Reformulated&& made) { return std::move(made.sizes); }));
  }
  return all;
}

}  // namespace saltus::reformulation
