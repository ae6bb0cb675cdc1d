#include "saltus/fesd_integrator/decide/transition.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/base/components.hpp"
#include "saltus/base/contains.hpp"

namespace saltus::fesd_integrator {
namespace {

std::vector<bool> mask_of(const std::vector<int>& members, std::size_t n) {
  std::vector<bool> mask(n, false);
  for (const int j : members) mask[at(j)] = true;
  return mask;
}

constexpr double same = 1e-7;
/// Of a selection that is at its bound as the double root of its equations.
constexpr double same_at_double_root = 1e-4;

bool are_near(const std::vector<double>& a, const std::vector<double>& b, double near = same) {
  if (a.empty() || a.size() != b.size()) return false;
  double size = 1.0;  // of selections
  for (std::size_t i = 0; i < a.size(); ++i) size = std::max({size, std::abs(a[i]), std::abs(b[i])});
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!(std::abs(a[i] - b[i]) <= near * size)) return false;
  }
  return true;
}

}  // namespace

/// Whether one slides on surfaces on a side of which the other one is.
bool Transition::slides_beside(const Option& sliding, const Option& beside) {
  if (sliding.pattern == beside.pattern) return false;
  for (std::size_t k = 0; k < sliding.pattern.size(); ++k) {
    if (sliding.pattern[k] != beside.pattern[k] && sliding.pattern[k] != 0) return false;
  }
  return true;
}

/// Whether what one slides on has not moved at all while the other one was beside it.
bool Transition::stands_still(const Option& beside, const Option& sliding, const Group& group) {
  for (std::size_t k = 0; k < beside.pattern.size(); ++k) {
    if (beside.pattern[k] != sliding.pattern[k] && !contains(beside.still, group.members[k])) return false;
  }
  return true;
}

/// Whether an option is no other continuation than this one: it moves in the same way, and its selections follow from
/// higher derivatives where this one has its own; or it is a side that psi stays at without leaving zero; or it slides
/// where psi does not move at all on a side: nothing may determine its selections a little later.
bool Transition::stands_for(const Option& option, const Option& other, const Group& group) {
  const bool regular = option.regular && other.regular;
  if (option.regular && !other.regular && slides_beside(other, option) && stands_still(option, other, group)) {
    return are_near(option.selections, other.selections, same_at_double_root);
  }
  if (!(regular ? are_near(option.selections, other.selections) : are_near(option.motion, other.motion))) return false;
  if (option.regular != other.regular) return option.regular;
  if (slides_beside(other, option)) return regular && stands_still(option, other, group);
  if (!slides_beside(option, other)) return false;
  return other.trial == Trial::stays && !(regular && stands_still(other, option, group));
}

/// Whether an option moves as another one does, and what differs has not moved at all in it.
bool Transition::stays_beside(const Option& option, const Option& other, const Group& group) {
  return option.trial == Trial::stays && are_near(option.motion, other.motion) && stands_still(option, other, group);
}

Transition::Transition(const discretization::StageKernel& kernel, std::span<const Part> parts, ElementSolver& solver)
    : kernel_(kernel),
      parts_(parts),
      solver_(solver),
      projected_(kernel),
      watch_(kernel, solver),
      rests_(kernel, parts) {
  kernel.size(values_);
  part_of_.resize(kernel.selections());
  for (std::size_t p = 0; p < parts.size(); ++p) {
    for (int j = parts[p].first; j < parts[p].first + parts[p].count; ++j) part_of_[at(j)] = static_cast<int>(p);
  }
}

/// How clearly the signs of a group hold just behind the point: > 0 they do, < 0 they do not, relative to the size of
/// what is compared; the candidate gets its selections.
double Transition::margin(const Decision& decision, const Group& group, Continuation& candidate) {
  const auto& sliding = candidate.set.sliding();
  auto unknown = candidate.set.middle();
  const double from_middle = margin_from(unknown, decision, group, candidate);
  // The selections of several surfaces solve a multi-affine system with several roots: also from near the corners.
  constexpr std::size_t most_sliding = 4;
  const bool one_root = sliding.size() < 2 || !candidate.set.balances().empty();
  if (from_middle >= -undecided || one_root || sliding.size() > most_sliding) return from_middle;
  for (unsigned corner = 0; corner < 1U << sliding.size(); ++corner) {
    for (std::size_t k = 0; k < unknown.size(); ++k) unknown[k] = (corner >> k & 1U) != 0 ? 0.85 : 0.15;
    const double value = margin_from(unknown, decision, group, candidate);
    if (value >= -undecided) return value;
  }
  return from_middle;
}

/// The same with the selections that Newton's method finds from `unknown`.
double Transition::margin_from(const std::vector<double>& unknown, const Decision& decision, const Group& group,
                               Continuation& candidate) {
  const auto& set = candidate.set;
  candidate.selections.resize(kernel_.selections());
  set.selections(unknown.data(), candidate.selections.data());
  // What begins to slide between switches that accumulate has a rate, however small.
  const bool begins = decision.before != nullptr && set.sliding().size() > decision.before->sliding().size();
  const double rounding = begins ? 0.0 : ProjectedField::rounding_of_rates(decision.size, decision.trial_length);
  if (!projected_.solve(decision.t, decision.x.data(), set, decision.held, candidate.selections.data(), rounding)) {
    return -1.0;
  }
  projected_.rates(rate_);
  if (!take_from_trial(decision, candidate)) return -1.0;
  if (!set.balances().empty()) {
    DenseMatrices memory;
    margins_.evaluate(set, field_view(projected_.values(), memory), candidate.selections.data());
  }
  // Rates were those at other selections: they may exclude a set, but do not decide for it.
  double least = follows_from_trial(candidate) ? undecided : 1.0;
  const auto asked = mask_of(group.members, kernel_.selections());
  for (const Condition& condition : set.conditions()) {
    if (!asked[at(condition.selection)]) continue;
    const bool margin = condition.kind != Condition::Kind::side && !set.is_determined(condition.selection);
    double value = margin ? margins_.value(condition) : set.value(condition, rate_.data(), candidate.selections.data());
    if (condition.kind == Condition::Kind::side) {
      double size = size_[at(condition.selection)];
      for (const int j : group.members) {
        if (part_of_[at(j)] == part_of_[at(condition.selection)] && parts_[at(part_of_[at(j)])].simplex) {
          size = std::max(size, size_[at(j)]);
        }
      }
      // Nor does a rate decide that leaves psi within its rounding: it may be that of a velocity which is 0.
      const bool leaves = std::abs(value) * decision.trial_length > noise_[at(condition.selection)];
      value = size > 0.0 && leaves ? value / size : 0.0;
    }
    if (!std::isfinite(value)) return -1.0;
    least = std::min(least, value);
  }
  return least;
}

ElementSolver::Outcome Transition::solve_trial(const Decision& decision, const Continuation& candidate, double length) {
  const Point left{decision.t, {decision.x.begin(), decision.x.end()}, candidate.selections, decision.size};
  const auto guess = projected_.regular() ? ElementSolver::Guess::left_end : ElementSolver::Guess::field;
  return solver_.solve(left, length, {&candidate.set, 1}, decision.held, guess, trial_);
}

/// Whether a selection follows from a higher derivative of its surface only.
bool Transition::follows_from_trial(const Continuation& candidate) const {
  if (projected_.regular()) return false;
  bool any = false;
  for (std::size_t k = 0; k < candidate.set.sliding().size(); ++k) any = any || projected_.in_no_equation(k);
  return any;
}

/// Such selections are those of a short element.
bool Transition::take_from_trial(const Decision& decision, Continuation& candidate) {
  if (!follows_from_trial(candidate)) return true;
  if (solve_trial(decision, candidate, decision.trial_length) != ElementSolver::Outcome::solved) return false;
  const std::size_t n = kernel_.selections();
  const double* last = trial_.stage_selections.data() + trial_.stage_selections.size() - n;
  projected_.take_undetermined(candidate.set, last, candidate.selections.data());
  projected_.evaluate(decision.t, decision.x.data(), decision.held, candidate.selections.data());
  return true;
}

/// By the end of an element: where psi leaves zero like t^3 its polynomial has other signs on the way.
Transition::Trial Transition::try_element(const Decision& decision, const Group& group, const Continuation& candidate,
                                          double length, std::vector<int>& still) {
  if (solve_trial(decision, candidate, length) != ElementSolver::Outcome::solved) return Trial::unsolved;
  auto selections = candidate.selections;
  Violation ignored;
  const std::span<const int> members(group.members.data(), group.members.size());
  const auto answer = watch_.look(trial_, candidate.set, decision.held, selections, ignored, members);
  if (answer == Watch::Answer::not_finite) return Trial::unsolved;
  constexpr double clear = 16.0;  // of roundings
  bool stays = false;
  still.clear();
  for (const Condition& condition : candidate.set.conditions()) {
    if (!contains(members, condition.selection)) continue;
    const double value = watch_.end_value(candidate.set, condition), rounding = clear * watch_.noise(condition);
    if (value < -rounding) return Trial::fails;
    if (value > rounding) continue;
    stays = true;
    if (condition.kind != Condition::Kind::side || decision.before == nullptr) continue;
    // What has no rate at all may have the roundings of Newton's method.
    const double moved = std::abs(value - watch_.left_value(candidate.set, condition));
    const bool stands = rate_[at(condition.selection)] == 0.0 && moved <= watch_.noise(condition);
    if (moved == 0.0 || stands) still.push_back(condition.selection);
  }
  return stays ? Trial::stays : Trial::holds;
}

/// By the shortest element behind which signs are clear of their roundings: psi may leave zero like t^3 or t^4.
void Transition::try_elements(const Decision& decision, const Group& group, const Continuation& candidate,
                              Option& option) {
  const auto attempt = [&](double factor) {
    return try_element(decision, group, candidate, factor * decision.trial_length, option.still);
  };
  option.trial = attempt(1.0);
  if (option.trial == Trial::fails) {
    // What ends inside of the trial is the next switch.
    if (attempt(0.125) == Trial::holds) option.trial = Trial::holds;
    return;
  }
  // The trial length is the 128th part of an element.
  for (const double factor : {8.0, 64.0}) {
    if (option.trial != Trial::stays) break;
    const auto still = option.still;
    const Trial longer = attempt(factor);
    if (longer == Trial::unsolved) {
      option.still = still;
      break;
    }
    option.trial = longer;
  }
}

std::vector<Continuation> Transition::continuations(const Decision& decision) {
  auto found = continuations(decision, Rule::dependent);
  if (found.empty() && !kept_.empty()) {
    Decision all = decision;
    all.ended = -1;
    return continuations(all);
  }
  const bool all_decided = std::all_of(groups_.begin(), groups_.end(), [](const auto& group) { return group.decided; });
  if (found.empty() && (depends_ || rests_.any() || !all_decided)) found = continuations(decision, Rule::enumeration);
  return found.empty() && skipped_ ? continuations(decision, Rule::everything) : found;
}

void Transition::put(const Group& group, const std::vector<int>& pattern, std::vector<int>& modes) {
  for (std::size_t k = 0; k < pattern.size(); ++k) modes[at(group.members[k])] = pattern[k];
}

std::optional<Transition::Option> Transition::option_of(const Decision& decision, const Group& group,
                                                        const std::vector<int>& pattern,
                                                        const std::vector<int>& modes) {
  auto trial = modes;
  put(group, pattern, trial);
  Continuation candidate{make_set(decision, trial), {}};
  const double value = margin(decision, group, candidate);
  if (value < -undecided) return std::nullopt;
  Option option{.pattern = pattern, .margin = value, .regular = projected_.regular()};
  option.motion = projected_.values().f;
  return option;
}

/// Whether regions whose weights are not determined are asked only where nothing else continues: fewer of them have the
/// same motion, or they are many.
bool Transition::is_left_out(const Support& support, const std::vector<std::pair<std::size_t, Option>>& found) {
  constexpr std::ptrdiff_t many = 16;
  if (std::count(support.pattern.begin(), support.pattern.end(), 0) > many) return true;
  Option all;
  all.pattern = support.pattern;
  return std::any_of(found.begin(), found.end(), [&](const auto& other) {
    return slides_beside(all, other.second) && are_near(other.second.motion, support.motion);
  });
}

/// The patterns of a group that its rates do not exclude while the other groups are as in `modes`; of those that are
/// regular, or else of all, the one with the largest margin into `guess`.
std::vector<Transition::Option> Transition::options_of(const Decision& decision, const Group& group, Rule rule,
                                                       const std::vector<int>& modes, std::vector<int>& guess) {
  std::vector<std::pair<std::size_t, Option>> found;
  std::vector<std::pair<std::size_t, Support>> open;
  const auto ask = [&](std::size_t place, const std::vector<int>& pattern) {
    if (auto option = option_of(decision, group, pattern, modes)) found.emplace_back(place, std::move(*option));
  };
  for (std::size_t i = 0; i < group.patterns.size(); ++i) {
    auto trial = modes;
    put(group, group.patterns[i], trial);
    for (Support& support : supports_of(decision, group, group.patterns[i], trial)) {
      if (support.determined) {
        ask(i, support.pattern);
      } else {
        open.emplace_back(i, std::move(support));
      }
    }
  }
  for (const auto& [i, support] : open) {
    if (rule != Rule::everything && is_left_out(support, found)) {
      skipped_ = true;
      continue;
    }
    const auto fewer = without_negative(decision, group, support.pattern, modes);
    if (!support.motion.empty() || fewer == support.pattern) ask(i, fewer);
  }
  std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<Option> options;
  std::pair best{false, -2.0};
  for (auto& [place, option] : found) {
    // A set with selections that no equation determines says nothing of the other groups.
    const std::pair likelier{option.regular, option.margin};
    if (likelier > best) put(group, option.pattern, guess);
    best = std::max(best, likelier);
    options.push_back(std::move(option));
  }
  return options;
}

/// Of these options those that hold with the other groups as in `guess`, by short elements where rates do not decide.
std::vector<std::vector<int>> Transition::admissible_of(const Decision& decision, const Group& group,
                                                        std::vector<Option> options, const std::vector<int>& guess) {
  std::vector<Option> passed;
  for (Option& option : options) {
    auto trial = guess;
    put(group, option.pattern, trial);
    Continuation candidate{make_set(decision, trial), {}};
    if (option.margin <= undecided || group.dependent || !option.regular) {
      if (margin(decision, group, candidate) < -undecided) continue;
      option.regular = projected_.regular();
      try_elements(decision, group, candidate, option);
      if (option.trial == Trial::fails || option.trial == Trial::unsolved) continue;
      option.motion = projected_.values().f;
    }
    option.selections = std::move(candidate.selections);
    passed.push_back(std::move(option));
    if (group.dependent) break;
  }
  std::vector<const Option*> kept;
  for (const Option& option : passed) {
    const auto known = [&](const Option& other) { return stands_for(other, option, group); };
    const auto same = [&](const Option* other) { return stays_beside(option, *other, group); };
    if (std::none_of(passed.begin(), passed.end(), known) && std::none_of(kept.begin(), kept.end(), same)) {
      kept.push_back(&option);
    }
  }
  std::vector<std::vector<int>> admissible;
  for (const Option* option : kept) admissible.push_back(option->pattern);
  return admissible;
}

/// The set with these modes, if all groups together hold in it; nullopt if they do not.
std::optional<Continuation> Transition::continuation_in(const Decision& decision, const std::vector<int>& modes) {
  Group all;
  for (const Group& group : groups_) all.members.insert(all.members.end(), group.members.begin(), group.members.end());
  all.members.insert(all.members.end(), kept_.begin(), kept_.end());
  Continuation candidate{make_set(decision, modes), {}};
  if (margin(decision, all, candidate) < -undecided) return std::nullopt;
  candidate.decided = std::all_of(groups_.begin(), groups_.end(), [](const Group& group) { return group.decided; });
  if (!projected_.regular()) {
    candidate.determined = solve_trial(decision, candidate, decision.trial_length) == ElementSolver::Outcome::solved &&
                           solver_.determined();
  }
  return candidate;
}

std::vector<Continuation> Transition::continuations(const Decision& decision, Rule rule) {
  std::vector<int> modes;
  skipped_ = false;
  finite_ = find_groups(decision, rule, modes);
  if (!finite_) return {};
  // A first guess at every group, so that each is asked with the others in place: what has the largest margin.
  std::vector<std::vector<Option>> options;
  std::vector<int> guess = modes;
  for (const Group& group : groups_) {
    options.push_back(options_of(decision, group, rule, modes, guess));
    if (options.back().empty()) return {};
  }
  std::vector<std::vector<std::vector<int>>> admissible;
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    admissible.push_back(admissible_of(decision, groups_[g], std::move(options[g]), guess));
    if (admissible[g].empty()) return {};
    put(groups_[g], admissible[g].front(), guess);
  }
  std::vector<Continuation> found;
  const auto keep = [&](const std::vector<int>& chosen) {
    if (auto next = continuation_in(decision, chosen)) found.push_back(std::move(*next));
  };
  keep(guess);
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    for (std::size_t k = 1; k < admissible[g].size(); ++k) {
      auto other = guess;
      put(groups_[g], admissible[g][k], other);
      keep(other);
    }
  }
  return found;
}

}  // namespace saltus::fesd_integrator
