#include "saltus/fesd_integrator/record/recorder.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/base/contains.hpp"

namespace saltus::fesd_integrator {
Recorder::Recorder(const discretization::PointFunctions& functions, const Facts& facts)
    : functions_(functions), facts_(facts) {}

ModeView Recorder::view(const ActiveSet& set, const std::vector<double>& selections, const double* held) const {
  ModeView view;
  view.alpha.resize(facts_.n_functions);
  view.mode.resize(facts_.n_functions);
  // A function slides if its selection is neither 0 nor 1 with everything that slides in the middle.
  std::vector<double> unknown(set.sliding().size(), 0.5), middle(selections.size());
  for (const Part& part : facts_.parts) {
    if (!part.simplex || unknown.empty()) continue;
    const auto modes = set.modes().begin() + part.first;
    const double weight = 1.0 / static_cast<double>(std::count(modes, modes + part.count, 0));
    for (std::size_t k = 0; k < unknown.size(); ++k) {
      const int own = set.sliding()[k].selection - part.first;
      if (set.sliding()[k].reference >= 0 && own >= 0 && own < part.count) unknown[k] = weight;
    }
  }
  set.selections(unknown.data(), middle.data());
  functions_.alpha(middle.data(), held, view.alpha.data());
  constexpr double rounding = 1e-9;  // sums of weights
  for (std::size_t j = 0; j < view.mode.size(); ++j) {
    view.mode[j] = view.alpha[j] > 1.0 - rounding ? 1 : view.alpha[j] < rounding ? -1 : 0;
  }
  for (const auto& group : facts_.regions) {
    for (std::size_t i = 0; i < group.names.size(); ++i) {
      int& mode = view.mode[at(group.first) + i];
      mode = mode == -1 ? -1 : 0;
    }
  }
  // What is not determined has no value.
  for (std::size_t j = 0; j < middle.size(); ++j) {
    middle[j] = set.is_determined(static_cast<int>(j)) ? selections[j] : std::numeric_limits<double>::quiet_NaN();
  }
  functions_.alpha(middle.data(), held, view.alpha.data());
  return view;
}

Recorder::Columns Recorder::columns(const ActiveSet& set, const std::vector<double>& selections,
                                    const double* held) const {
  const ModeView by_function = view(set, selections, held);
  Columns columns;
  for (const auto& column : facts_.columns) {
    columns.mode.push_back(column.orientation * by_function.mode[at(column.function)]);
    const double alpha = by_function.alpha[at(column.function)];
    columns.alpha.push_back(column.orientation > 0 ? alpha : 1.0 - alpha);
  }
  for (const auto& group : facts_.regions) {
    auto& active = columns.regions.emplace_back();
    for (std::size_t i = 0; i < group.names.size(); ++i) {
      if (by_function.mode[at(group.first) + i] == 0) active.push_back(group.names[i]);
      columns.theta.push_back(by_function.alpha[at(group.first) + i]);
    }
  }
  return columns;
}

void Recorder::row(double t, const std::vector<double>& x, const ActiveSet& set, const std::vector<double>& selections,
                   const double* held) {
  Columns now = columns(set, selections, held);
  trajectory_.t.push_back(t);
  trajectory_.x.push_back(x);
  const auto inputs = trajectory_.u.emplace_back(facts_.n_u);
  functions_.inputs(t, held, inputs.data());
  const auto outputs = trajectory_.outputs.emplace_back(facts_.n_y);
  functions_.outputs(t, x.data(), selections.data(), held, outputs.data());
  trajectory_.alpha.push_back(std::move(now.alpha));
  trajectory_.mode.push_back(std::move(now.mode));
  if (facts_.regions.empty()) return;
  trajectory_.regions.push_back(std::move(now.regions));
  trajectory_.theta.push_back(std::move(now.theta));
}

void Recorder::drop_last_row() {
  const auto drop = [&](auto& column) {
    if (!column.empty()) column.pop_back();
  };
  drop(trajectory_.t);
  drop(trajectory_.x);
  drop(trajectory_.u);
  drop(trajectory_.alpha);
  drop(trajectory_.mode);
  drop(trajectory_.outputs);
  drop(trajectory_.regions);
  drop(trajectory_.theta);
}

void Recorder::row_behind(RowBefore before, const ActiveSet& set, const std::vector<double>& selections,
                          const double* held) {
  const std::vector<double> x = trajectory_.x.back();
  row(trajectory_.t.back(), x, set, selections, held);
  const std::size_t last = trajectory_.t.size() - 1;
  const bool same =
      trajectory_.u[last - 1] == trajectory_.u[last] && trajectory_.outputs[last - 1] == trajectory_.outputs[last];
  if (same) drop_last_row();
  if (same || before != RowBefore::replaced) return;
  const double t = trajectory_.t.back();
  drop_last_row();
  drop_last_row();
  row(t, x, set, selections, held);
}

/// The row before a switch, unless the step that ended here has written it.
void Recorder::row_before(double t, const std::vector<double>& x, const Side& before) {
  row(t, x, *before.set, *before.selections, before.held);
  const auto repeated = [](const auto& column) { return column[column.size() - 1] == column[column.size() - 2]; };
  if (trajectory_.t.size() > 1 && repeated(trajectory_.t) && repeated(trajectory_.x) && repeated(trajectory_.mode) &&
      repeated(trajectory_.u) && repeated(trajectory_.outputs))
    drop_last_row();
}

void Recorder::note_before(result::Event& event, const Columns& before) const {
  event.mode_before = before.mode;
  event.alpha_before = before.alpha;
  if (!facts_.regions.empty()) event.regions_before = before.regions;
}

void Recorder::finish(result::Event& event, const Columns& after, const std::vector<Continuation>& found,
                      const double* held, std::string_view reason) {
  event.mode_after = after.mode;
  event.alpha_after = after.alpha;
  if (!facts_.regions.empty()) event.regions_after = after.regions;
  event.unique = std::all_of(found.begin(), found.end(), [](const auto& other) { return other.determined; });
  const bool decided = std::all_of(found.begin(), found.end(), [](const auto& other) { return other.decided; });
  if (event.unique == true && !decided) event.unique = std::nullopt;
  for (std::size_t k = 1; k < found.size(); ++k) {
    Columns other = columns(found[k].set, found[k].selections, held);
    // Sets that differ only where it does not show (inside a nested function) are one continuation.
    if (other.mode == after.mode && other.regions == after.regions) continue;
    event.unique = false;
    event.alternatives.push_back({std::move(other.mode), std::move(other.alpha), std::move(other.regions)});
  }
  event.reason = reason;
}

/// Names of what differs, and their modes on both sides: of a region 1 or -1 where one alone is replaced by another.
Recorder::Differences Recorder::differences(const Columns& from, const Columns& to) const {
  Differences differences;
  const auto note = [&](const std::string& name, int mode_before, int mode_after) {
    differences.names.push_back(name);
    differences.before.push_back(mode_before);
    differences.after.push_back(mode_after);
  };
  for (std::size_t c = 0; c < facts_.columns.size(); ++c) {
    if (!facts_.columns[c].listed || from.mode[c] == to.mode[c]) continue;
    note(facts_.columns[c].name, from.mode[c], to.mode[c]);
  }
  for (std::size_t g = 0; g < facts_.regions.size(); ++g) {
    const bool replaced = from.regions[g].size() == 1 && to.regions[g].size() == 1;
    for (const auto& name : facts_.regions[g].names) {
      const bool was = contains(from.regions[g], name), is = contains(to.regions[g], name);
      if (was == is) continue;
      if (replaced) {
        note(name, was ? -1 : 1, was ? 1 : -1);
      } else {
        note(name, was ? 0 : -1, was ? -1 : 0);
      }
    }
  }
  return differences;
}

bool Recorder::jumped(double t, const std::vector<double>& x, const std::vector<double>& x_after, const Side& before,
                      const std::vector<Continuation>& found, const double* held, std::string_view reason) {
  const Columns from = columns(*before.set, *before.selections, before.held);
  const Columns to = columns(found.front().set, found.front().selections, held);
  Differences listed = differences(from, to);
  if (listed.names.empty()) return false;
  result::Event event;
  event.kind = result::kind_of_switch(listed.before, listed.after);
  event.surfaces = std::move(listed.names);
  row_before(t, x, before);
  row(t, x_after, found.front().set, found.front().selections, held);
  event.t = t;
  note_before(event, from);
  event.x = x;
  event.x_after = x_after;
  finish(event, to, found, held, reason);
  events_.push_back(std::move(event));
  return true;
}

void Recorder::accumulated(double t, const std::vector<double>& x, const std::vector<double>& x_limit,
                           const Side& before, const std::vector<Continuation>& found, const double* held) {
  const Columns from = columns(*before.set, *before.selections, before.held);
  const Columns to = columns(found.front().set, found.front().selections, held);
  row_before(t, x, before);
  row(t, x_limit, found.front().set, found.front().selections, held);
  result::Event event;
  event.t = t;
  event.kind = result::EventKind::accumulation;
  event.surfaces = differences(from, to).names;
  note_before(event, from);
  event.x = x;
  event.x_after = x_limit;
  finish(event, to, found, held, "the intervals of these switches shrink geometrically: the state is their limit");
  events_.push_back(std::move(event));
}

bool Recorder::started(double t, const std::vector<double>& x, const std::vector<Continuation>& found,
                       const double* held, const std::vector<int>& at_zero) {
  const auto& chosen = found.front();
  row(t, x, chosen.set, chosen.selections, held);
  result::Event event;
  for (const auto& column : facts_.columns) {
    const bool zero = contains(at_zero, column.function);
    if (column.listed && zero) event.surfaces.push_back(column.name);
  }
  for (const auto& group : facts_.regions) {
    for (std::size_t i = 0; i < group.names.size(); ++i) {
      const int function = group.first + static_cast<int>(i);
      if (contains(at_zero, function)) event.surfaces.push_back(group.names[i]);
    }
  }
  if (event.surfaces.empty()) return false;
  row(t, x, chosen.set, chosen.selections, held);
  event.t = t;
  event.kind = result::EventKind::start;
  event.x = event.x_after = x;
  finish(event, columns(chosen.set, chosen.selections, held), found, held, "start on the surface");
  events_.push_back(std::move(event));
  return true;
}

void Recorder::user(double t, const std::vector<double>& x, const Side& side, std::size_t event,
                    std::string_view reason) {
  row(t, x, *side.set, *side.selections, side.held);
  row(t, x, *side.set, *side.selections, side.held);
  const Columns now = columns(*side.set, *side.selections, side.held);
  result::Event entry;
  entry.t = t;
  entry.kind = result::EventKind::user;
  entry.name = facts_.events[event].name;
  note_before(entry, now);
  entry.x = entry.x_after = x;
  finish(entry, now, {}, side.held, reason);
  events_.push_back(std::move(entry));
}

result::Final Recorder::last() const {
  result::Final final;
  final.t = trajectory_.t.back();
  final.x = trajectory_.x.back();
  final.mode = trajectory_.mode.back();
  final.alpha = trajectory_.alpha.back();
  final.outputs = trajectory_.outputs.back();
  if (!facts_.regions.empty()) {
    final.regions = trajectory_.regions.back();
    final.theta = trajectory_.theta.back();
  }
  return final;
}

}  // namespace saltus::fesd_integrator
