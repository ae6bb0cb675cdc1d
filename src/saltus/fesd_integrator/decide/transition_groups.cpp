// Which functions are zero where a set ended, which of them influence each other, and the patterns they may go on in.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/base/components.hpp"
#include "saltus/fesd_integrator/decide/transition.hpp"

namespace saltus::fesd_integrator {
namespace {

constexpr std::size_t most_patterns = 20000;

}  // namespace

/// Which functions are zero at the point, whatever influences them; signs of the others into `modes`.
/// @return nullopt where the indicators of regions are not finite, so that none of them is the smallest
std::optional<std::vector<int>> Transition::find_zeros(const Decision& decision, std::vector<int>& modes) {
  modes.assign(kernel_.selections(), -1);
  const std::vector<double> middle(kernel_.selections(), 0.5);
  kernel_.evaluate(decision.t, decision.x.data(), middle.data(), decision.held, values_);
  indicator_noise(values_, decision.t, decision.size, noise_);
  std::vector<bool> forced(kernel_.selections(), false);
  for (const int j : decision.at_zero) forced[at(j)] = true;
  std::vector<int> members;
  for (const Part& part : parts_) {
    double smallest = std::numeric_limits<double>::infinity();
    for (int j = part.first; j < part.first + part.count; ++j) {
      smallest = std::min(smallest, values_.indicator[at(j)]);
    }
    if (part.simplex && !std::isfinite(smallest)) return std::nullopt;
    const std::size_t begin = members.size();
    for (int j = part.first; j < part.first + part.count; ++j) {
      const double value = part.simplex ? values_.indicator[at(j)] - smallest : values_.indicator[at(j)];
      const bool zero = std::abs(value) <= 4.0 * noise_[at(j)] || forced[at(j)];
      if (part.simplex) {
        // One of the tied regions alone, as a classical mode stands for the other groups while one is asked.
        modes[at(j)] = zero && members.size() == begin ? 0 : -1;
      } else {
        modes[at(j)] = value > 0.0 ? 1 : -1;
      }
      if (zero) members.push_back(j);
    }
    if (part.simplex && members.size() == begin + 1) members.pop_back();  // one region: nothing to decide
  }
  modes_at_zero_ = modes;
  for (const int j : members) modes_at_zero_[at(j)] = 0;
  return members;
}

/// Joins members a and b where d(psi_a)/dt depends on selection b as values_ were evaluated, or both are regions of one
/// simplex.
void Transition::join_by_influence(const std::vector<int>& members, Components& components) const {
  std::vector<int> first_of(parts_.size(), -1), row_of(kernel_.selections(), -1);
  for (std::size_t k = 0; k < members.size(); ++k) row_of[at(members[k])] = static_cast<int>(k);
  for (std::size_t k = 0; k < members.size(); ++k) {
    const auto part = at(part_of_[at(members[k])]);
    if (parts_[part].simplex) {
      if (first_of[part] < 0) first_of[part] = static_cast<int>(k);
      components.join(at(first_of[part]), k);
    }
    visit_row(values_.pattern->indicator_x, values_.indicator_x, at(members[k]), [&](std::size_t i, double gradient) {
      visit_row(values_.pattern->f_selection, values_.f_selection, i, [&](std::size_t b, double jump) {
        if (row_of[b] >= 0 && gradient * jump != 0.0) components.join(at(row_of[b]), k);
      });
    });
  }
}

/// Members that influence each other at any of three points of the cube, and the size of a rate: of its largest terms
/// there, as f may cancel inside.
std::vector<std::vector<int>> Transition::find_influences(const Decision& decision, const std::vector<int>& modes,
                                                          const std::vector<int>& members) {
  const std::size_t n = kernel_.selections();
  size_.assign(n, 0.0);
  Components components(members.size());
  std::vector<double> selections(n), sum(n);
  for (std::size_t j = 0; j < n; ++j) {
    selections[j] = modes[j] == (parts_[at(part_of_[j])].simplex ? 0 : 1) ? 1.0 : 0.0;
  }
  for (const double level : {0.5, 0.0, 1.0}) {
    for (const int j : members) selections[at(j)] = level;
    kernel_.evaluate(decision.t, decision.x.data(), selections.data(), decision.held, values_);
    for (std::size_t j = 0; j < n; ++j) sum[j] = std::abs(values_.indicator_t[j]);
    for (std::size_t i = 0; i < kernel_.states(); ++i) {
      visit_column(values_.pattern->indicator_x, values_.indicator_x, i,
                   [&](std::size_t j, double gradient) { sum[j] += std::abs(gradient * values_.f[i]); });
    }
    for (std::size_t j = 0; j < n; ++j) size_[j] = std::max(size_[j], sum[j]);
    join_by_influence(members, components);
  }
  for (std::size_t k = 0; k < members.size(); ++k) {
    const auto governor = std::find(members.begin(), members.end(), rests_.governor(members[k]));
    if (governor != members.end()) components.join(k, at(governor - members.begin()));
  }
  return components.lists_of(members);
}

/// Whether a group that slid before the point does so clearly at it.
bool Transition::slides_on(const Decision& decision, const std::vector<int>& group,
                           const std::vector<double>& selections) const {
  return std::all_of(group.begin(), group.end(), [&](int j) {
    const double value = selections[at(j)];
    const bool region = parts_[at(part_of_[at(j)])].simplex;
    return decision.before->modes()[at(j)] == 0 && j != decision.ended &&
           std::min(value, region ? 1.0 : 1.0 - value) > undecided;
  });
}

/// Takes out the groups that slide on, as nothing that influences them has changed.
void Transition::keep_sliding(const Decision& decision, std::vector<std::vector<int>>& groups,
                              std::vector<int>& modes) {
  const ActiveSet& before = *decision.before;
  std::vector<double> selections(kernel_.selections());
  const auto middle = before.middle();
  before.selections(middle.data(), selections.data());
  const double rounding = ProjectedField::rounding_of_rates(decision.size, decision.trial_length);
  if (!projected_.solve(decision.t, decision.x.data(), before, decision.held, selections.data(), rounding) ||
      !projected_.regular() || !before.balances().empty()) {
    return;
  }
  std::erase_if(groups, [&](const std::vector<int>& group) {
    if (!slides_on(decision, group, selections)) return false;
    for (const int j : group) modes[at(j)] = 0;
    kept_.insert(kept_.end(), group.begin(), group.end());
    return true;
  });
}

/// Groups of functions that are zero at the point and influence each other, and their patterns.
/// @return false as find_zeros()
bool Transition::find_groups(const Decision& decision, Rule rule, std::vector<int>& modes) {
  groups_.clear();
  kept_.clear();
  depends_ = false;
  const auto members = find_zeros(decision, modes);
  if (!members || members->empty()) return members.has_value();
  rests_.find({decision.t, decision.x, decision.held, decision.size}, parts_, *members);
  auto groups = find_influences(decision, modes, *members);
  const bool by_parts = kernel_.pattern().is_sparse && decision.before != nullptr && decision.ended >= 0;
  if (by_parts) keep_sliding(decision, groups, modes);
  for (auto& group : groups) {
    Group& entry = groups_.emplace_back();
    entry.members = std::move(group);
    if (rule == Rule::dependent && find_dependent(decision, modes, entry)) {
      depends_ = true;
    } else {
      find_patterns(decision, entry, rule);
    }
  }
  return true;
}

/// Every combination of what members may be; empty where that is too many.
std::vector<std::vector<int>> Transition::combinations(const Group& group, const Decision& decision, Asked asked,
                                                       Rule rule) const {
  const auto every = decision.before == nullptr ? std::array{1, -1, 0} : std::array{0, 1, -1};
  std::vector<std::vector<int>> patterns{{}};
  for (const int j : group.members) {
    const bool region = parts_[at(part_of_[at(j)])].simplex;
    const bool is_asked = asked == Asked::all || j == decision.ended || decision.before->modes()[at(j)] != 0;
    std::vector<std::vector<int>> longer;
    for (const auto& pattern : patterns) {
      for (const int mode : every) {
        if (mode != 0 && (!is_asked || (region && mode == 1))) continue;
        longer.push_back(pattern);
        longer.back().push_back(mode);
        if (rule == Rule::dependent && !rests_.allow(group.members, longer.back())) longer.pop_back();
      }
      if (longer.size() > most_patterns) return {};
    }
    patterns = std::move(longer);
  }
  return patterns;
}

/// All combinations, or of too many members those in which what slid before and did not end slides on: others may
/// continue the solution, too.
void Transition::find_patterns(const Decision& decision, Group& group, Rule rule) const {
  group.patterns = combinations(group, decision, Asked::all, rule);
  if (group.patterns.empty() && decision.before != nullptr && decision.ended >= 0) {
    group.patterns = combinations(group, decision, Asked::changed, rule);
    group.decided = false;
  }
  auto& patterns = group.patterns;
  // Every simplex needs an active region.
  std::erase_if(patterns, [&](const auto& pattern) {
    for (std::size_t k = 0; k < pattern.size(); ++k) {
      const int part = part_of_[at(group.members[k])];
      if (!parts_[at(part)].simplex) continue;
      bool active = false;
      for (std::size_t l = 0; l < pattern.size(); ++l) {
        active = active || (part_of_[at(group.members[l])] == part && pattern[l] == 0);
      }
      if (!active) return true;
    }
    return false;
  });
  const auto rank = [&](const auto& pattern) {
    int changes = 0, sliding = 0;
    for (std::size_t k = 0; k < pattern.size(); ++k) {
      if (decision.before != nullptr) changes += decision.before->modes()[at(group.members[k])] != pattern[k] ? 1 : 0;
      sliding += parts_[at(part_of_[at(group.members[k])])].simplex && pattern[k] == 0 ? 1 : 0;
    }
    return std::pair(changes, sliding);
  };
  std::stable_sort(patterns.begin(), patterns.end(), [&](const auto& a, const auto& b) { return rank(a) < rank(b); });
}

}  // namespace saltus::fesd_integrator
