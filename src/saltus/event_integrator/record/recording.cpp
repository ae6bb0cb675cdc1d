#include "saltus/event_integrator/record/recording.hpp"

#include <algorithm>
#include <array>
#include <span>
#include <utility>

#include "saltus/base/contracts.hpp"
#include "saltus/event_integrator/contact/contact_results.hpp"
#include "saltus/event_integrator/mode/small_internal.hpp"

namespace saltus::event_integrator {
namespace {

/// Modes and selections of functions as columns.
class Columns {
 public:
  explicit Columns(const model::Layout& layout) : layout_(layout), of_function_(layout.surfaces.size()) {
    for (std::size_t c = 0; c < layout.columns.size(); ++c) of_function_[at(layout.columns[c].function)].push_back(c);
    mode_.resize(layout.columns.size());
    alpha_.resize(layout.columns.size());
  }

  void set(const std::vector<int>& mode, const std::vector<double>& alpha) {
    for (std::size_t j = 0; j < mode.size(); ++j) set_function(j, mode[j], alpha[j]);
  }
  void set_function(std::size_t j, int function_mode, double function_alpha) {
    // Functions of discrete states are in no mode: their sign is that of their selection.
    const bool discrete = layout_.surfaces[j].role == model::SwitchingRole::discrete;
    const int sign = discrete ? (function_alpha > 0.5 ? 1 : function_alpha < 0.5 ? -1 : 0) : function_mode;
    for (const std::size_t c : of_function_[j]) {
      const int orientation = layout_.columns[c].orientation;
      mode_[c] = orientation * sign;
      alpha_[c] = orientation > 0 ? function_alpha : 1.0 - function_alpha;
    }
  }
  [[nodiscard]] const std::vector<std::size_t>& of_function(std::size_t j) const { return of_function_[j]; }
  [[nodiscard]] const result::Mode& mode() const { return mode_; }
  [[nodiscard]] const std::vector<double>& alpha() const { return alpha_; }

 private:
  const model::Layout& layout_;
  std::vector<std::vector<std::size_t>> of_function_;
  result::Mode mode_;
  std::vector<double> alpha_;
};

/// The columns of one mode of a log after the other: what changes from each to the next is turned into columns.
class ColumnsInTime {
 public:
  ColumnsInTime(const model::Layout& layout, const ModeLog& modes)
      : reader_(modes), columns_(layout), listed_(layout.columns.size(), false) {}

  void seek(std::size_t number) {
    reader_.seek(number, [&](std::size_t j) {
      columns_.set_function(j, reader_.mode()[j], reader_.alpha()[j]);
      for (const std::size_t c : columns_.of_function(j)) {
        if (!listed_[c]) changed_.push_back(c);
        listed_[c] = true;
      }
    });
  }
  /// Columns that may have changed since forget() was called last.
  [[nodiscard]] result::Events::ModeChanges changes() const { return {columns_.mode(), columns_.alpha(), changed_}; }
  void forget() {
    for (const std::size_t c : changed_) listed_[c] = false;
    changed_.clear();
  }
  [[nodiscard]] const ModeLog::Reader& functions() const { return reader_; }
  [[nodiscard]] const result::Mode& mode() const { return columns_.mode(); }
  [[nodiscard]] const std::vector<double>& alpha() const { return columns_.alpha(); }

 private:
  ModeLog::Reader reader_;
  Columns columns_;
  std::vector<bool> listed_;  ///< by column
  std::vector<std::size_t> changed_;
};

/// Names of the active modes of every group by `indicator`.
result::Regions active_regions(const model::Layout& layout, const std::vector<int>& mode) {
  result::Regions active;
  for (const auto& group : layout.groups) {
    if (group.first < 0) continue;
    active.emplace_back();
    for (int i = 0; i < group.regions; ++i) {
      if (mode[at(group.first + i)] == 0) active.back().push_back(group.mode_names[at(i)]);
    }
  }
  return active;
}

/// Weights of all modes by `indicator`: those of the inactive ones are exactly 0.
std::vector<double> region_weights(const model::Layout& layout, const std::vector<int>& mode,
                                   const std::vector<double>& alpha) {
  std::vector<double> theta;
  for (const auto& group : layout.groups) {
    for (int j = group.first; group.first >= 0 && j < group.first + group.regions; ++j) {
      theta.push_back(mode[at(j)] == 0 ? alpha[at(j)] : 0.0);
    }
  }
  return theta;
}

/// `count` numbers of a list from `begin` on.
template <class Number>
std::span<const Number> part(const std::vector<Number>& list, std::size_t begin, std::size_t count) {
  return std::span(list).subspan(begin, count);
}

/// Two columns of the result with their orientations; nullopt if one of the surfaces is in none.
std::optional<result::Intersection> intersection(const model::Layout& layout, const Meeting& meeting,
                                                 const std::vector<double>& alpha_after) {
  result::Intersection shown;
  std::array<int, 2> orientation{};
  for (std::size_t k = 0; k < 2; ++k) {
    const auto column = std::find_if(layout.columns.begin(), layout.columns.end(),
                                     [&](const auto& c) { return c.function == meeting.surfaces[k]; });
    if (column == layout.columns.end()) return std::nullopt;
    shown.surfaces[k] = column->name;
    orientation[k] = column->orientation;
  }
  const auto oriented = [&](std::size_t k, double alpha) { return orientation[k] > 0 ? alpha : 1.0 - alpha; };
  // The corner of the columns where a surface is turned around is the one across.
  const std::size_t turned = (orientation[0] < 0 ? 1U : 0U) | (orientation[1] < 0 ? 2U : 0U);
  if (meeting.alpha) shown.alpha_before.emplace();
  for (std::size_t k = 0; k < 2; ++k) {
    for (std::size_t corner = 0; corner < 4; ++corner) {
      shown.velocities[k][corner] = orientation[k] * meeting.velocities[k][corner ^ turned];
    }
    if (meeting.alpha) (*shown.alpha_before)[k] = oriented(k, (*meeting.alpha)[k]);
    shown.alpha_after[k] = oriented(k, alpha_after[at(meeting.surfaces[k])]);
  }
  return shown;
}

}  // namespace

void Recording::drop(std::size_t events, std::size_t rows) {
  const auto drop_from = [](auto& list, std::size_t count) {
    list.erase(list.begin(), list.begin() + static_cast<std::ptrdiff_t>(count));
  };
  drop_from(event_list, events);  // what they refer to stays
  drop_from(row_times, rows);
  drop_from(row_states, rows * n_x);
  drop_from(row_inputs, rows * n_u);
  drop_from(row_outputs, rows * n_y);
  drop_from(row_modes, rows);
  drop_from(row_contacts, rows * n_c);
  if (event_list.empty()) return;
  const double begin = event_list.front().t;
  std::erase_if(families, [&](const Family& family) {
    const bool goes_on = family.kind == result::FamilyKind::later_departure && family.until > begin;
    return family.event < events && !goes_on;
  });
  for (auto& family : families) {
    family.event -= std::min(events, family.event);
    family.from = std::max(family.from, begin);
  }
}

result::Events Recording::events(const model::Layout& layout) const {
  ColumnsInTime columns(layout, modes);
  Columns of_alternatives(layout);
  result::Events named;
  for (const Event& event : event_list) {
    result::Event entry;
    entry.t = event.t;
    entry.kind = event.kind;
    if (event.kind == result::EventKind::jump) entry.name = layout.jumps[event.entry].name;
    if (event.kind == result::EventKind::user) entry.name = layout.events[event.entry].name;
    for (std::size_t k = event.surfaces.begin; k < event.surfaces.end; ++k) {
      const std::size_t surface = surfaces[k];
      const bool column = surface < layout.columns.size();
      entry.surfaces.push_back(event.of_jumps ? layout.jumps[surface].name
                               : column       ? layout.columns[surface].name
                                              : layout.surfaces[surface - layout.columns.size()].name);
    }
    entry.unique = event.unique;
    for (std::size_t k = event.alternatives.begin; k < event.alternatives.end; ++k) {
      const auto& other = alternatives[k];
      of_alternatives.set(other.mode, other.alpha);
      entry.alternatives.push_back(
          {of_alternatives.mode(), of_alternatives.alpha(), active_regions(layout, other.mode)});
    }
    entry.reason = text.substr(event.reason.begin, event.reason.end - event.reason.begin);
    const auto add_side = [&](std::size_t number, auto& regions) {
      if (number == none) return named.add_side(nullptr);
      columns.seek(number);
      const auto changes = columns.changes();
      named.add_side(&changes);
      columns.forget();
      if (auto active = active_regions(layout, columns.functions().mode()); !active.empty())
        regions = std::move(active);
    };
    add_side(event.mode, entry.regions_before);
    add_side(event.mode_after, entry.regions_after);
    if (event.meeting != none)
      entry.intersection = intersection(layout, meetings[event.meeting], columns.functions().alpha());
    const auto before = part(contact_states, event.contacts, n_c),
               after = part(contact_states, event.contacts + n_c, n_c);
    const auto [begin, end] = event.impulses;
    const bool is_told = tell_contacts(layout, before, after, part(impulses, begin, end - begin), entry);
    named.push_back(std::move(entry), part(states, event.x, n_x), part(states, event.x_after, n_x));
    if (!is_told) take_into_previous(named);
  }
  return named;
}

std::vector<long> Recording::family_numbers() const {
  std::vector<long> numbers;
  for (const Family& family : families) numbers.push_back(family.number);
  return numbers;
}

std::vector<result::Family> Recording::listed_families(const model::Layout& layout) const {
  Columns columns(layout);
  std::vector<result::Family> listed;
  for (const Family& family : families) {
    columns.set(family.mode, family.alpha);
    listed.push_back({family.kind,
                      family.event,
                      family.from,
                      family.until,
                      {columns.mode(), columns.alpha(), active_regions(layout, family.mode)},
                      family.lap_ratio});
  }
  return listed;
}

result::Trajectory Recording::trajectory(const model::Layout& layout) && {
  ColumnsInTime columns(layout, modes);
  result::Trajectory rows;
  const std::size_t count = row_times.size();
  rows.t = std::move(row_times);
  rows.x = {count, n_x, std::move(row_states)};
  rows.u = {count, n_u, std::move(row_inputs)};
  rows.outputs = {count, n_y, std::move(row_outputs)};
  const bool has_regions =
      std::any_of(layout.groups.begin(), layout.groups.end(), [](const auto& group) { return group.first >= 0; });
  for (std::size_t k = 0; k < row_contacts.size(); k += n_c) {
    rows.contact_modes.push_back(contact_modes(part(row_contacts, k, n_c)));
  }
  for (std::size_t k = 0; k < count; ++k) {
    if (k > 0 && row_modes[k] == row_modes[k - 1]) {
      rows.alpha.repeat();
      rows.mode.repeat();
      if (has_regions) rows.regions.repeat(), rows.theta.repeat();
      continue;
    }
    columns.seek(row_modes[k]);
    const auto [mode, alpha, changed] = columns.changes();
    rows.alpha.push_changes(alpha, changed);
    rows.mode.push_changes(mode, changed);
    columns.forget();
    if (!has_regions) continue;
    const auto& functions = columns.functions();
    rows.regions.push_back(active_regions(layout, functions.mode()));
    rows.theta.push_back(region_weights(layout, functions.mode(), functions.alpha()));
  }
  return rows;
}

result::Final Recording::last(const model::Layout& layout) const {
  SALTUS_ASSERT(!row_times.empty());
  ModeLog::Reader reader(modes);
  Columns columns(layout);
  reader.seek(row_modes.back());
  columns.set(reader.mode(), reader.alpha());
  const auto x = part(row_states, row_states.size() - n_x, n_x);
  const auto outputs = part(row_outputs, row_outputs.size() - n_y, n_y);
  return {row_times.back(),
          {x.begin(), x.end()},
          columns.mode(),
          columns.alpha(),
          {outputs.begin(), outputs.end()},
          active_regions(layout, reader.mode()),
          region_weights(layout, reader.mode(), reader.alpha()),
          contact_modes(part(row_contacts, row_contacts.size() - n_c, n_c))};
}

}  // namespace saltus::event_integrator
