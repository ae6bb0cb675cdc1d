// Elements of length zero: modes in which the motion can go on from where an element ends, and does not; several
// surfaces crossed at once, and what happens at control nodes.
#include <algorithm>
#include <iterator>
#include <utility>

#include "saltus/discretization/ocp/insertion_prices_internal.hpp"
#include "saltus/discretization/ocp/surface_states_internal.hpp"

namespace saltus::discretization {
namespace {

using Modes = ElementSides::Sides;

/// Elements that are inserted together: impacts, and what goes on behind them.
constexpr std::size_t largest_chain = 3;
/// Of prices: the same motion in other modes has 0.
constexpr double rounding = 1e-9;

class Insertions {
 public:
  Insertions(const SolvedBranch& branch, std::set<int>& crowded, Moves& moves)
      : branch_(branch),
        made_(branch.made),
        crowded_(crowded),
        moves_(moves),
        prices_(branch),
        states_(made_),
        trial_(made_, branch.w) {}

  void add() {
    for (std::size_t e = 0; e <= made_.element.size(); ++e) add_at(e);
    for (std::size_t k = 1; k < made_.interval.size(); ++k) shift_over_node(k);
  }

 private:
  /// Where elements are inserted.
  struct Boundary {
    std::size_t element = 0;   ///< the one that follows, or one behind the last
    std::size_t interval = 0;  ///< that of the one before it, or its own
    Modes before, after;       ///< empty at the ends of the horizon
  };

  void add_at(std::size_t e) {
    const bool is_first = e == 0, is_last = e == made_.element.size();
    Boundary boundary{.element = e,
                      .interval = 0,
                      .before = is_first ? Modes{} : branch_.modes.modes(e - 1),
                      .after = is_last ? Modes{} : branch_.modes.modes(e)};
    const auto left = trial_.left_of(e);
    if (!is_open(boundary, trial_.lambda(left))) return;
    const auto add_in = [&](std::size_t element) {
      boundary.interval = at(made_.element[element].interval);
      extend(boundary, left, is_first ? boundary.after : boundary.before, {});
    };
    if (!is_first) add_in(e - 1);
    if (!is_last && made_.element[e].number == 0) add_in(e);
  }

  /// Whether a surface is reached that is not slid on all the time, or slid on with a selection at its bound.
  [[nodiscard]] bool is_open(const Boundary& boundary, const std::vector<double>& lambda) const {
    for (const Modes* modes : {&boundary.before, &boundary.after}) {
      if (!modes->empty() && states_.is_touched(lambda, *modes)) return true;
    }
    return (!boundary.before.empty() && trial_.is_at_edge(boundary.element - 1)) ||
           (!boundary.after.empty() && trial_.is_at_edge(boundary.element));
  }

  /// Everything that can follow these elements, which have been inserted.
  void extend(const Boundary& boundary, const std::vector<double>& left, const Modes& from, const Stretches& chain) {
    if (chain.size() == largest_chain) return;
    std::vector<std::vector<double>> impacts;
    for (const auto& modes : states_.candidates(trial_.lambda(left), from)) {
      if (chain.empty() ? is_there(boundary, modes) : modes == from) continue;
      Trial trial = tried(boundary, left, modes);
      const bool is_beside =
          chain.empty() && (modes == boundary.before || modes == boundary.after || is_one_crossing(boundary, modes));
      if (!trial.own || !(is_beside || trial_.is_admissible(*trial.own))) continue;
      auto& [own, length, stands] = trial;
      const auto right = trial_.right_of(*own);
      // Several modes may say the same of an impact.
      if (stands && std::any_of(impacts.begin(), impacts.end(), [&](auto& other) { return are_near(right, other); })) {
        continue;
      }
      Stretches longer = chain;
      longer.push_back({.modes = modes, .length = length, .stands = stands, .origin = origin_of(boundary)});
      if (stands) {
        impacts.push_back(right);
        extend(boundary, right, modes, longer);
      } else {
        const auto price = prices_.price({boundary.element, boundary.interval, left, modes, *own, length});
        if (price && *price >= -rounding) continue;
        const bool has_room = insert(boundary, longer, price);
        if (!has_room && trial_.is_admissible(*own)) crowded_.insert(static_cast<int>(boundary.interval));
      }
    }
  }

  struct Trial {
    std::optional<linalg::Vector> own;
    double length = inserted_share;
    bool stands = false;
  };

  /// A short element, or a whole impact.
  [[nodiscard]] Trial tried(const Boundary& boundary, const std::vector<double>& left, const Modes& modes) const {
    Trial trial, whole;
    trial.own = trial_.solve(left, boundary.interval, modes, trial.length);
    if (!trial.own || !trial_.stands_still(left, *trial.own)) return trial;
    whole.own = trial_.solve_to_end(left, boundary.interval, modes, whole.length);
    whole.stands = true;
    return whole.own ? whole : trial;
  }

  /// Whether a neighbour in the interval has these modes.
  [[nodiscard]] bool is_there(const Boundary& boundary, const Modes& modes) const {
    const auto has = [&](std::size_t e, const Modes& own) {
      return at(made_.element[e].interval) == boundary.interval && own == modes;
    };
    return (!boundary.before.empty() && has(boundary.element - 1, boundary.before)) ||
           (!boundary.after.empty() && has(boundary.element, boundary.after));
  }

  /// Of surfaces that are touched, or crossed at once, one is crossed: the motion may do so only with other controls.
  [[nodiscard]] bool is_one_crossing(const Boundary& boundary, const Modes& modes) const {
    const Modes& before = boundary.before.empty() ? boundary.after : boundary.before;
    const Modes& after = boundary.after.empty() ? boundary.before : boundary.after;
    const auto crosses_one = [&](const Modes& from) {
      int changed = 0;
      for (std::size_t s = 0; s < states_.count(); ++s) {
        const int state = states_.of(modes, s), was = states_.of(before, s), will_be = states_.of(after, s);
        if (state == states_.of(from, s)) continue;
        changed += was == will_be ? (state == -was ? 1 : 2) : (state == will_be ? 1 : 2);
      }
      return changed == 1;
    };
    return crosses_one(before) || crosses_one(after);
  }

  [[nodiscard]] static std::size_t origin_of(const Boundary& boundary) {
    return boundary.element > 0 ? boundary.element - 1 : 0;
  }

  bool insert(const Boundary& boundary, const Stretches& chain, const std::optional<double>& price) {
    const std::size_t k = boundary.interval;
    const auto first = at(made_.interval[k].first_element), end = first + at(made_.interval[k].elements);
    const Stretches stretches =
        joined({branch_.stretches(first, boundary.element), chain, branch_.stretches(boundary.element, end)});
    return add_move(branch_, {{k, stretches}}, "insertion", price, moves_);
  }

  [[nodiscard]] static Stretches joined(const std::vector<Stretches>& parts) {
    Stretches all;
    for (const auto& part : parts) all.insert(all.end(), part.begin(), part.end());
    return all;
  }

  /// What happens in no time at node k comes into the interval before it, with a part of what is behind. Or it comes
  /// into the interval behind it, with a part of what is before. Prices say nothing of elements of length zero.
  void shift_over_node(std::size_t k) {
    Stretches before = branch_.stretches(k - 1), after = branch_.stretches(k);
    const auto is_instant = [](const Stretch& stretch) { return stretch.stands || stretch.has_vanished(); };
    const auto begin = std::find_if_not(before.rbegin(), before.rend(), is_instant).base();
    const auto end = std::find_if_not(after.begin(), after.end(), is_instant);
    if (begin == before.begin() || end == after.end()) return;
    Stretches instants = joined({{begin, before.end()}, {after.begin(), end}});
    if (instants.empty()) return;
    before.erase(begin, before.end());
    after.erase(after.begin(), end);
    std::erase_if(instants, [](const Stretch& stretch) { return stretch.has_vanished(); });
    if (instants.empty() && before.back().modes == after.front().modes) {
      add_move(branch_, {{k - 1, before}, {k, after}}, "shift", std::nullopt, moves_);
      return;
    }
    const auto part = [](Stretch stretch) {
      stretch.length = small_share;
      return Stretches{std::move(stretch)};
    };
    add_move(branch_, {{k - 1, joined({before, instants, part(after.front())})}, {k, after}}, "shift", std::nullopt,
             moves_);
    add_move(branch_, {{k - 1, before}, {k, joined({part(before.back()), instants, after})}}, "shift", std::nullopt,
             moves_);
  }

  const SolvedBranch& branch_;
  const OcpStructure& made_;
  std::set<int>& crowded_;
  Moves& moves_;
  InsertionPrices prices_;
  SurfaceStates states_;
  ElementTrial trial_;
};

}  // namespace

void add_insertions(const SolvedBranch& branch, std::set<int>& crowded, Moves& moves) {
  Insertions(branch, crowded, moves).add();
}

}  // namespace saltus::discretization
