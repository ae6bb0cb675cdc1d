#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <unordered_map>

#include "saltus/base/at.hpp"
#include "saltus/base/preparation.hpp"
#include "saltus/model/graph/sharing_internal.hpp"
#include "saltus/model/recognition/jump_paths_internal.hpp"
#include "saltus/model/recognition/surfaces_internal.hpp"

namespace saltus::model {
namespace {

/// Points that count, and starts at most; a surface that few starts reach is given up as listed.
constexpr int enough_points = 64, few_points = 4;
constexpr int seeded_starts = 192;
constexpr std::size_t corner_points = 16;
/// Nodes that are evaluated in looking where the jump of a selection ends, beside those of its smallest target.
constexpr std::size_t nearby_nodes = 256;

/// Sides of the other surfaces on which a target would show a difference. A term that needs many conditions at once
/// shows none at random points, so the corner is searched, not drawn. The search starts between the corners, where the
/// (multi-affine) difference is the mean of those at the corners. Each alpha in turn goes to the side where more of it
/// is left.
class CornerSearch {
 public:
  CornerSearch(const Tape& tape, const Surface& surface, int target)
      : tape_(tape),
        surface_(surface),
        target_(target),
        cone_(tape.cone(std::span(&target, 1), Links::written)),
        cone_of_signs_(tape.cone(std::span(&target, 1), Links::through_alpha)) {
    for (const int node : cone_) {
      if (tape[node].psi >= 0 && node != surface.alpha) others_.push_back(node);
    }
  }

  [[nodiscard]] bool has_others() const { return !others_.empty(); }

  /// Empty if no difference is found.
  [[nodiscard]] Selections corner(Point point, Difference difference, std::uint64_t number) {
    evaluate(tape_, cone_of_signs_, point, values_);
    Selections sides;
    for (const int other : others_) {
      sides[other] = entry(values_.value, other) > 0.5 ? 1.0 : 0.0;
      at(point, other) = 0.5 + 0.25 * seeded_draw(number, static_cast<std::uint64_t>(tape_[other].number));
    }
    if (!(value(point, difference) > 0.0)) return {};
    for (auto& [other, side] : sides) {
      at(point, other) = 1.0;
      const double above = value(point, difference);
      at(point, other) = 0.0;
      const double below = value(point, difference);
      // Where both are alike it stays: n != 2 holds on either side of 2, and not below and above it at once.
      if (above > below || std::isnan(below)) side = 1.0;
      if (below > above || std::isnan(above)) side = 0.0;
      at(point, other) = side;
    }
    return sides;
  }

 private:
  double& at(Point& point, int alpha) const { return point[saltus::at(tape_[alpha].variable)]; }

  /// |difference|, 0 where it is no more than rounding.
  double value(Point& point, Difference difference) {
    Triple triple{};
    for (std::size_t k = 0; k < 3; ++k) {
      at(point, surface_.alpha) = 0.5 * static_cast<double>(k);
      evaluate(tape_, cone_, point, values_);
      triple[k] = entry(values_.value, target_);
    }
    const double found = std::abs(difference(triple));
    const double rounding = 16.0 * std::numeric_limits<double>::epsilon();
    return found > rounding * std::max(std::abs(triple[0]), std::abs(triple[2])) ? found : 0.0;
  }

  const Tape& tape_;
  Surface surface_;
  int target_;
  std::vector<int> cone_, cone_of_signs_;
  std::vector<int> others_;
  TapeValues values_;
};

/// The search for a difference on one surface: at seeded points first, then at corners they did not reach.
class SurfaceSearch {
 public:
  SurfaceSearch(const Tape& tape, const Surface& surface, const Selections& discrete, const std::vector<int>& targets,
                bool with_cells, Difference difference)
      : tape_(tape),
        surface_(surface),
        discrete_(discrete),
        targets_(targets),
        difference_(difference),
        projection_(tape, surface.psi),
        profile_(tape, surface, targets, with_cells) {}

  /// Assumed where no point shows anything.
  [[nodiscard]] bool found() { return seen_at_seeded_points(enough_points) || !reached_ || seen_at_corners(); }
  [[nodiscard]] bool found_soon() { return seen_at_seeded_points(few_points); }

 private:
  bool seen_at(const Point& point, const std::vector<double>& scale) {
    profile_.at(point, scale);
    bool seen = false;
    for (std::size_t i = 0; i < targets_.size(); ++i) {
      const auto exceeds = profile_.exceeds(i, difference_);
      reached_ = reached_ || exceeds.has_value();
      seen = seen || exceeds.value_or(false);
    }
    return seen;
  }

  bool seen_at_seeded_points(int enough) {
    std::vector<int> roots = targets_;
    roots.push_back(surface_.psi);
    const auto variables = moving_variables(tape_, roots);
    for (int k = 0; k < seeded_starts && static_cast<int>(points_.size()) < enough; ++k) {
      std::vector<double> scale;
      Point point = start_point(tape_, variables, k);
      if (!projection_.onto(0.0, point, scale)) continue;
      if (seen_at(point, scale)) return true;
      points_.push_back(std::move(point));
    }
    return false;
  }

  bool seen_at_corners() {
    for (const int target : targets_) {
      CornerSearch search(tape_, surface_, target);
      if (!search.has_others()) continue;
      std::set<Selections> tried;
      for (std::size_t k = 0; k < points_.size() && k < corner_points; ++k) {
        const auto sides = search.corner(points_[k], difference_, 11000 + k);
        if (sides.empty()) continue;
        // Sides that exclude each other (x > 5 on x = 0) cannot be reached; a few starts decide that.
        if (!tried.insert(sides).second && k > 4) continue;
        std::vector<double> scale;
        Point point = points_[k];
        if (move_to_sides(tape_, projection_, sides, discrete_, point, scale) && seen_at(point, scale)) return true;
      }
    }
    return false;
  }

  const Tape& tape_;
  Surface surface_;
  const Selections& discrete_;
  const std::vector<int>& targets_;
  Difference difference_;
  Projection projection_;
  SurfaceProfile profile_;
  std::vector<Point> points_;
  bool reached_ = false;
};

bool has_cells(const Tape& tape, std::span<const int> cone) {
  return std::any_of(cone.begin(), cone.end(), [&](int node) { return tape[node].operation == cell_operation; });
}

/// A surface and targets in the part of the tape that they are.
class PartSearch {
 public:
  /// @param with_cells  these targets, or others of the surface, have tables or whole parts
  PartSearch(const Tape& whole, const Surface& surface, const Selections& discrete, std::span<const int> targets,
             bool with_cells, Difference difference)
      : tape_(part(whole, surface, targets)), surface_{tape_.place_of(surface.psi), tape_.place_of(surface.alpha)} {
    for (const int target : targets) targets_.push_back(tape_.place_of(target));
    for (int place = 0; place < tape_.size(); ++place) {
      if (tape_[place].psi < 0) continue;
      if (const auto known = discrete.find(tape_[place].number); known != discrete.end()) {
        discrete_.emplace(place, known->second);
      }
    }
    search_.emplace(tape_, surface_, discrete_, targets_, with_cells, difference);
  }
  PartSearch(const PartSearch&) = delete;
  PartSearch& operator=(const PartSearch&) = delete;

  /// Whether a difference is found.
  [[nodiscard]] bool found() { return search_->found(); }
  /// Likewise, at a few points.
  [[nodiscard]] bool found_soon() { return search_->found_soon(); }

 private:
  static Tape part(const Tape& whole, const Surface& surface, std::span<const int> targets) {
    std::vector<int> roots(targets.begin(), targets.end());
    roots.insert(roots.end(), {surface.psi, surface.alpha});
    return whole.part(roots);
  }

  Tape tape_;
  Surface surface_;
  std::vector<int> targets_;
  Selections discrete_;
  std::optional<SurfaceSearch> search_;
};

/// Surfaces of a tape, and what could jump on them.
class Classification {
 public:
  Classification(const Tape& tape, const Selections& discrete, const std::vector<int>& targets)
      : tape_(tape), discrete_(discrete), users_(tape, targets) {
    for (const int target : targets) note(target);
  }

  [[nodiscard]] SurfaceClass of(const Surface& surface) const {
    const KindSet reached = tape_[surface.psi].reached;
    constexpr KindSet states = kind_bit(VariableKind::state) | kind_bit(VariableKind::discrete);
    const bool still = (reached & moving_kinds) == 0 && (reached & jumping_kinds) != 0;
    if ((reached & states) == 0 && !still) return {SwitchingRole::time_event, false};
    const auto affected = affected_.find(surface.alpha);
    const bool jump = affected != affected_.end() && jumps(surface, affected->second);
    if ((reached & moving_kinds) == 0) return {SwitchingRole::discrete, jump};
    return {jump ? SwitchingRole::listed : SwitchingRole::kink, jump};
  }

 private:
  /// Holds what a selection is in.
  struct Affected {
    std::vector<int> targets;
    std::size_t least_nodes = 0;  ///< of the smallest target, which is the first
    bool with_cells = false;
  };

  void note(int target) {
    if ((tape_[target].written & kind_bit(VariableKind::alpha)) == 0) return;
    const auto cone = tape_.cone(std::span(&target, 1), Links::through_alpha);
    const bool with_cells = has_cells(tape_, cone);
    for (const int alpha : alpha_nodes(tape_, std::span(&target, 1), Links::written)) {
      Affected& affected = affected_[alpha];
      affected.targets.push_back(target);
      affected.with_cells = affected.with_cells || with_cells;
      if (affected.least_nodes != 0 && affected.least_nodes <= cone.size()) continue;
      affected.least_nodes = cone.size();
      std::swap(affected.targets.front(), affected.targets.back());
    }
  }

  /// Asks what costs least first: the smallest target, then the operations near the selection, then ever more targets
  /// at few points. What none of them shows is searched for in all targets together.
  [[nodiscard]] bool jumps(const Surface& surface, const Affected& affected) const {
    const std::span<const int> all(affected.targets);
    const bool with_cells =
        affected.with_cells || has_cells(tape_, tape_.cone(std::span(&surface.psi, 1), Links::through_alpha));
    const auto part = [&](std::span<const int> targets) {
      return PartSearch(tape_, surface, discrete_, targets, with_cells, jump_of);
    };
    if (part(all.first(1)).found_soon()) return true;
    if (ends_nearby(tape_, surface, users_, nearby_nodes + affected.least_nodes)) return false;
    std::size_t count = 1;
    for (std::size_t first = 1; first < all.size(); first += count) {
      count = std::min(2 * count, all.size() - first);
      if (part(all.subspan(first, count)).found_soon()) return true;
    }
    return part(all).found();
  }

  const Tape& tape_;
  const Selections& discrete_;
  Users users_;
  std::unordered_map<int, Affected> affected_;  ///< by selection
};

}  // namespace

std::vector<SurfaceClass> classify(const Tape& tape, const std::vector<Surface>& surfaces, const Selections& discrete,
                                   const std::vector<int>& targets) {
  const Classification classification(tape, discrete, targets);
  std::vector<SurfaceClass> classes;
  for (const Surface& surface : surfaces) {
    prepares("finding what jumps", classes.size(), surfaces.size());
    classes.push_back(classification.of(surface));
  }
  return classes;
}

bool bends_on_surface(const Tape& tape, const Surface& surface, const Selections& discrete, int target) {
  const int roots[] = {target, surface.psi};
  const bool with_cells = has_cells(tape, tape.cone(roots, Links::through_alpha));
  return PartSearch(tape, surface, discrete, std::span(&target, 1), with_cells, bend_of).found();
}

}  // namespace saltus::model
