#include "saltus/pipeline/well_posedness.hpp"

#include <algorithm>

#include "saltus/base/contains.hpp"
#include "saltus/model/system.hpp"
#include "saltus/pipeline/simulate.hpp"
#include "saltus/reformulation/dcs.hpp"
#include "saltus/reformulation/well_posedness.hpp"

namespace saltus::pipeline {
namespace {

using reformulation::ActiveSetRank;
using reformulation::Form;
using reformulation::SolutionPoint;
using reformulation::WellPosedness;

/// A row of a trajectory with one entry per switching function of the system.
SolutionPoint point_of(const result::Trajectory& rows, std::size_t row, const model::System& system) {
  SolutionPoint point{rows.t[row], rows.x[row], rows.u[row], {}, {}};
  // Functions without a column never slide.
  point.mode.assign(system.switching.size(), 1);
  point.alpha.assign(system.switching.size(), 1.0);
  for (std::size_t c = 0; c < system.columns.size(); ++c) {
    const auto& column = system.columns[c];
    const auto j = static_cast<std::size_t>(column.function);
    point.mode[j] = column.orientation * rows.mode[row][c];
    point.alpha[j] = column.orientation > 0 ? rows.alpha[row][c] : 1.0 - rows.alpha[row][c];
  }
  std::size_t next = 0, group_number = 0;
  for (const auto& group : system.mode_groups) {
    if (group.first < 0) continue;
    const auto& active = rows.regions[row][group_number++];
    for (std::size_t i = 0; i < group.mode_names.size(); ++i) {
      const std::size_t j = static_cast<std::size_t>(group.first) + i;
      const bool is_active = contains(active, group.mode_names[i]);
      point.mode[j] = is_active ? 0 : -1;
      point.alpha[j] = rows.theta[row][next++];
    }
  }
  return point;
}

/// What slides, in the words of the result.
std::vector<std::string> sliding_names(const result::Trajectory& rows, std::size_t row, const model::System& system) {
  std::vector<std::string> names;
  for (std::size_t c = 0; c < system.columns.size(); ++c) {
    if (rows.mode[row][c] == 0) names.push_back(system.columns[c].name);
  }
  if (rows.regions.empty()) return names;
  for (const auto& active : rows.regions[row]) {
    if (active.size() > 1) names.insert(names.end(), active.begin(), active.end());
  }
  return names;
}

void take(const ActiveSetRank& rank, FormRank& worst) {
  const bool first = worst.unknowns == 0;
  // Where a surface is met and left, fewer of its neighbours may be seen than on it.
  if (rank.unknowns > worst.unknowns) worst = {worst.form, rank.unknowns, rank.rank, rank.smallest_singular_value};
  if (first || rank.unknowns < worst.unknowns) return;
  worst.rank = std::min(worst.rank, rank.rank);
  worst.smallest_singular_value = std::min(worst.smallest_singular_value, rank.smallest_singular_value);
}

}  // namespace

Expected<RanksAlongSolution> ranks_along_solution(const model::System& system, SimulateOptions options,
                                                  const Observers& observers) {
  options.method = Method::event;
  options.native = Native::off;  // compiling would take longer than most runs
  options.event.trajectories = 1;
  options.kept = {};
  const auto result = simulate(system, options, observers);
  if (!result) return tl::unexpected(result.error());
  std::vector<std::pair<Form, WellPosedness>> forms;
  for (const Form form : {Form::step, Form::stewart}) {
    const auto dcs = reformulation::reformulate(system, {.reformulation = form, .lifting = std::nullopt});
    if (dcs) forms.emplace_back(form, WellPosedness(*dcs, system));
  }
  RanksAlongSolution found;
  found.status = result->status;
  const auto& rows = result->trajectory;
  for (std::size_t row = 0; row < rows.t.size(); ++row) {
    const auto names = sliding_names(rows, row, system);
    if (names.empty()) continue;
    auto set = std::find_if(found.active_sets.begin(), found.active_sets.end(),
                            [&](const MetActiveSet& known) { return known.names == names; });
    if (set == found.active_sets.end()) {
      MetActiveSet met{names, rows.t[row], 0, {}};
      for (const auto& [form, posedness] : forms) met.forms.push_back({form});
      set = found.active_sets.insert(set, std::move(met));
    }
    ++set->rows;
    const SolutionPoint point = point_of(rows, row, system);
    for (std::size_t i = 0; i < forms.size(); ++i) take(forms[i].second.rank_at(point), set->forms[i]);
  }
  return found;
}

}  // namespace saltus::pipeline
