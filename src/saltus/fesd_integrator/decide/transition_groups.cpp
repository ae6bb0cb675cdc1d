// Which functions are zero where a set ended, which of them influence each other, and the patterns they may go on in.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/base/components.hpp"
#include "saltus/base/contains.hpp"
#include "saltus/fesd_integrator/decide/surface_modes.hpp"
#include "saltus/fesd_integrator/decide/transition.hpp"

namespace saltus::fesd_integrator {
namespace {

constexpr std::size_t most_patterns = 20000;
/// Of more patterns those are asked first in which what slid before and did not end slides on.
constexpr std::size_t few_patterns = 243;

/// Regions meet where surfaces do: with those on both sides of some of them all that these separate.
void add_regions_between(const Part& part, std::vector<bool>& meet) {
  const auto modes = surface_modes(part, [&](int region) { return bool{meet[at(region - part.first)]}; });
  for (int region = part.first; region < part.first + part.count; ++region) {
    bool all = true;
    for (int k = 0; k < part.surfaces; ++k) {
      all = all && (modes[at(k)] == 0 || modes[at(k)] == part.side(region, k));
    }
    meet[at(region - part.first)] = all;
  }
}

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
    const auto noise = noise_.begin() + part.first;
    if (part.simplex) std::fill_n(noise, part.count, *std::max_element(noise, noise + part.count));
    const std::size_t begin = members.size();
    std::vector<bool> is_zero(at(part.count));
    const auto value_of = [&](int j) { return values_.indicator[at(j)] - (part.simplex ? smallest : 0.0); };
    for (int j = part.first; j < part.first + part.count; ++j) {
      is_zero[at(j - part.first)] = std::abs(value_of(j)) <= 4.0 * noise_[at(j)] || forced[at(j)];
    }
    if (part.surfaces > 0) add_regions_between(part, is_zero);
    for (int j = part.first; j < part.first + part.count; ++j) {
      const double value = value_of(j);
      const bool zero = is_zero[at(j - part.first)];
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
  rests_.find({decision.t, decision.x, decision.held, decision.size}, *members);
  auto groups = find_influences(decision, modes, *members);
  find_approaches(decision, *members);
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

/// What members may be is enumerated for each of these: a step function, a region with an indicator of its own, or a
/// surface between regions that are sign patterns.
std::vector<Transition::Choice> Transition::choices_of(const Decision& decision, const Group& group) const {
  std::vector<Choice> choices;
  for (std::size_t k = 0; k < group.members.size(); ++k) {
    const int j = group.members[k];
    const Part& part = parts_[at(part_of_[at(j)])];
    const bool was_fixed = decision.before != nullptr && decision.before->modes()[at(j)] != 0;
    if (part.surfaces == 0) {
      const auto kind = part.simplex ? Choice::Kind::region : Choice::Kind::function;
      const bool ends = j == decision.ended || approaches_[at(j)] == Approach::at_bound;
      choices.push_back({kind, k, 0, part.simplex ? -1 : j, ends || was_fixed});
      continue;
    }
    if (k > 0 && part_of_[at(group.members[k - 1])] == part_of_[at(j)]) continue;
    const auto modes = surface_modes(part, [&](int region) { return contains(group.members, region); });
    const auto before = modes_before(decision, part);
    const bool ended = decision.ended >= part.first && decision.ended < part.first + part.count;
    for (int surface = 0; surface < part.surfaces; ++surface) {
      if (modes[at(surface)] != 0) continue;
      const int function = rests_.function(part_of_[at(j)], surface);
      const bool is_asked = ended || before.empty() || before[at(surface)] != 0;
      choices.push_back({Choice::Kind::surface, k, surface, function, is_asked});
    }
  }
  return choices;
}

std::vector<int> Transition::modes_before(const Decision& decision, const Part& part) {
  if (decision.before == nullptr) return {};
  return surface_modes(part, [&](int region) { return decision.before->modes()[at(region)] == 0; });
}

/// Takes the regions that are not on a side of a surface out of a pattern.
void Transition::leave_side(const Group& group, const Choice& choice, int mode, std::vector<int>& pattern) const {
  const int p = part_of_[at(group.members[choice.member])];
  for (std::size_t k = 0; k < pattern.size() && mode != 0; ++k) {
    const int j = group.members[k];
    if (part_of_[at(j)] == p && parts_[at(p)].side(j, choice.surface) != mode) pattern[k] = -1;
  }
}

/// Where a surface holds another one, regions are active on one side of that other one alone.
/// @return whether it is another combination than the one on that side
bool Transition::leave_idle_sides(const Group& group, const std::vector<Choice>& choices,
                                  Combination& combination) const {
  const auto& modes = combination.modes;
  for (std::size_t j = 0; j < choices.size(); ++j) {
    const int function = choices[j].function;
    if (choices[j].kind != Choice::Kind::surface || modes[j] != 0 || !rests_.holds(function)) continue;
    for (std::size_t r = 0; r < choices.size(); ++r) {
      if (choices[r].function != rests_.governor(function)) continue;
      if (modes[r] == rests_.held_side(function)) return false;
      if (modes[r] == 0) leave_side(group, choices[r], rests_.held_side(function), combination.pattern);
    }
  }
  return true;
}

/// Every combination of what members may be; empty where that is too many.
std::vector<std::vector<int>> Transition::combinations(const Group& group, const Decision& decision, Asked asked,
                                                       Rule rule) const {
  const auto every = decision.before == nullptr ? std::array{1, -1, 0} : std::array{0, 1, -1};
  const auto choices = choices_of(decision, group);
  std::vector<int> functions;
  for (const Choice& choice : choices) functions.push_back(choice.function);
  std::vector<Combination> combinations{{std::vector<int>(group.members.size(), 0), {}}};
  for (const Choice& choice : choices) {
    std::vector<Combination> more;
    for (const auto& [pattern, modes] : combinations) {
      for (const int mode : every) {
        const bool is_asked = asked == Asked::all || choice.is_asked;
        if (mode != 0 && (!is_asked || (choice.kind == Choice::Kind::region && mode == 1))) continue;
        Combination next{pattern, modes};
        next.modes.push_back(mode);
        if (rule == Rule::dependent && !rests_.allow(functions, next.modes)) continue;
        if (choice.kind == Choice::Kind::surface) {
          leave_side(group, choice, mode, next.pattern);
        } else {
          next.pattern[choice.member] = mode;
        }
        more.push_back(std::move(next));
      }
      if (more.size() > most_patterns) return {};
    }
    combinations = std::move(more);
  }
  std::vector<std::vector<int>> patterns;
  for (Combination& combination : combinations) {
    if (leave_idle_sides(group, choices, combination)) patterns.push_back(std::move(combination.pattern));
  }
  return patterns;
}

/// All combinations, or of too many members those in which what slid before and did not end slides on: others may
/// continue the solution, too.
void Transition::find_patterns(const Decision& decision, Group& group, Rule rule) const {
  group.patterns = combinations(group, decision, Asked::all, rule);
  const bool are_few = !group.patterns.empty() && (group.patterns.size() <= few_patterns || rule != Rule::dependent);
  if (!are_few && decision.before != nullptr && decision.ended >= 0) {
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
  std::vector<std::pair<Rank, std::size_t>> order;
  for (std::size_t i = 0; i < patterns.size(); ++i) order.emplace_back(rank(decision, group, patterns[i]), i);
  std::sort(order.begin(), order.end());
  std::vector<std::vector<int>> sorted;
  for (const auto& [unused, i] : order) sorted.push_back(std::move(patterns[i]));
  patterns = std::move(sorted);
}

}  // namespace saltus::fesd_integrator
