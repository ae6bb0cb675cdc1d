// Surfaces that are reached where an element ends, and not crossed; and several that are crossed at once.
#include "saltus/base/contains.hpp"
#include "saltus/discretization/ocp/element_items_internal.hpp"
#include "saltus/discretization/ocp/surface_states_internal.hpp"

namespace saltus::discretization {
namespace {

using Modes = ElementSides::Sides;

/// Of an element that is inserted: it may not make the objective so much worse that the branch is given up.
constexpr double inserted_share = 0.1 * small_share;

class TouchedSides {
 public:
  TouchedSides(const OcpStructure& made, const ElementSides& modes, mpcc::ConstVectorView w)
      : made_(made), modes_(modes), w_(w), states_(made), items_(made, modes, w) {}

  void add_to(std::vector<mpcc::BranchMove>& moves) const {
    for (std::size_t e = 0; e < made_.element.size(); ++e) {
      const Modes before = modes_.modes(e);
      if (e + 1 == made_.element.size()) {
        for (std::size_t s = 0; s < states_.count(); ++s) add_touched(e, s, before, moves);
        continue;
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
      if (differing.size() < 2) continue;
      for (const auto s : differing) insert(e, states_.with(before, s, states_.of(after, s)), moves);
    }
  }

 private:
  void add_touched(std::size_t e, std::size_t surface, const Modes& modes, std::vector<mpcc::BranchMove>& moves) const {
    const int state = states_.of(modes, surface);
    if (state != 0 && states_.is_reached(e, surface, w_)) insert(e, states_.with(modes, surface, -state), moves);
  }

  /// A short element behind e, in its interval or in the next one.
  void insert(std::size_t e, const Modes& modes, std::vector<mpcc::BranchMove>& moves) const {
    const auto k = at(made_.element[e].interval);
    Items items = items_.of_interval(k);
    const auto place = items.begin() + made_.element[e].number + 1;
    const bool is_last = place == items.end();
    items.insert(place, {e, inserted_share, modes});
    items_.add({{k, items}}, moves);
    if (!is_last || k + 1 == made_.interval.size()) return;
    Items next = items_.of_interval(k + 1);
    next.insert(next.begin(), {e, inserted_share, modes});
    items_.add({{k + 1, next}}, moves);
  }

  const OcpStructure& made_;
  const ElementSides& modes_;
  mpcc::ConstVectorView w_;
  SurfaceStates states_;
  ElementItems items_;
};

}  // namespace

void add_touched_sides(const OcpStructure& made, const ElementSides& modes, mpcc::ConstVectorView w,
                       std::vector<mpcc::BranchMove>& moves) {
  TouchedSides(made, modes, w).add_to(moves);
}

}  // namespace saltus::discretization
