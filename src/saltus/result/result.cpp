#include "saltus/result/result.hpp"

#include <algorithm>
#include <cstddef>

#include "saltus/base/contracts.hpp"

namespace saltus::result {

std::string_view name(EventKind kind) {
  switch (kind) {
    case EventKind::start:
      return "start";
    case EventKind::crossing:
      return "crossing";
    case EventKind::enter_sliding:
      return "enter_sliding";
    case EventKind::leave_sliding:
      return "leave_sliding";
    case EventKind::change_sliding:
      return "change_sliding";
    case EventKind::accumulation:
      return "accumulation";
    case EventKind::jump:
      return "jump";
    case EventKind::user:
      return "user";
    case EventKind::impact:
      return "impact";
    case EventKind::contact:
      return "contact";
    case EventKind::lift_off:
      return "lift_off";
    case EventKind::stick:
      return "stick";
    case EventKind::slip:
      return "slip";
  }
  __builtin_unreachable();
}

std::optional<EventKind> event_kind_named(std::string_view name_of_one) {
  constexpr auto last = static_cast<int>(EventKind::slip);
  for (int i = 0; i <= last; ++i) {
    const auto kind = static_cast<EventKind>(i);
    if (name(kind) == name_of_one) return kind;
  }
  return std::nullopt;
}

std::string_view name(ContactMode mode) {
  switch (mode) {
    case ContactMode::open:
      return "open";
    case ContactMode::closed:
      return "closed";
    case ContactMode::stick:
      return "stick";
    case ContactMode::slip:
      return "slip";
  }
  __builtin_unreachable();
}

std::optional<ContactMode> contact_mode_named(std::string_view name_of_one) {
  for (const auto mode : {ContactMode::open, ContactMode::closed, ContactMode::stick, ContactMode::slip}) {
    if (name(mode) == name_of_one) return mode;
  }
  return std::nullopt;
}

std::string_view name(FamilyKind kind) {
  switch (kind) {
    case FamilyKind::later_departure:
      return "later_departure";
    case FamilyKind::spiral:
      return "spiral";
  }
  __builtin_unreachable();
}

std::optional<FamilyKind> family_kind_named(std::string_view name_of_one) {
  for (const auto kind : {FamilyKind::later_departure, FamilyKind::spiral}) {
    if (name(kind) == name_of_one) return kind;
  }
  return std::nullopt;
}

std::string_view name(SurfaceRole role) {
  switch (role) {
    case SurfaceRole::switching:
      return "switching";
    case SurfaceRole::jump:
      return "jump";
    case SurfaceRole::region:
      return "region";
  }
  __builtin_unreachable();
}

std::optional<SurfaceRole> surface_role_named(std::string_view name_of_one) {
  for (const auto role : {SurfaceRole::switching, SurfaceRole::jump, SurfaceRole::region}) {
    if (name(role) == name_of_one) return role;
  }
  return std::nullopt;
}

std::string_view name(SelectionForm form) {
  switch (form) {
    case SelectionForm::step:
      return "step";
    case SelectionForm::stewart:
      return "stewart";
  }
  __builtin_unreachable();
}

std::optional<SelectionForm> selection_form_named(std::string_view name_of_one) {
  for (const auto form : {SelectionForm::step, SelectionForm::stewart}) {
    if (name(form) == name_of_one) return form;
  }
  return std::nullopt;
}

std::vector<std::string> region_labels(const std::vector<RegionGroup>& groups) {
  std::vector<std::string> labels;
  for (const auto& group : groups) {
    for (const auto& mode : group.modes) labels.push_back(group.name.empty() ? mode : group.name + "." + mode);
  }
  return labels;
}

EventKind kind_of_switch(const Mode& before, const Mode& after) {
  SALTUS_ASSERT(before.size() == after.size());
  int entered = 0;
  int left = 0;
  for (std::size_t j = 0; j < before.size(); ++j) {
    if (before[j] == after[j]) continue;
    if (after[j] == 0) ++entered;
    if (before[j] == 0) ++left;
  }
  if (entered > 0 && left > 0) return EventKind::change_sliding;
  if (entered > 0) return EventKind::enter_sliding;
  if (left > 0) return EventKind::leave_sliding;
  return EventKind::crossing;
}

std::vector<TreeEntry> tree(const Result& root) {
  std::vector<TreeEntry> entries{{&root, "main", 0}};
  const auto add = [&entries](const auto& self, std::size_t parent) -> void {
    const auto& branches = entries[parent].result->branches;
    const std::string prefix = parent == 0 ? "" : entries[parent].label + ".";
    for (std::size_t i = 0; i < branches.size(); ++i) {
      entries.push_back({&branches[i], prefix + std::to_string(i + 1), parent});
      self(self, entries.size() - 1);
    }
  };
  add(add, 0);
  return entries;
}

std::size_t not_followed(const Result& result) {
  if (result.passed_on) return result.passed_on->alternatives;
  std::size_t listed = 0;
  // The alternatives to a branch's own first mode belong to its parent.
  for (std::size_t i = result.left_at ? 1 : 0; i < result.events.size(); ++i) {
    listed += result.events.alternatives(i);
  }
  for (const auto& branch : result.branches) {
    if (branch.left_at && !branch.left_at->member && listed > 0) --listed;
  }
  return listed;
}

void Trajectory::append(const Trajectory& from, std::size_t row) {
  t.push_back(from.t[row]);
  const auto append_to = [row](auto& table, const auto& rows) {
    if (!rows.empty()) table.push_back(rows[row]);
  };
  append_to(x, from.x), append_to(u, from.u), append_to(alpha, from.alpha), append_to(mode, from.mode);
  append_to(outputs, from.outputs), append_to(regions, from.regions), append_to(theta, from.theta);
  append_to(contact_modes, from.contact_modes);
}

void Trajectory::keep(const std::vector<std::size_t>& rows) {
  for (std::size_t i = 0; i < rows.size(); ++i) t[i] = t[rows[i]];
  t.resize(rows.size());
  const auto keep_of = [&](auto& table) {
    if (!table.empty()) table.keep(rows);
  };
  keep_of(x), keep_of(u), keep_of(alpha), keep_of(mode), keep_of(outputs);
  keep_of(regions), keep_of(theta), keep_of(contact_modes);
}

}  // namespace saltus::result
