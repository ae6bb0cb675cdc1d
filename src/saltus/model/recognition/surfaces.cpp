#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <unordered_map>

#include "saltus/base/at.hpp"
#include "saltus/model/graph/sharing_internal.hpp"
#include "saltus/model/recognition/surfaces_internal.hpp"

namespace saltus::model {
namespace {

/// Points that count, and starts at most; a surface that few starts reach is given up as listed.
constexpr int enough_points = 64;
constexpr int seeded_starts = 192;
constexpr std::size_t corner_points = 16;
/// Part of a branch difference nearby that still counts as none on the surface. Ten times larger would hide weak
/// friction beside strong springs, ten times smaller would come near the accuracy of the points.
constexpr double jump_tolerance = 1e-9;

/// Three values of a target: for alpha_j = 0, 1/2 and 1.
using Triple = std::array<double, 3>;

/// Targets at a point on a surface and a step away from it, the other alphas being the signs at the point.
class Profiler {
 public:
  Profiler(const Tape& tape, const Surface& surface, const std::vector<int>& targets)
      : tape_(tape), surface_(surface), targets_(targets) {
    std::vector<int> roots = targets;
    roots.push_back(surface.psi);
    cone_ = tape.cone(roots, Links::through_alpha);
    cells_ = std::any_of(cone_.begin(), cone_.end(), [&](int i) { return tape[i].operation == cell_operation; });
  }

  void at(Point point, const std::vector<double>& scale) {
    hold_others(point);
    psi_here_ = triples(point, scale, here_, Rounding::bounded);
    for (std::size_t i = 0; i < scale.size(); ++i) {
      if (scale[i] > 0.0) point[i] += 0.1 * scale[i] * seeded_draw(9000, seed_of(tape_, i));
    }
    psi_nearby_ = triples(point, scale, nearby_, Rounding::ignored);
  }

  /// Whether a difference of a target's three values is more than what remains of a difference that vanishes on the
  /// surface itself: rounding, and the part of its value nearby that belongs to the |psi| the point is left with (its
  /// square root, as for sqrt(abs(psi))). Differences that are not finite do not count.
  [[nodiscard]] std::optional<bool> exceeds(std::size_t target, double (*difference)(const Triple&)) const {
    const double found = std::abs(difference(here_[target]));
    if (!std::isfinite(found)) return std::nullopt;
    const double nearby = std::abs(difference(nearby_[target]));
    const double size = std::max(std::abs(here_[target][0]), std::abs(here_[target][2]));
    // A branch that is undefined on the other side (sqrt) has no value nearby; its size has to do.
    const double reference = std::isfinite(nearby) ? nearby : size;
    const double distance = std::sqrt(std::abs(psi_here_ / psi_nearby_));
    const double part = std::isfinite(distance) ? std::max(jump_tolerance, 10.0 * distance) : jump_tolerance;
    // Where a surface lies on a break of a table, values may vanish on it and be constant away from it: their size says
    // nothing then. Values may also vanish where both branches do: that of their neighbours counts, too.
    const double around = std::max(std::abs(nearby_[target][0]), std::abs(nearby_[target][2]));
    const double most = cells_
                            ? bound_[target]
                            : std::min(bound_[target], 1e-5 * (std::isfinite(around) ? std::max(size, around) : size));
    const double rounding = std::isfinite(bound_[target]) ? most : 0.0;
    return found > part * reference + rounding;
  }

 private:
  enum class Rounding { bounded, ignored };

  /// Read once with alpha_j = 1 and then held: where another psi vanishes at the point, too, its rounding must not pass
  /// for a jump.
  void hold_others(Point& point) {
    const auto own = static_cast<std::size_t>(tape_[surface_.alpha].variable);
    point[own] = 1.0;
    evaluate(tape_, cone_, point, values_);
    for (const int node : cone_) {
      if (tape_[node].psi < 0 || node == surface_.alpha) continue;
      point[saltus::at(tape_[node].variable)] = entry(values_.value, node) > 0.5 ? 1.0 : 0.0;
    }
  }

  /// @return psi_j at the point
  double triples(Point& point, const std::vector<double>& scale, std::vector<Triple>& triples, Rounding rounding) {
    constexpr double unit = 4.0 * std::numeric_limits<double>::epsilon();
    const auto own = static_cast<std::size_t>(tape_[surface_.alpha].variable);
    std::vector<double> position_error;
    if (rounding == Rounding::bounded) {
      for (const double size : scale) position_error.push_back(unit * size);
      bound_.assign(targets_.size(), 0.0);
    }
    triples.assign(targets_.size(), {});
    for (std::size_t k = 0; k < 3; ++k) {
      point[own] = 0.5 * static_cast<double>(k);
      evaluate_with_bounds(tape_, cone_, point, position_error, unit, values_);
      for (std::size_t i = 0; i < targets_.size(); ++i) {
        triples[i][k] = entry(values_.value, targets_[i]);
        if (rounding == Rounding::bounded) bound_[i] = std::max(bound_[i], entry(values_.bound, targets_[i]));
      }
    }
    return entry(values_.value, surface_.psi);
  }

  const Tape& tape_;
  Surface surface_;
  const std::vector<int>& targets_;
  std::vector<int> cone_;
  bool cells_ = false;
  TapeValues values_;
  std::vector<Triple> here_, nearby_;
  std::vector<double> bound_;
  double psi_here_ = 0.0, psi_nearby_ = 0.0;
};

double jump_of(const Triple& values) { return values[2] - values[0]; }
double bend_of(const Triple& values) { return values[1] - 0.5 * (values[0] + values[2]); }

using Difference = double (*)(const Triple&);

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
                Difference difference)
      : tape_(tape),
        surface_(surface),
        discrete_(discrete),
        targets_(targets),
        difference_(difference),
        projection_(tape, surface.psi),
        profiler_(tape, surface, targets) {}

  /// Assumed where no point shows anything.
  [[nodiscard]] bool found() { return seen_at_seeded_points() || !reached_ || seen_at_corners(); }

 private:
  bool seen_at(const Point& point, const std::vector<double>& scale) {
    profiler_.at(point, scale);
    bool seen = false;
    for (std::size_t i = 0; i < targets_.size(); ++i) {
      const auto exceeds = profiler_.exceeds(i, difference_);
      reached_ = reached_ || exceeds.has_value();
      seen = seen || exceeds.value_or(false);
    }
    return seen;
  }

  bool seen_at_seeded_points() {
    std::vector<int> roots = targets_;
    roots.push_back(surface_.psi);
    const auto variables = moving_variables(tape_, roots);
    for (int k = 0; k < seeded_starts && static_cast<int>(points_.size()) < enough_points; ++k) {
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
  Profiler profiler_;
  std::vector<Point> points_;
  bool reached_ = false;
};

/// Whether a difference is found in the part of the tape that the targets and the surface are.
bool is_found(const Tape& whole, const Surface& surface, const Selections& discrete, const std::vector<int>& targets,
              Difference difference) {
  std::vector<int> roots = targets;
  roots.push_back(surface.psi);
  roots.push_back(surface.alpha);
  const Tape tape = whole.part(roots);
  std::vector<int> targets_here;
  for (const int target : targets) targets_here.push_back(tape.place_of(target));
  Selections discrete_here;
  for (const auto& [alpha, side] : discrete) {
    if (const int place = tape.place_of(alpha); place >= 0) discrete_here.emplace(place, side);
  }
  const Surface surface_here{tape.place_of(surface.psi), tape.place_of(surface.alpha)};
  return SurfaceSearch(tape, surface_here, discrete_here, targets_here, difference).found();
}

}  // namespace

std::vector<SurfaceClass> classify(const Tape& tape, const std::vector<Surface>& surfaces, const Selections& discrete,
                                   const std::vector<int>& targets) {
  std::unordered_map<int, std::vector<int>> targets_of_alpha;
  for (const int target : targets) {
    for (const int alpha : alpha_nodes(tape, std::span(&target, 1), Links::written)) {
      targets_of_alpha[alpha].push_back(target);
    }
  }
  std::vector<SurfaceClass> classes;
  for (const Surface& surface : surfaces) {
    const KindSet reached = tape[surface.psi].reached;
    constexpr KindSet states = kind_bit(VariableKind::state) | kind_bit(VariableKind::discrete);
    const bool still = (reached & moving_kinds) == 0 && (reached & jumping_kinds) != 0;
    if ((reached & states) == 0 && !still) {
      classes.push_back({SwitchingRole::time_event, false});
      continue;
    }
    const auto affected = targets_of_alpha.find(surface.alpha);
    const bool jumps =
        affected != targets_of_alpha.end() && is_found(tape, surface, discrete, affected->second, jump_of);
    if ((reached & moving_kinds) == 0) {
      classes.push_back({SwitchingRole::discrete, jumps});
    } else {
      classes.push_back({jumps ? SwitchingRole::listed : SwitchingRole::kink, jumps});
    }
  }
  return classes;
}

bool bends_on_surface(const Tape& tape, const Surface& surface, const Selections& discrete, int target) {
  return is_found(tape, surface, discrete, {target}, bend_of);
}

}  // namespace saltus::model
