// Regions by indicators (of a hysteresis) that are reached where the horizon ends.
#include <algorithm>

#include "saltus/discretization/ocp/element_items_internal.hpp"
#include "saltus/discretization/ocp/neighbours_internal.hpp"
#include "saltus/discretization/ocp/surface_states_internal.hpp"

namespace saltus::discretization {
namespace {

using mpcc::ActiveSide;
using Modes = ElementSides::Sides;

/// Regions of one part: which are active.
using Regions = std::vector<bool>;

class ReachedRegions {
 public:
  ReachedRegions(const OcpStructure& made, const ElementSides& modes, mpcc::ConstVectorView w, int first, int count)
      : made_(made), modes_(modes), w_(w), items_(made, modes, w), first_(first), count_(count) {}

  void add_to(std::vector<mpcc::BranchMove>& moves) const {
    const std::size_t elements = made_.element.size();
    // Behind e everything is held: on lines of all its regions and of those that are reached.
    for (std::size_t e = elements; e-- > 0;) {
      const Regions before = active(e);
      const bool is_last = e + 1 == elements;
      if (!is_last && !includes(active(e + 1), before)) break;
      for (int region = 0; region < count_; ++region) {
        if (before[at(region)] || !is_reached(e, region)) continue;
        if (!is_last && !active(e + 1)[at(region)]) continue;
        for (int next = 0; next < count_; ++next) {
          if (next != region && !before[at(next)]) add(e, region, next, moves);
        }
      }
    }
    add_behind_last(moves);
  }

 private:
  [[nodiscard]] Regions active(std::size_t e) const {
    Regions regions;
    for (int i = 0; i < count_; ++i) regions.push_back(modes_.of(e, at(first_ + i)) == ActiveSide::H);
    return regions;
  }
  [[nodiscard]] static bool includes(const Regions& larger, const Regions& smaller) {
    for (std::size_t i = 0; i < larger.size(); ++i) {
      if (smaller[i] && !larger[i]) return false;
    }
    return true;
  }
  [[nodiscard]] bool is_reached(std::size_t e, int region) const {
    const auto lambda = made_.left_lambda(static_cast<int>(e) + 1);
    return value_at(lambda[at(first_ + region)], w_, made_.constants) <= on_surface;
  }
  [[nodiscard]] Modes with(std::size_t e, int region, int other) const {
    Modes modes = modes_.modes(e);
    for (int i = 0; i < count_; ++i) {
      modes[at(first_ + i)] = i == region || i == other ? ActiveSide::H : ActiveSide::G;
    }
    return modes;
  }

  /// Through the region, then along the line between it and the next one.
  void add(std::size_t e, int region, int next, std::vector<mpcc::BranchMove>& moves) const {
    if (e + 1 == made_.element.size()) {
      append({{e, small_share, with(e, region, region)}, {e, small_share, with(e, region, next)}}, moves);
      return;
    }
    mpcc::BranchMove move{modes_.all(), w_};
    for (std::size_t behind = e + 1; behind < made_.element.size(); ++behind) {
      modes_.write(with(behind, region, behind == e + 1 ? region : next), behind, move.sides);
    }
    moves.push_back(std::move(move));
  }

  /// The last element has come through a region alone.
  void add_behind_last(std::vector<mpcc::BranchMove>& moves) const {
    const std::size_t last = made_.element.size() - 1;
    const Regions regions = active(last);
    if (last == 0 || std::count(regions.begin(), regions.end(), true) != 1) return;
    const auto region = static_cast<int>(std::find(regions.begin(), regions.end(), true) - regions.begin());
    for (int next = 0; next < count_; ++next) {
      if (next != region && !active(last - 1)[at(next)]) append({{last, small_share, with(last, region, next)}}, moves);
    }
  }

  void append(const Items& more, std::vector<mpcc::BranchMove>& moves) const {
    const std::size_t k = made_.interval.size() - 1;
    Items items = items_.of_interval(k);
    items.insert(items.end(), more.begin(), more.end());
    items_.add({{k, items}}, moves);
  }

  const OcpStructure& made_;
  const ElementSides& modes_;
  mpcc::ConstVectorView w_;
  ElementItems items_;
  int first_, count_;
};

}  // namespace

void add_reached_regions(const SolvedBranch& branch, Moves& moves) {
  const auto& [made, modes, w, multipliers] = branch;
  int pair = 0;
  for (const auto& part : made.kernel.parts) {
    const bool is_step = part.form == reformulation::Form::step;
    if (!is_step && part.surfaces.empty()) ReachedRegions(made, modes, w, pair, part.count).add_to(moves);
    pair += is_step ? 2 * part.count : part.count;
  }
}

}  // namespace saltus::discretization
