#include "saltus/result/result.hpp"

#include <algorithm>
#include <cstddef>

#include "saltus/base/contracts.hpp"
#include "saltus/base/enum_names.hpp"

namespace saltus::result {
namespace {

constexpr EnumNames<EventKind::slip> event_kinds("start", "crossing", "enter_sliding", "leave_sliding",
                                                 "change_sliding", "accumulation", "jump", "user", "impact", "contact",
                                                 "lift_off", "stick", "slip");
constexpr EnumNames<ContactMode::slip> contact_mode_names("open", "closed", "stick", "slip");
constexpr EnumNames<FamilyKind::spiral> family_kinds("later_departure", "spiral");
constexpr EnumNames<SurfaceRole::region> surface_roles("switching", "jump", "region");
constexpr EnumNames<SelectionForm::stewart> selection_forms("step", "stewart");

}  // namespace

std::string_view name(EventKind kind) { return event_kinds(kind); }
std::optional<EventKind> event_kind_named(std::string_view text) { return event_kinds.named(text); }

std::string_view name(ContactMode mode) { return contact_mode_names(mode); }
std::optional<ContactMode> contact_mode_named(std::string_view text) { return contact_mode_names.named(text); }

std::string_view name(FamilyKind kind) { return family_kinds(kind); }
std::optional<FamilyKind> family_kind_named(std::string_view text) { return family_kinds.named(text); }

std::string_view name(SurfaceRole role) { return surface_roles(role); }
std::optional<SurfaceRole> surface_role_named(std::string_view text) { return surface_roles.named(text); }

std::string_view name(SelectionForm form) { return selection_forms(form); }
std::optional<SelectionForm> selection_form_named(std::string_view text) { return selection_forms.named(text); }

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
