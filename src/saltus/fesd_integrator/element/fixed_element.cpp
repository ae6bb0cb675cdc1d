#include "saltus/fesd_integrator/element/fixed_element.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/base/contains.hpp"

namespace saltus::fesd_integrator {

FixedElement::FixedElement(const discretization::StageKernel& kernel, std::span<const Part> parts,
                           ElementSolver& solver)
    : kernel_(kernel), parts_(parts), solver_(solver) {
  const auto stages = static_cast<std::size_t>(solver.tableau().stages());
  sets_.resize(stages);
  modes_.resize(stages);
  flips_.resize(stages);
  first_stage_ = solver.tableau().family == discretization::TableauFamily::lobatto_iiia ? 1 : 0;
  indicators_.resize(kernel.selections());
  end_selections_.resize(kernel.selections());
}

const Part& FixedElement::part_of(int selection) const {
  return *std::find_if(parts_.begin(), parts_.end(), [&](const Part& candidate) {
    return candidate.first <= selection && selection < candidate.first + candidate.count;
  });
}

bool FixedElement::has_active_region(const Part& part, const std::vector<int>& modes) const {
  const auto first = modes.begin() + part.first;
  return std::find(first, first + part.count, 0) != first + part.count;
}

void FixedElement::look_at(std::size_t stage, const Element& element, const double* held) {
  const double t = element.t + element.h * solver_.tableau().c(static_cast<linalg::Index>(stage));
  kernel_.indicators(t, element.stage_states.data() + stage * kernel_.states(), held, indicators_.data());
  double size = element.size;
  for (const double value : indicators_) size = std::max(size, std::abs(value));
  rounding_ = 64.0 * std::numeric_limits<double>::epsilon() * size;
}

bool FixedElement::is_violated(std::size_t stage, const Condition& condition, const Element& element) const {
  const double* selections = element.stage_selections.data() + stage * kernel_.selections();
  const double value = sets_[stage].value(condition, indicators_.data(), selections);
  return !(value >= (condition.kind == Condition::Kind::side ? -rounding_ : -1e-12));
}

bool FixedElement::all_hold(const Element& element, const double* held) {
  for (std::size_t m = first_stage_; m < sets_.size(); ++m) {
    look_at(m, element, held);
    for (const Condition& condition : sets_[m].conditions()) {
      if (is_violated(m, condition, element)) return false;
    }
  }
  return true;
}

/// Changes what is violated at a stage; whether anything was.
bool FixedElement::pivot(std::size_t stage, const Element& element, const double* held) {
  const bool explicit_method = solver_.tableau().family == discretization::TableauFamily::explicit_rk;
  look_at(stage, element, held);
  bool changed = false;
  auto& modes = modes_[stage];
  for (const Condition& condition : sets_[stage].conditions()) {
    if (!is_violated(stage, condition, element)) continue;
    const auto j = static_cast<std::size_t>(condition.selection);
    changed = true;
    touched_[j] = true;
    const Part& part = part_of(condition.selection);
    if (condition.kind == Condition::Kind::side) {
      const bool again = ++flips_[stage][j] > 1 && !explicit_method;
      if (!part.simplex) {
        modes[j] = again ? 0 : -modes[j];
        continue;
      }
      for (int i = part.first; i < part.first + part.count; ++i) {
        const auto region = static_cast<std::size_t>(i);
        if (modes[region] == 0) touched_[region] = true;
        if (!again) modes[region] = -1;
      }
      modes[j] = 0;
    } else {
      modes[j] = condition.kind == Condition::Kind::upper ? 1 : -1;
      if (part.simplex && !has_active_region(part, modes)) modes[j] = 0;  // the last one of a simplex stays
    }
  }
  return changed;
}

FixedElement::Search FixedElement::by_pivoting(const Point& left, double h, const double* held, Element& element) {
  constexpr int most_pivots = 100;
  for (int pivots = 0; pivots < most_pivots; ++pivots) {
    if (solver_.solve(left, h, sets_, held, ElementSolver::Guess::left_end, element) !=
        ElementSolver::Outcome::solved) {
      return Search::stuck;
    }
    bool changed = false;
    for (std::size_t m = first_stage_; m < sets_.size(); ++m) {
      // Late in the search one change at a time: many at once can go round in circles.
      if (changed && pivots > most_pivots / 2) break;
      if (!pivot(m, element, held)) continue;
      changed = true;
      sets_[m] = ActiveSet(parts_, modes_[m]);
    }
    if (!changed) return Search::found;
  }
  return Search::stuck;
}

/// The selections that slide at `level` of their range, of regions at equal parts; all states at the left end.
void FixedElement::to_level(double level, Element& element) const {
  const std::size_t n = kernel_.selections(), n_x = kernel_.states();
  for (std::size_t m = 0; m < sets_.size(); ++m) {
    std::copy(element.x.begin(), element.x.end(), element.stage_states.begin() + static_cast<std::ptrdiff_t>(m * n_x));
    const auto& sliding = sets_[m].sliding();
    std::vector<double> values(sliding.size(), level);
    for (std::size_t k = 0; k < values.size(); ++k) {
      if (sliding[k].reference >= 0) values[k] = 1.0 / static_cast<double>(sliding.size() + 1);
    }
    sets_[m].selections(values.data(), element.stage_selections.data() + m * n);
  }
}

FixedElement::Search FixedElement::by_enumeration(const Point& left, double h, const ActiveSet& before,
                                                  const double* held, Element& element) {
  struct Choice {
    std::size_t stage;
    int selection;
    std::vector<int> modes;
  };
  std::vector<Choice> choices;
  long combinations = 1;
  constexpr long most_combinations = 20000;  // some tenths of a second for one element
  for (std::size_t m = first_stage_; m < sets_.size(); ++m) {
    for (std::size_t j = 0; j < touched_.size(); ++j) {
      if (!touched_[j]) continue;
      const bool region = part_of(static_cast<int>(j)).simplex;
      Choice choice{m, static_cast<int>(j), region ? std::vector{0, -1} : std::vector{-1, 0, 1}};
      // As before first.
      const int last = before.modes()[j];
      std::stable_partition(choice.modes.begin(), choice.modes.end(), [&](int mode) { return mode == last; });
      combinations *= static_cast<long>(choice.modes.size());
      if (combinations > most_combinations) return Search::stuck;
      choices.push_back(std::move(choice));
    }
  }
  for (long number = 0; number < combinations; ++number) {
    for (auto& modes : modes_) modes = before.modes();
    long rest = number;
    for (const Choice& choice : choices) {
      const auto count = static_cast<long>(choice.modes.size());
      modes_[choice.stage][at(choice.selection)] = choice.modes[at(rest % count)];
      rest /= count;
    }
    const bool possible = std::all_of(choices.begin(), choices.end(), [&](const Choice& choice) {
      const Part& part = part_of(choice.selection);
      return !part.simplex || has_active_region(part, modes_[choice.stage]);
    });
    if (!possible) continue;
    for (std::size_t m = 0; m < sets_.size(); ++m) sets_[m] = ActiveSet(parts_, modes_[m]);
    const auto is_found = [&](ElementSolver::Guess guess) {
      return solver_.solve(left, h, sets_, held, guess, element) == ElementSolver::Outcome::solved &&
             all_hold(element, held);
    };
    if (is_found(ElementSolver::Guess::left_end)) return Search::found;
    // Selections that slide may have several solutions: from the middle and the ends of their range, too.
    const bool slides = std::any_of(sets_.begin(), sets_.end(), [](const auto& set) { return !set.sliding().empty(); });
    for (const double level : {0.5, 0.95, 0.05}) {
      if (!slides && level != 0.5) break;
      to_level(level, element);
      if (is_found(ElementSolver::Guess::stages)) return Search::found;
    }
  }
  return Search::stuck;
}

bool FixedElement::solve(const Point& left, double h, const ActiveSet& before, const double* held, Element& element) {
  touched_.assign(before.modes().size(), false);
  for (std::size_t m = 0; m < sets_.size(); ++m) {
    sets_[m] = before;
    modes_[m] = before.modes();
    flips_[m].assign(modes_[m].size(), 0);
  }
  if (by_pivoting(left, h, held, element) == Search::stuck &&
      by_enumeration(left, h, before, held, element) == Search::stuck) {
    // Where the equations of the modes on the way have no solution, nothing has shown what else changes.
    if (!contains(touched_, false)) return false;
    touched_.assign(touched_.size(), true);
    if (by_enumeration(left, h, before, held, element) == Search::stuck) return false;
  }
  const auto n = static_cast<std::ptrdiff_t>(kernel_.selections());
  end_selections_.assign(element.stage_selections.end() - n, element.stage_selections.end());
  return true;
}

}  // namespace saltus::fesd_integrator
