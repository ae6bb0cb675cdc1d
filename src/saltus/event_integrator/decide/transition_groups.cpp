// One group of surfaces that influence each other: which ones those are, and the rule that decides them.
#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/components.hpp"
#include "saltus/event_integrator/decide/transition_internal.hpp"
#include "saltus/event_integrator/mode/kept_by_sliding.hpp"
#include "saltus/event_integrator/mode/resolution.hpp"
#include "saltus/switching/selections/selection_root.hpp"

namespace saltus::event_integrator {

using switching::SurfaceDecision;
using switching::Verdict;

namespace {

/// Largest group whose 2^m corners are looked at.
constexpr std::size_t largest_group = 12;

}  // namespace

std::vector<int> nested_away_from_zero(const evaluation::ModelKernel& kernel, const SwitchingPoint& switching_point) {
  std::vector<int> nested;
  for (int j = 0; j < kernel.switching_functions(); ++j) {
    if (!kernel.inner(j).empty() && !contains(switching_point.at_zero, j)) nested.push_back(j);
  }
  return nested;
}

bool depends_on(const evaluation::ModelKernel& kernel, const std::vector<int>& nested, int i, int j) {
  return kernel.depends(i, j) || same_group(kernel, i, j) || std::any_of(nested.begin(), nested.end(), [&](int around) {
           return contains(kernel.inner(around), j) && kernel.depends(i, around);
         });
}

std::vector<std::vector<int>> groups_of(const evaluation::ModelKernel& kernel, const SwitchingPoint& switching_point,
                                        const std::vector<int>& surfaces) {
  const std::vector<int> nested = nested_away_from_zero(kernel, switching_point);
  return components_of(
      surfaces, [&](int a, int b) { return depends_on(kernel, nested, a, b) || depends_on(kernel, nested, b, a); });
}

/// Kinks at zero whose gradients are combinations of those of the other surfaces there: f is one and the same on both
/// sides, so that there is nothing to decide, and where the motion leads follows from the others.
void Decider::find_followers() {
  const auto& at_zero = switching_point_.at_zero;
  ModeState others = before_;
  others.sliding.clear();
  for (const int j : at_zero) {
    (s_.layout.surfaces[at(j)].role == model::SwitchingRole::kink ? followers_ : others.sliding).push_back(j);
  }
  std::erase_if(followers_, [&](int kink) {
    const auto is_around = [&](int j) { return contains(s_.kernel.inner(j), kink); };
    return std::any_of(at_zero.begin(), at_zero.end(), is_around) ||
           !is_kept_by_sliding(s_.kernel, others, kink, switching_point_.t, switching_point_.x);
  });
}

SurfaceDecision Decider::ask_selection(const switching::CornerTable& table, int surface) {
  std::vector<double> alpha = base_.alpha;
  const auto g = [&](double selection) {
    alpha[at(surface)] = selection;
    return fields_.velocities(alpha, {surface}).front();
  };
  const double last = before_.mode[at(surface)] == 0 ? before_.alpha[at(surface)] : 0.0;
  return switching::decide_selection({table.side(0, 0), table.side(0, 1), table.arrival[0]}, g, last);
}

switching::GroupDecision Decider::ask(const std::vector<int>& group, const switching::CornerTable& table) {
  if (s_.affine_in_alpha || group.size() > 1) return switching::decide_group(table);
  SurfaceDecision decision = ask_selection(table, group.front());
  return {decision.verdict, 0, {decision}};
}

/// Sizes of the normal components in the regions around a point.
void Decider::note_scales(const std::vector<int>& group, const switching::CornerTable& table) {
  for (std::size_t k = 0; k < group.size(); ++k) {
    double& scale = scale_[at(group[k])];
    scale = 0.0;
    for (std::size_t corner = 0; corner < table.corners(); ++corner) {
      scale = std::max(scale, std::abs(table.side(static_cast<int>(k), corner).velocity));
    }
  }
}

/// Nothing slides on a kink, and none is left to both sides: f is one and the same there. Velocities that say so, or
/// nothing, are rounding, as at the edge of a thin layer that a solution drifts through; the kink was seen to be
/// passed.
bool Decider::passes_kink(const std::vector<int>& group, const switching::GroupDecision& decision) {
  const int j = group.front();
  const int arrived = before_.mode[at(j)];
  if (group.size() > 1 || arrived == 0 || switching_point_.start) return false;
  if (!s_.layout.surfaces[at(j)].is_kink) return false;
  const auto& surface = decision.surfaces.front();
  if (decision.verdict == Verdict::decided && surface.mode != 0 && surface.other_modes.empty()) return false;
  decisions_.emplace_back(j,
                          SurfaceDecision{Verdict::decided, -arrived, arrived < 0 ? 1.0 : 0.0, {}, "a kink is passed"});
  standing_.push_back(j);
  return true;
}

/// Whether the selections of the surfaces that stay 0 act on nothing, the others being what was decided.
bool Decider::standing_fields_agree(const std::vector<int>& group, const switching::GroupDecision& decision) const {
  ModeState point = base_;
  std::vector<int> standing;
  for (std::size_t k = 0; k < group.size(); ++k) {
    const auto& surface = decision.surfaces[k];
    if (surface.verdict == Verdict::stands) {
      standing.push_back(group[k]);
    } else {
      point.alpha[at(group[k])] = surface.alpha;
    }
  }
  return fields_.fields_agree(point, standing);
}

/// Whether the group holds several regions of one group by `indicator`.
bool Decider::regions_meet(const std::vector<int>& group) const {
  if (group.size() < 2) return false;
  return std::any_of(group.begin(), group.end(), [&](int j) {
    return std::any_of(group.begin(), group.end(), [&](int i) { return i != j && same_group(s_.kernel, i, j); });
  });
}

/// A surface of the group that is left where both its fields are tangent to it, or -1.
int Decider::lost_at_exit(const std::vector<int>& group) const {
  const auto found = std::find_if(group.begin(), group.end(), [&](int j) {
    const bool at_exit = contains(switching_point_.exit_below, j) || contains(switching_point_.exit_above, j);
    // An exit is located where one field is tangent: its selection is at its bound to rounding over the other field,
    // unless that vanishes, too. Ten times less or more makes no difference: it is 1e-9 or of the order of one. Between
    // these it depends on what is left of the other field.
    constexpr double lost = 1e-6;
    const double beyond = at_exit ? std::max(-before_.alpha[at(j)], before_.alpha[at(j)] - 1.0) : 0.0;
    return !(beyond <= lost) || (beyond > selection_rounding && fields_.nearly_two_fold(before_.alpha, j));
  });
  return found == group.end() ? -1 : *found;
}

/// Whether sliding would go on where it ends: one field has turned away from the surface, the other one moves along it.
/// Of several surfaces that is what selections of the others make of it, which know first derivatives only.
bool Decider::slides_past_exit(const std::vector<int>& group, const switching::GroupDecision& decision) const {
  if (decision.verdict != Verdict::decided) return false;
  for (std::size_t k = 0; k < group.size(); ++k) {
    const auto& surface = decision.surfaces[k];
    const bool at_exit =
        contains(switching_point_.exit_below, group[k]) || contains(switching_point_.exit_above, group[k]);
    if (at_exit && surface.verdict == Verdict::decided && surface.mode == 0) return true;
  }
  return false;
}

bool Decider::decide(const std::vector<int>& group) {
  if (regions_meet(group)) return decide_regions(group);
  if (const int j = lost_at_exit(group); j >= 0) {
    return fail(result::Termination::outside_class, two_fold_at(s_.layout.surfaces[at(j)].name, switching_point_.t));
  }
  if (const auto large = decide_large(group)) return *large;
  if (group.size() > largest_group && s_.affine_in_alpha) {
    return fail(
        result::Termination::outside_class,
        fmt::format(
            "{} surfaces that influence each other meet at t = {}; {}; covered are parts of up to {} that "
            "depend on each other, and larger ones in which each surface depends on itself more than the others",
            group.size(), switching_point_.t, undecided_part_, largest_group));
  }
  if (group.size() > largest_group || (!s_.affine_in_alpha && group.size() > 1)) {
    return fail(result::Termination::outside_class,
                fmt::format("{} surfaces that influence each other meet at t = {}: {}; covered are up to {} with every "
                            "selection entering affinely",
                            group.size(), switching_point_.t, names(s_.layout, group), largest_group));
  }
  const auto table = fields_.table(base_, group);
  note_scales(group, table);
  note_meeting(group, table);
  const auto tree = ask_tree(group, table);
  if (tree && tree->undecided.empty()) {
    const bool by_scaling = tree->by_scaling && s_.policy == switching::SelectionPolicy::scaled;
    if (by_scaling) return resolve(group, table);
    if (!tree->spirals_out) return accept(group, *tree);
    if (spiral_out(group, switching::plane_table(table), *tree)) return true;
  }
  const auto decision = ask(group, table);
  if (passes_kink(group, decision)) return true;
  const bool goes_on = group.size() > 1 && slides_past_exit(group, decision);
  if (decision.verdict == Verdict::coupled || goes_on) return decide_coupled(group, table);
  return take_separate(group, decision);
}

/// What was decided about surfaces each of which depends on only itself.
bool Decider::take_separate(const std::vector<int>& group, const switching::GroupDecision& decision) {
  const int culprit = group[at(std::max(decision.culprit, 0))];
  if (decision.verdict == Verdict::two_fold) {
    return fail(result::Termination::outside_class,
                undetermined_at(fields_, s_.layout, base_.alpha, culprit, switching_point_.t));
  }
  // Where a surface stands nothing depends on the selection: any side continues the same solution.
  if (decision.verdict == Verdict::stands && !standing_fields_agree(group, decision)) {
    return fail(result::Termination::outside_class,
                fmt::format("'{}' does not leave 0 at t = {} under either field, which differ there (boundary "
                            "equilibrium or higher-order contact); start beside the surface or perturb a parameter",
                            s_.layout.surfaces[at(culprit)].name, switching_point_.t));
  }
  // The solution can go on there and leave at any later time.
  if (group.size() == 1 && slides_past_exit(group, decision)) {
    return fail(result::Termination::outside_class,
                two_fold_at(s_.layout.surfaces[at(group.front())].name, switching_point_.t));
  }
  for (std::size_t k = 0; k < group.size(); ++k) {
    SurfaceDecision surface = decision.surfaces[k];
    if (surface.verdict == Verdict::stands) {
      const int kept = before_.mode[at(group[k])] != 0 && !switching_point_.start ? before_.mode[at(group[k])] : 1;
      surface = {Verdict::decided, kept, kept > 0 ? 1.0 : 0.0, {}, "psi stays 0 and the fields agree"};
      standing_.push_back(group[k]);
    }
    decisions_.emplace_back(group[k], surface);
  }
  return true;
}

}  // namespace saltus::event_integrator
