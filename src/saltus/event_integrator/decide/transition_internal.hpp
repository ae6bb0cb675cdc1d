// What the sources of the switching at one point share: transition.cpp decides, transition_coupled.cpp where surfaces
// influence each other, transition_check.cpp checks.
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "saltus/event_integrator/decide/projected_fields.hpp"
#include "saltus/event_integrator/decide/transition.hpp"
#include "saltus/event_integrator/field/mode_field.hpp"
#include "saltus/event_integrator/mode/region_ties.hpp"
#include "saltus/event_integrator/mode/regions.hpp"
#include "saltus/event_integrator/mode/small_internal.hpp"
#include "saltus/switching/hidden/group_modes.hpp"
#include "saltus/switching/hidden/hidden_dynamics.hpp"
#include "saltus/switching/plane/intersection.hpp"
#include "saltus/switching/regions/region_decision.hpp"
#include "saltus/switching/regions/tied_regions.hpp"

namespace saltus::event_integrator {

/// Weights, rates and velocities below this fraction of their scale are looked at a little later along the motion. It
/// only has to be well above what an event is located to.
inline constexpr double marginal_part = 1e-7;

/// Returns names like "a, b".
std::string names(const model::Layout& layout, const std::vector<int>& surfaces);

std::string two_fold_at(const std::string& surface, double t);

/// Says why the motion on a surface is not determined.
std::string undetermined_at(const ProjectedFields& fields, const model::Layout& layout,
                            const std::vector<double>& alpha, int surface, double t);

/// Holds all surfaces at zero there where no rule decides, together with their derivatives that no selection enters, if
/// some selections do. `alternatives` are the regions that the solution can leave into.
std::optional<Transition> hold_with_higher_order(const SwitchingContext& s, const ModeState& before,
                                                 const SwitchingPoint& switching_point);

/// Decides where `failed` does not move to where it says. It takes the modes of the surfaces at zero of which an
/// inequality is an equality (fields tangent to several surfaces at once, selections at their bounds). They are checked
/// along their own fields. The first one that it passes, those with fewer surfaces in other modes than `failed` before
/// the others; nullopt if there is none. Not for regions, functions nested around the surfaces, or more surfaces than
/// are enumerated. Cost: milliseconds.
std::optional<Transition> borderline_mode(const SwitchingContext& s, const ModeState& before,
                                          const SwitchingPoint& switching_point, const ModeState& failed);

/// Returns whether x moves from a common zero of these surfaces into the region of `state` along its own field: no
/// derivative of psi decides alone where several vanish together. By Runge-Kutta steps over a hundredth of the time
/// scale.
bool leads_into_its_region(const SwitchingContext& s, const ModeState& state, const SwitchingPoint& switching_point,
                           const std::vector<double>& start, const std::vector<int>& surfaces);

/// Returns a transition to this state, whose selections hold on both sides of its surfaces.
Transition transition_to(ModeState state);

/// Returns the state with all its sliding surfaces, which depend on each other or are held with higher order; nullopt
/// where they cannot be.
std::optional<Transition> hold(const SwitchingContext& s, ModeState state, const SwitchingPoint& switching_point,
                               std::vector<double>& x, std::string& problem);

/// Does the same, or with selections that are determined: what is left of surfaces that depended on each other.
std::optional<Transition> hold_dependent(const SwitchingContext& s, ModeState state,
                                         const SwitchingPoint& switching_point, std::vector<double>& x,
                                         std::string& problem);

/// Returns whether surfaces are listed ones, none of them nested around others or inside them.
bool are_plain_surfaces(const SwitchingContext& s, const std::vector<int>& surfaces);

/// Returns whether the gradients of the surfaces that a state slides on depend on each other.
bool slides_on_dependent(const SwitchingContext& s, const ModeState& state, const SwitchingPoint& switching_point);

/// Checks a mode of surfaces that depend on each other along its own field: those slid on can be held, the others at
/// zero are left to their sides. nullopt where that is not so, and why.
std::optional<Transition> check_dependent(const SwitchingContext& s, ModeState state,
                                          const SwitchingPoint& switching_point, std::string& problem);

/// Returns the surfaces at zero on which f jumps: neither kinks nor functions of outputs.
std::vector<int> acting_surfaces(const SwitchingContext& s, const ModeState& state,
                                 const SwitchingPoint& switching_point);

/// Decides the mode where surfaces are at zero whose gradients depend on each other, and whose selections enter
/// additively: the solution of a complementarity problem, checked along its own field; nullopt where that fails, and
/// why. `unique` is true where the problem is monotone up to scaling, else not decided.
std::optional<Transition> decide_dependent(const SwitchingContext& s, const ModeState& before,
                                           const SwitchingPoint& switching_point, std::string& problem);

/// Does the same where functions meet others inside them that rest: both are at zero, and stay so whatever the
/// selections, or are held there (the origin of terminal sliding modes, and of time-optimal feedback). Derivatives on
/// one side of such a point say nothing about what follows. nullopt elsewhere, and where nothing holds them.
std::optional<Transition> rest_where_nested_meet(const SwitchingContext& s, const ModeState& before,
                                                 const SwitchingPoint& switching_point);

/// Finds the regions that the solution leaves such a point into, where nothing holds them and no rule has found one.
std::optional<Transition> leave_where_nested_meet(const SwitchingContext& s, const ModeState& before,
                                                  const SwitchingPoint& switching_point);

/// Decides the mode behind an event of a state that is held so.
Transition decide_from_higher_order(const SwitchingContext& s, const ModeState& before,
                                    const SwitchingPoint& switching_point);

/// Decides the mode where functions jump away from zero on surfaces inside them that are crossed; nullopt if none does.
std::optional<Transition> cross_with_jump(const SwitchingContext& s, const ModeState& before,
                                          const SwitchingPoint& switching_point);

/// Lets sliding on functions that have a kink on the touched surfaces go on, or end, with their new gradients behind
/// the kinks. nullopt if other surfaces are touched, or if the new motion does not lead away from the kinks.
std::optional<Transition> cross_kinks(const SwitchingContext& s, const ModeState& before,
                                      const SwitchingPoint& switching_point);

/// Says what was decided where three or more regions of a group by `indicator` meet.
struct RegionChoice {
  evaluation::RegionRange group;
  std::vector<std::vector<ActiveRegion>> sets;  ///< the chosen one first
  std::string reason;
  std::vector<GivenMode> surfaces = {};  ///< where they meet on one: its mode with each set
};

/// Holds regions of a group that meet, the reference first.
struct MeetingRegions {
  std::vector<int> candidates;
  /// Of the gradients of psi of the others, where they depend on each other and their explicit rates do so, too.
  std::optional<RegionBasis> basis;
};

/// Returns the functions away from zero that are nested around others: through them surfaces influence each other, too.
std::vector<int> nested_away_from_zero(const evaluation::ModelKernel& kernel, const SwitchingPoint& switching_point);

/// Returns whether the decision about surface i can depend on the selection of surface j, directly or through one of
/// the functions nested around j. Cost: O(nested), usually none.
bool depends_on(const evaluation::ModelKernel& kernel, const std::vector<int>& nested, int i, int j);

/// Returns the connected groups of those surfaces that influence each other, each ascending.
std::vector<std::vector<int>> groups_of(const evaluation::ModelKernel& kernel, const SwitchingPoint& switching_point,
                                        const std::vector<int>& surfaces);

/// Makes one pass over all groups with the selections of `state` for everything else.
class Decider {
 public:
  Decider(const SwitchingContext& switching_context, const ModeState& before, const SwitchingPoint& switching_point)
      : s_(switching_context),
        before_(before),
        switching_point_(switching_point),
        fields_(switching_context.kernel, switching_point) {
    transition_.state = before;
    transition_.zero_order.assign(before.mode.size(), 0);
    scale_.assign(before.mode.size(), 0.0);
    find_followers();
  }

  Transition run();
  Transition run_forced();
  Transition run_crossing(int jumping);

 private:
  void find_followers();
  void follow(int kink, const Motion& motion);
  bool decide(const std::vector<int>& group);
  [[nodiscard]] bool regions_meet(const std::vector<int>& group) const;
  [[nodiscard]] bool slides_past_exit(const std::vector<int>& group, const switching::GroupDecision& decision) const;
  [[nodiscard]] int lost_at_exit(const std::vector<int>& group) const;
  bool take_separate(const std::vector<int>& group, const switching::GroupDecision& decision);
  [[nodiscard]] bool standing_fields_agree(const std::vector<int>& group,
                                           const switching::GroupDecision& decision) const;
  bool passes_kink(const std::vector<int>& group, const switching::GroupDecision& decision);
  [[nodiscard]] bool has_lost_root() const;
  std::optional<bool> decide_large(const std::vector<int>& group);
  bool decide_parts(const std::vector<std::vector<int>>& parts);
  bool decide_parts(const std::vector<int>& group, const switching::CornerTable& table);
  bool passes(int surface) const;
  void cross_beside(int surface);
  bool decide_regions(const std::vector<int>& group);
  bool decide_regions_with(const std::vector<int>& others, const evaluation::RegionRange& range,
                           const std::vector<int>& regions, const std::vector<int>& group);
  bool decide_regions_alone(const MeetingRegions& meeting, const evaluation::RegionRange& range);
  [[nodiscard]] std::size_t preferred_set(const MeetingRegions& meeting,
                                          const std::vector<switching::RegionSet>& sets) const;
  bool decide_regions_on(int surface, const evaluation::RegionRange& range, std::vector<int> candidates);
  void apply_regions();
  void follow_other_regions();
  bool spiral_out(const MeetingRegions& meeting, const evaluation::RegionRange& range);
  bool goes_on(const MeetingRegions& meeting, switching::RegionSet& set);
  void step_ahead(const MeetingRegions& meeting, const switching::RegionSet& set, std::vector<double>& x);
  bool solve_set(const MeetingRegions& meeting, double t, const double* x, const switching::RegionSet& near,
                 switching::RegionSet& set);
  std::vector<switching::RegionSet> sets_that_go_on(const MeetingRegions& meeting);
  MeetingRegions meeting_of(std::vector<int> candidates);
  linalg::Matrix region_gradients(const std::vector<int>& candidates, double t, const double* x);
  switching::RegionTie tie_at(const MeetingRegions& meeting, double t, const double* x);
  bool is_lost(const MeetingRegions& meeting, const switching::RegionSet& set);
  bool stays_tied(const MeetingRegions& meeting, const switching::RegionSet& set);
  bool moves_in_one_way(const MeetingRegions& meeting, const switching::RegionSet& set);
  switching::RegionRates region_rates(const std::vector<int>& candidates, double t, const double* x);
  switching::GroupDecision ask(const std::vector<int>& group, const switching::CornerTable& table);
  bool decide_coupled(const std::vector<int>& group, const switching::CornerTable& table);
  std::optional<switching::PlaneDecision> ask_tree(const std::vector<int>& group,
                                                   const switching::CornerTable& table) const;
  bool accept(const std::vector<int>& group, const switching::PlaneDecision& decision);
  bool accept_start(const std::vector<int>& group, const switching::CornerTable& table);
  bool resolve(const std::vector<int>& group, const switching::CornerTable& table);
  switching::HiddenDecision follow_hidden(const std::vector<int>& group, const switching::CornerTable& table);
  void note_scales(const std::vector<int>& group, const switching::CornerTable& table);
  void note_meeting(const std::vector<int>& group, const switching::CornerTable& table);
  void take(const std::vector<int>& group, const std::vector<int>& mode, const std::vector<double>& alpha);
  void note_other(const std::vector<int>& group, const auto& mode);
  void note_others(const std::vector<int>& group, const switching::HiddenDecision& chosen, const auto& modes);
  [[nodiscard]] bool is_same_motion(const std::vector<int>& group, const auto& mode) const;
  [[nodiscard]] bool is_vanishing(const std::vector<int>& group, const auto& mode) const;
  bool spiral_out(const std::vector<int>& group, const switching::PlaneTable& table, switching::PlaneDecision decision);
  double velocity_ahead(ModeField& field, const std::vector<double>& xdot, int surface);
  switching::SurfaceDecision ask_selection(const switching::CornerTable& table, int surface);
  bool read_nested_anew();
  bool set_corners();
  bool check();
  bool check_field(ModeField& field, std::vector<double>& xdot);
  bool take_selections(const ModeField& field);
  [[nodiscard]] Motion motion_from(int surface, ModeField& field, const std::vector<double>& xdot);
  bool check_side(int surface, ModeField& field, const std::vector<double>& xdot);
  bool fail_where_surfaces_touch(const std::vector<int>& surfaces);
  bool leaves_by_root(int j);
  bool fail_at_tangency(int surface, int mode, const Motion& motion);
  bool keeps_selections() const;
  bool fail(result::Termination termination, std::string message);

  const SwitchingContext& s_;
  const ModeState& before_;
  const SwitchingPoint& switching_point_;
  ProjectedFields fields_;
  ModeState base_;  ///< selections held while a group is decided
  Transition transition_;
  std::vector<std::pair<int, switching::SurfaceDecision>> decisions_;
  std::vector<std::string> group_reasons_;  ///< of coupled groups
  std::vector<RegionChoice> region_choices_;
  std::string undecided_part_;  ///< of a large group: which and why
  std::vector<double> scale_;   ///< by surface: largest normal component where its group was decided
  std::vector<int> followers_;  ///< kinks that are zero where the others are
  std::vector<int> standing_;   ///< surfaces that psi does not leave, without consequence for the field
};

}  // namespace saltus::event_integrator
