// Elements of length zero: modes in which the motion can go on from where an element ends, and does not; and several
// surfaces crossed at once.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <tuple>
#include <utility>

#include "saltus/base/contains.hpp"
#include "saltus/discretization/ocp/element_items_internal.hpp"
#include "saltus/discretization/ocp/element_trial_internal.hpp"
#include "saltus/discretization/ocp/insertion_prices_internal.hpp"
#include "saltus/discretization/ocp/surface_states_internal.hpp"

namespace saltus::discretization {
namespace {

using Modes = ElementSides::Sides;

/// Of an element that is inserted: it may not make the objective so much worse that the branch is given up.
constexpr double inserted_share = 0.1 * small_share;
/// Elements that are inserted together: impacts, and what goes on behind them.
constexpr std::size_t largest_chain = 3;
/// Surfaces that are combined with all others.
constexpr std::size_t largest_combined = 4;

class Insertions {
 public:
  Insertions(const SolvedBranch& branch, std::set<int>& crowded)
      : made_(branch.made),
        modes_(branch.modes),
        w_(branch.w),
        crowded_(crowded),
        multipliers_(branch.multipliers),
        states_(made_),
        items_(made_, modes_, w_),
        trial_(made_, w_) {
    if (branch.multipliers != nullptr) prices_.emplace(branch);
  }

  void add_to(Moves& moves) const {
    for (std::size_t e = 0; e <= made_.element.size(); ++e) add_continued(e, moves);
    for (std::size_t e = 0; e < made_.element.size(); ++e) add_crossed(e, moves);
  }

  void add_continued(std::size_t e, Moves& moves) const {
    const bool is_first = e == 0, is_last = e == made_.element.size();
    Node node{
        .element = e, .before = is_first ? Modes{} : modes_.modes(e - 1), .after = is_last ? Modes{} : modes_.modes(e)};
    const auto left = trial_.left_of(e);
    if (!is_touched(node, trial_.lambda(left))) return;
    const bool has_beyond = !is_first && !is_last && made_.element[e].number == 0 && node.before != node.after;
    const auto begin_in = [&](std::size_t k) {
      node.interval = k;
      node.place = static_cast<Items::difference_type>(e) - made_.interval[k].first_element;
      if (has_beyond) node.beyond = static_cast<int>(k) == made_.element[e - 1].interval ? node.after : node.before;
      extend(node, left, is_first ? node.after : node.before, {}, moves);
    };
    if (!is_first) begin_in(at(made_.element[e - 1].interval));
    if (!is_last && made_.element[e].number == 0) begin_in(at(made_.element[e].interval));
  }

 private:
  /// Where elements end and begin.
  struct Node {
    std::size_t element = 0;           ///< the one that follows, or one behind the last
    std::size_t interval = 0;          ///< in which elements are inserted
    Items::difference_type place = 0;  ///< of what follows, in the interval
    Modes before, after;               ///< empty at the ends of the horizon
    Modes beyond{};                    ///< of the element on the other side of a control node, if it is another mode
  };

  /// Whether a surface is reached that is not slid on all the time, or slid on with a selection at its bound.
  [[nodiscard]] bool is_touched(const Node& node, const std::vector<double>& lambda) const {
    for (const Modes* modes : {&node.before, &node.after}) {
      for (std::size_t s = 0; s < states_.count() && !modes->empty(); ++s) {
        if (states_.of(*modes, s) != 0 && states_.is_on(s, lambda)) return true;
      }
    }
    return (!node.before.empty() && is_at_edge(node.element - 1)) || (!node.after.empty() && is_at_edge(node.element));
  }

  /// Whether both sides of a pair are zero in the whole element.
  [[nodiscard]] bool is_at_edge(std::size_t e) const {
    const auto& kernel = made_.kernel;
    const auto& [lambda, selection] = std::tie(kernel.layout.lambda, kernel.layout.selection);
    const auto left = trial_.lambda(trial_.left_of(e));
    for (std::size_t k = 0; k < kernel.pairs.size(); ++k) {
      const auto& pair = kernel.pairs[k];
      double largest = left[k];
      for (int point = 0; point < lambda.count; ++point) {
        largest = std::max(largest, w_[made_.element[e].variable(lambda.at(point, static_cast<int>(k)))]);
      }
      for (int m = 0; m < kernel.layout.stages; ++m) {
        const double value = w_[made_.element[e].variable(selection.at(m, pair.selection))];
        largest = std::max(largest, pair.complement ? 1.0 - value : value);
      }
      if (largest <= on_surface) return true;
    }
    return false;
  }

  /// Everything that can follow these elements, which have been inserted.
  void extend(const Node& node, const std::vector<double>& left, const Modes& before, const Items& chain,
              Moves& moves) const {
    if (chain.size() == largest_chain) return;
    std::vector<std::vector<double>> impacts;
    // What follows anyway is another motion behind an impact.
    auto list = candidates(trial_.lambda(left), before, chain.empty() ? node.after : Modes{});
    if (chain.empty() && !node.beyond.empty()) list.push_back(node.beyond);
    for (const auto& modes : list) {
      double length = inserted_share;
      auto own = trial_.solve(left, node.interval, modes, length);
      const bool stands = own && trial_.stands_still(left, *own);
      if (stands) own = trial_.solve_to_end(left, node.interval, modes, length);
      if (!own || (modes != node.beyond && !trial_.is_admissible(*own))) continue;
      const auto right = trial_.right_of(*own);
      // Several modes may say the same of an impact.
      if (stands && std::any_of(impacts.begin(), impacts.end(), [&](auto& other) { return is_same(right, other); })) {
        continue;
      }
      Items longer = chain;
      longer.push_back({node.element > 0 ? node.element - 1 : 0, length, modes, *own});
      if (stands) {
        impacts.push_back(right);
        extend(node, right, modes, longer, moves);
      } else {
        if (chain.empty()) replace(node, modes, moves);
        const auto price = price_of({node.element, node.interval, left, longer.back()});
        if (!is_dear(price)) insert(node, longer, price, moves);
      }
    }
  }

  [[nodiscard]] static bool is_same(const std::vector<double>& a, const std::vector<double>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), [](double x, double y) { return std::abs(x - y) <= on_surface; });
  }

  /// Sides of the surfaces that are reached: all of few, two of many at once.
  [[nodiscard]] std::vector<Modes> candidates(const std::vector<double>& lambda, const Modes& before,
                                              const Modes& after) const {
    std::vector<std::size_t> reached;
    for (std::size_t s = 0; s < states_.count(); ++s) {
      if (states_.is_on(s, lambda)) reached.push_back(s);
    }
    std::vector<std::pair<Modes, std::size_t>> found{{before, 0}};
    const std::size_t largest = reached.size() <= largest_combined ? reached.size() : 2;
    for (const auto s : reached) {
      const std::size_t count = found.size();
      for (const int state : {-1, 0, 1}) {
        if (state == states_.of(before, s)) continue;
        for (std::size_t i = 0; i < count; ++i) {
          const auto [modes, changed] = found[i];
          if (changed < largest) found.emplace_back(states_.with(modes, s, state), changed + 1);
        }
      }
    }
    std::vector<Modes> list;
    for (auto& [modes, changed] : found) {
      if (modes != before && modes != after) list.push_back(std::move(modes));
    }
    return list;
  }

  [[nodiscard]] std::optional<double> price_of(const Insertion& insertion) const {
    return prices_ ? prices_->price(insertion) : std::nullopt;
  }
  [[nodiscard]] static bool is_dear(const std::optional<double>& price) { return price && *price >= 0.0; }

  void insert(const Node& node, const Items& chain, std::optional<double> price, Moves& moves) const {
    Items items = items_.of_interval(node.interval);
    items.insert(items.begin() + node.place, chain.begin(), chain.end());
    const auto count = moves.size();
    const bool have_room = items_.add_solved(node.interval, items, moves);
    if (moves.size() > count) moves.back().price = price;
    if (!have_room && is_another_motion(node, chain.front())) crowded_.insert(static_cast<int>(node.interval));
  }

  /// Whether neither what was before nor what follows, in this interval, says the same.
  [[nodiscard]] bool is_another_motion(const Node& node, const Item& first) const {
    const auto left = trial_.left_of(node.element);
    const auto is_told = [&](std::size_t e) {
      if (at(made_.element[e].interval) != node.interval) return false;
      const auto own = trial_.solve(left, node.interval, modes_.modes(e), first.length);
      return own && is_same(trial_.right_of(*own), trial_.right_of(first.own));
    };
    return !(node.element > 0 && is_told(node.element - 1)) &&
           !(node.element < made_.element.size() && is_told(node.element));
  }

  /// Instead of what follows, where that stays on the surfaces: until then the motion is the same.
  void replace(const Node& node, const Modes& modes, Moves& moves) const {
    Items items = items_.of_interval(node.interval);
    if (node.place == std::ssize(items)) return;
    ElementSides::Sides sides = modes_.all();
    for (auto item = items.begin() + node.place; item != items.end(); ++item) {
      for (std::size_t s = 0; s < states_.count(); ++s) {
        const bool differs = states_.of(item->modes, s) != states_.of(modes, s);
        if (differs && !states_.is_held(item->element, s, w_)) return;
      }
      item->modes = modes;
      modes_.write(modes, item->element, sides);
      const bool is_end = std::next(item) == items.end() || std::next(item)->modes != modes_.modes(item->element);
      if (is_end) break;
    }
    std::optional<double> price;
    if (multipliers_ != nullptr) price = price_of_freed(modes_.all(), sides, *multipliers_);
    if (is_dear(price)) return;
    const auto count = moves.size();
    items_.add_solved(node.interval, items, moves);
    if (moves.size() > count) moves.back().price = price;
  }

  /// Several surfaces that are crossed at once are crossed one by one.
  void add_crossed(std::size_t e, Moves& moves) const {
    const Modes before = modes_.modes(e);
    if (e + 1 == made_.element.size()) {
      for (std::size_t s = 0; s < states_.count(); ++s) add_touched(e, s, before, moves);
      return;
    }
    const Modes after = modes_.modes(e + 1);
    std::vector<std::size_t> differing;
    for (std::size_t s = 0; s < states_.count(); ++s) {
      if (states_.of(before, s) != states_.of(after, s)) differing.push_back(s);
    }
    for (std::size_t s = 0; s < states_.count(); ++s) {
      if (contains(differing, s)) continue;
      add_touched(e, s, before, moves);
      if (!differing.empty()) add_touched(e, s, after, moves);
    }
    if (differing.size() < 2) return;
    for (const auto s : differing) insert_beside(e, states_.with(before, s, states_.of(after, s)), moves);
  }

  void add_touched(std::size_t e, std::size_t surface, const Modes& modes, Moves& moves) const {
    const int state = states_.of(modes, surface);
    if (state == 0 || !states_.is_on(surface, trial_.lambda(trial_.left_of(e + 1)))) return;
    insert_beside(e, states_.with(modes, surface, -state), moves);
  }

  /// A short element behind e, in its interval, in the next one, or in both, unless multipliers say that it is of no
  /// use.
  void insert_beside(std::size_t e, const Modes& modes, Moves& moves) const {
    const auto k = at(made_.element[e].interval);
    Items items = items_.of_interval(k);
    const auto place = items.begin() + made_.element[e].number + 1;
    const bool is_last = place == items.end();
    items.insert(place, {e, inserted_share, modes});
    const auto price = price_beside(e, k, modes);
    const auto add = [&](std::vector<std::pair<std::size_t, Items>> changes, std::optional<double> of_change) {
      const auto count = moves.size();
      if (!is_dear(of_change)) items_.add(std::move(changes), moves);
      if (moves.size() > count) moves.back().price = of_change;
    };
    add({{k, items}}, price);
    if (!is_last || k + 1 == made_.interval.size()) return;
    Items next = items_.of_interval(k + 1);
    next.insert(next.begin(), {e, inserted_share, modes});
    const auto next_price = price_beside(e, k + 1, modes);
    add({{k + 1, next}}, next_price);
    add({{k, items}, {k + 1, next}}, price && next_price ? std::optional(*price + *next_price) : std::nullopt);
  }

  [[nodiscard]] std::optional<double> price_beside(std::size_t e, std::size_t k, const Modes& modes) const {
    const auto left = trial_.left_of(e + 1);
    auto own = trial_.solve(left, k, modes, inserted_share);
    if (!own) return std::numeric_limits<double>::infinity();
    return price_of({e + 1, k, left, {e, inserted_share, modes, std::move(*own)}});
  }

  const OcpStructure& made_;
  const ElementSides& modes_;
  mpcc::ConstVectorView w_;
  std::set<int>& crowded_;
  const mpcc::Multipliers* multipliers_;
  std::optional<InsertionPrices> prices_;
  SurfaceStates states_;
  ElementItems items_;
  ElementTrial trial_;
};

}  // namespace

void add_insertions(const SolvedBranch& branch, std::set<int>& crowded, Moves& moves) {
  Insertions(branch, crowded).add_to(moves);
}

void add_insertions_at(const SolvedBranch& branch, std::size_t element, std::set<int>& crowded, Moves& moves) {
  Insertions(branch, crowded).add_continued(element, moves);
}

}  // namespace saltus::discretization
