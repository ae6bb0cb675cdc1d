#include "saltus/fesd_integrator/fixed_element.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace saltus::fesd_integrator {

FixedElement::FixedElement(const discretization::StageKernel& kernel, std::span<const Part> parts,
                           ElementSolver& solver)
    : kernel_(kernel), parts_(parts), solver_(solver) {
  const auto stages = static_cast<std::size_t>(solver.tableau().stages());
  sets_.resize(stages);
  modes_.resize(stages);
  flips_.resize(stages);
  indicators_.resize(kernel.selections());
  end_selections_.resize(kernel.selections());
}

/// Changes what is violated at a stage; whether anything was.
bool FixedElement::pivot(std::size_t stage, const Element& element, const double* held) {
  const ActiveSet& set = sets_[stage];
  const std::size_t n = kernel_.selections(), n_x = kernel_.states();
  const bool explicit_method = solver_.tableau().family == discretization::TableauFamily::explicit_rk;
  const double t = element.t + element.h * solver_.tableau().c(static_cast<Eigen::Index>(stage));
  const double* selections = element.stage_selections.data() + stage * n;
  kernel_.indicators(t, element.stage_states.data() + stage * n_x, held, indicators_.data());
  double size = element.size;
  for (const double value : indicators_) size = std::max(size, std::abs(value));
  const double rounding = 64.0 * std::numeric_limits<double>::epsilon() * size;
  bool changed = false;
  auto& modes = modes_[stage];
  for (const Condition& condition : set.conditions()) {
    const auto j = static_cast<std::size_t>(condition.selection);
    const double value = set.value(condition, indicators_.data(), selections);
    if (value >= (condition.kind == Condition::Kind::side ? -rounding : -1e-12)) continue;
    changed = true;
    const auto part = std::find_if(parts_.begin(), parts_.end(), [&](const Part& candidate) {
      return candidate.first <= condition.selection && condition.selection < candidate.first + candidate.count;
    });
    if (condition.kind == Condition::Kind::side) {
      const bool again = ++flips_[stage][j] > 1 && !explicit_method;
      if (!part->simplex) {
        modes[j] = again ? 0 : -modes[j];
        continue;
      }
      if (!again) {
        for (int i = part->first; i < part->first + part->count; ++i) modes[static_cast<std::size_t>(i)] = -1;
      }
      modes[j] = 0;
    } else {
      modes[j] = condition.kind == Condition::Kind::upper ? 1 : -1;
      bool active = !part->simplex;
      for (int i = part->first; i < part->first + part->count; ++i) {
        active = active || modes[static_cast<std::size_t>(i)] == 0;
      }
      if (!active) modes[j] = 0;  // the last one of a simplex stays
    }
  }
  return changed;
}

bool FixedElement::solve(const Point& left, double h, const ActiveSet& before, const double* held, Element& element) {
  const bool first_is_known = solver_.tableau().family == discretization::TableauFamily::lobatto_iiia;
  for (std::size_t m = 0; m < sets_.size(); ++m) {
    sets_[m] = before;
    modes_[m] = before.modes();
    flips_[m].assign(modes_[m].size(), 0);
  }
  constexpr int most_pivots = 100;
  for (int pivots = 0; pivots < most_pivots; ++pivots) {
    if (solver_.solve(left, h, sets_, held, ElementSolver::Guess::left_end, element) !=
        ElementSolver::Outcome::solved) {
      return false;
    }
    bool changed = false;
    for (std::size_t m = first_is_known ? 1 : 0; m < sets_.size(); ++m) {
      // Late in the search one change at a time: many at once can go round in circles.
      if (changed && pivots > most_pivots / 2) break;
      if (!pivot(m, element, held)) continue;
      changed = true;
      sets_[m] = ActiveSet(parts_, modes_[m]);
    }
    if (changed) continue;
    const std::size_t n = kernel_.selections();
    const auto last = element.stage_selections.end() - static_cast<std::ptrdiff_t>(n);
    end_selections_.assign(last, element.stage_selections.end());
    return true;
  }
  return false;
}

}  // namespace saltus::fesd_integrator
