// The next active set at a point: by enumeration of the patterns that are possible there.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "saltus/base/components.hpp"
#include "saltus/discretization/stage_kernel.hpp"
#include "saltus/fesd_integrator/decide/rests.hpp"
#include "saltus/fesd_integrator/element/active_set.hpp"
#include "saltus/fesd_integrator/element/element.hpp"
#include "saltus/fesd_integrator/element/projected_field.hpp"
#include "saltus/fesd_integrator/element/selection_margins.hpp"
#include "saltus/fesd_integrator/watch/watch.hpp"
#include "saltus/linalg/matrix.hpp"

namespace saltus::fesd_integrator {

/// Holds a set that continues the solution, with the selections of its projected field.
struct Continuation {
  ActiveSet set;
  std::vector<double> selections;
  bool determined = true;  ///< ElementSolver::determined of an element that begins here
  bool decided = true;     ///< whether there are no others that were not looked for
};

/// Holds what is known of a point where a set ended.
struct Decision {
  double t = 0.0;
  std::span<const double> x;
  const double* held = nullptr;
  const ActiveSet* before = nullptr;  ///< nullptr at a start
  std::span<const int> at_zero{};     ///< selections whose indicator is zero there whatever its rounding
  double size = 0.0;                  ///< of the states around, as in Point
  double trial_length = 0.0;          ///< of an element, where first derivatives do not decide
  /// The selection one of whose conditions ended the set; -1 where anything may be otherwise than before.
  int ended = -1;
};

/// Finds all sets that continue a solution from a point. Of the functions that are zero there, every pattern of signs
/// and sliding (every set of active regions) is asked: with the selections of its projected field, do its signs hold
/// just behind the point? A rate beyond its rounding answers; where one is zero (a tangency, the end of sliding) a
/// short element does, or a longer one where psi is within its rounding behind that. The solution may not get to a
/// side, as psi stays at zero. That is no other continuation than sliding with the selections of that side; where psi
/// does not move there, it is the one that is left out. Functions that do not influence each other are enumerated one
/// by one. Of regions that are sign patterns those between the same sides of their surfaces are asked together, with
/// weights that are not negative: as few as determine them, or those of least norm. Surfaces whose gradients depend on
/// each other, with selections that enter additively, are not enumerated: a complementarity problem says which are slid
/// on and which are left [ADR 20]; where it leaves that open, the one just behind the point does. In a system of some
/// size (discretization::StagePattern) only functions that influence the one whose sign ended are asked, and those
/// whose conditions do not clearly hold; the others slide on. Where nothing continues so, all are asked. Of many
/// functions those slide on at first that slid before and whose selections are not at their bounds. Whether others
/// continue the solution, too, is not decided then.
///
/// The order of the answers: fewest functions that came to zero together and do not cross it, or stood there and
/// change, then fewest changes from the set before; then, one function after the other, sliding, above, below (at a
/// start above, below, sliding; regions: fewest active ones, then their numbers).
class Transition {
 public:
  Transition(const discretization::StageKernel& kernel, std::span<const Part> parts, ElementSolver& solver);

  /// Returns them; empty if nothing continues. Cost: 3^m evaluations for m functions that influence each other, at most
  /// `most_patterns`.
  [[nodiscard]] std::vector<Continuation> continuations(const Decision& decision);
  /// Returns, of the last decision, the modes where everything that is zero there slides, or is active.
  [[nodiscard]] const std::vector<int>& modes_at_zero() const { return modes_at_zero_; }
  /// Returns whether the indicators of regions were finite there; nothing continues where they are not.
  [[nodiscard]] bool finite() const { return finite_; }

 private:
  /// Rates and selections within this of their bounds are not decided by first derivatives. Events are located to about
  /// 1e-12; a selection that ends there is off by that, times the conditioning of its equation.
  static constexpr double undecided = 1e-7;
  struct Group {
    std::vector<int> members;                ///< functions of the step form, or regions of a simplex
    std::vector<std::vector<int>> patterns;  ///< modes of the members
    bool dependent = false;                  ///< these are by the complementarity problem, the likeliest one first
    bool decided = true;                     ///< which has one motion as its solution
  };
  enum class Rule { dependent, enumeration, everything };
  [[nodiscard]] std::vector<Continuation> continuations(const Decision& decision, Rule rule);
  [[nodiscard]] bool find_dependent(const Decision& decision, const std::vector<int>& modes, Group& group);
  /// The members of a group whose selections move the state, and those that follow them.
  struct Dependent {
    std::vector<int> acting, followers;
    std::vector<double> selections;  ///< of all; work space
  };
  [[nodiscard]] Dependent split_by_action(const Decision& decision, const std::vector<int>& modes, const Group& group);
  [[nodiscard]] static int side_before(const Decision& decision, int j);
  [[nodiscard]] std::optional<std::vector<double>> solve_dependent(const Decision& decision, double t,
                                                                   const std::vector<double>& x, Dependent& split,
                                                                   Group& group);
  [[nodiscard]] ActiveSet make_set(const Decision& decision, std::vector<int> modes);
  [[nodiscard]] std::optional<std::vector<int>> find_zeros(const Decision& decision, std::vector<int>& modes);
  void join_by_influence(const std::vector<int>& members, Components& components) const;
  [[nodiscard]] std::vector<std::vector<int>> find_influences(const Decision& decision, const std::vector<int>& modes,
                                                              const std::vector<int>& members);
  [[nodiscard]] bool slides_on(const Decision& decision, const std::vector<int>& group,
                               const std::vector<double>& selections) const;
  void keep_sliding(const Decision& decision, std::vector<std::vector<int>>& groups, std::vector<int>& modes);
  [[nodiscard]] bool find_groups(const Decision& decision, Rule rule, std::vector<int>& modes);
  enum class Asked { all, changed };
  /// What is enumerated: a mode of a member, or the side of a surface between regions, the first of which it names.
  struct Choice {
    enum class Kind { function, region, surface } kind = Kind::function;
    std::size_t member = 0;
    int surface = 0;
    int function = -1;     ///< as Rests counts them; -1: a region
    bool is_asked = true;  ///< if it slid before and did not end, it may be taken to slide on
  };
  [[nodiscard]] std::vector<Choice> choices_of(const Decision& decision, const Group& group) const;
  [[nodiscard]] static std::vector<int> modes_before(const Decision& decision, const Part& part);
  void leave_side(const Group& group, const Choice& choice, int mode, std::vector<int>& pattern) const;
  /// A pattern, with the modes of the functions of the choices that are made.
  struct Combination {
    std::vector<int> pattern, modes;
  };
  [[nodiscard]] bool leave_idle_sides(const Group& group, const std::vector<Choice>& choices,
                                      Combination& combination) const;
  void find_approaches(const Decision& decision, const std::vector<int>& members);
  using Rank = std::array<int, 3>;
  [[nodiscard]] Rank rank(const Decision& decision, const Group& group, const std::vector<int>& pattern) const;
  [[nodiscard]] std::vector<std::vector<int>> combinations(const Group& group, const Decision& decision, Asked asked,
                                                           Rule rule) const;
  void find_patterns(const Decision& decision, Group& group, Rule rule) const;
  [[nodiscard]] double margin(const Decision& decision, const Group& group, Continuation& candidate);
  [[nodiscard]] double margin_from(const std::vector<double>& unknown, const Decision& decision, const Group& group,
                                   Continuation& candidate);
  /// What a short element says of a set: its signs hold behind it, or not, or are within their roundings.
  enum class Trial { holds, fails, stays, unsolved };
  /// A pattern that may continue the solution.
  struct Option {
    std::vector<int> pattern;
    double margin = 0.0;
    Trial trial = Trial::holds;
    std::vector<int> still = {};  ///< members whose psi is at zero, and has not moved at all, behind the trial
    std::vector<double> selections = {}, motion = {};  ///< if rates do not decide; of all states
    bool regular = true;                               ///< whether first derivatives determine the selections
  };
  /// Equations of weights; `negligible` is what they may be missed by.
  struct WeightEquations {
    linalg::Matrix matrix;
    linalg::Vector right, negligible;
  };
  /// Weights of regions, and the motion they make.
  struct Weights {
    std::vector<double> selections, motion;
  };
  /// Regions that are active, whether first derivatives determine their weights, and if not a motion they have; none
  /// where these are asked for other weights.
  struct Support {
    std::vector<int> pattern;
    bool determined = true;
    std::vector<double> motion = {};
  };
  [[nodiscard]] WeightEquations weight_equations(const Decision& decision, double t, const std::vector<double>& x,
                                                 const ActiveSet& set, const std::vector<int>& active);
  [[nodiscard]] std::optional<Weights> find_weights(const Decision& decision, double t, const std::vector<double>& x,
                                                    const ActiveSet& set);
  [[nodiscard]] std::optional<std::vector<int>> fewer_regions(const Decision& decision, const Group& group,
                                                              const std::vector<int>& pattern, const Weights& weights,
                                                              const ActiveSet& face);
  [[nodiscard]] std::vector<int> without_negative(const Decision& decision, const Group& group,
                                                  const std::vector<int>& pattern, std::vector<int> modes);
  [[nodiscard]] static bool is_left_out(const Support& support,
                                        const std::vector<std::pair<std::size_t, Option>>& found);
  [[nodiscard]] std::vector<Support> supports_of(const Decision& decision, const Group& group,
                                                 const std::vector<int>& pattern, const std::vector<int>& modes);
  [[nodiscard]] std::optional<Option> option_of(const Decision& decision, const Group& group,
                                                const std::vector<int>& pattern, const std::vector<int>& modes);
  static void put(const Group& group, const std::vector<int>& pattern, std::vector<int>& modes);
  [[nodiscard]] std::vector<Option> options_of(const Decision& decision, const Group& group, Rule rule,
                                               const std::vector<int>& modes, std::vector<int>& guess);
  [[nodiscard]] std::vector<std::vector<int>> admissible_of(const Decision& decision, const Group& group,
                                                            std::vector<Option> options, const std::vector<int>& guess);
  [[nodiscard]] std::optional<Continuation> continuation_in(const Decision& decision, const std::vector<int>& modes);
  [[nodiscard]] static bool slides_beside(const Option& sliding, const Option& beside);
  [[nodiscard]] static bool stands_still(const Option& beside, const Option& sliding, const Group& group);
  [[nodiscard]] static bool stands_for(const Option& option, const Option& other, const Group& group);
  [[nodiscard]] static bool stays_beside(const Option& option, const Option& other, const Group& group);
  [[nodiscard]] ElementSolver::Outcome solve_trial(const Decision& decision, const Continuation& candidate,
                                                   double length);
  [[nodiscard]] bool follows_from_trial(const Continuation& candidate) const;
  [[nodiscard]] bool take_from_trial(const Decision& decision, Continuation& candidate);
  [[nodiscard]] Trial try_element(const Decision& decision, const Group& group, const Continuation& candidate,
                                  double length, std::vector<int>& still);
  void try_elements(const Decision& decision, const Group& group, const Continuation& candidate, Option& option);

  const discretization::StageKernel& kernel_;
  std::span<const Part> parts_;
  ElementSolver& solver_;
  ProjectedField projected_;
  Watch watch_;
  Element trial_;
  std::vector<Group> groups_;
  std::vector<int> part_of_;
  std::vector<int> modes_at_zero_;
  /// Comes to zero alone, or not beside others; with others; stands at zero; slides, with a selection at its bound.
  enum class Approach { alone, together, stands, at_bound };
  std::vector<Approach> approaches_;
  std::vector<int> kept_;  ///< functions that slide on unasked
  Rests rests_;
  bool depends_ = false;  ///< whether a group of the current decision is dependent
  bool skipped_ = false;  ///< whether patterns were not asked, as fewer of their regions move in the same way
  SelectionMargins margins_;
  bool finite_ = true;
  std::vector<double> rate_, size_, noise_;
  discretization::StageValues values_;
};

}  // namespace saltus::fesd_integrator
