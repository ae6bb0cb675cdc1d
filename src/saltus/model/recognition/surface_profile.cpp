#include <algorithm>
#include <cmath>
#include <limits>

#include "saltus/base/at.hpp"
#include "saltus/model/graph/sharing_internal.hpp"
#include "saltus/model/recognition/surface_points_internal.hpp"
#include "saltus/model/recognition/surface_profile_internal.hpp"

namespace saltus::model {
namespace {

/// Part of a branch difference nearby that still counts as none on the surface. Ten times larger would hide weak
/// friction beside strong springs, ten times smaller would come near the accuracy of the points.
constexpr double jump_tolerance = 1e-9;
/// Numbers between 0 and 1 stay away from both by this.
constexpr double margin_of_between = 0.25;

}  // namespace

SurfaceProfile::SurfaceProfile(const Tape& tape, const Surface& surface, std::span<const int> targets, bool with_cells,
                               OtherSelections others)
    : tape_(tape), surface_(surface), targets_(targets.begin(), targets.end()), cells_(with_cells), others_(others) {
  std::vector<int> roots = targets_;
  roots.push_back(surface.psi);
  cone_ = tape.cone(roots, Links::through_alpha);
}

void SurfaceProfile::at(Point point, const std::vector<double>& scale) {
  hold_others(point);
  psi_here_ = triples(point, scale, here_, Rounding::bounded);
  for (std::size_t i = 0; i < scale.size(); ++i) {
    if (scale[i] > 0.0) point[i] += 0.1 * scale[i] * seeded_draw(9000, seed_of(tape_, i));
  }
  psi_nearby_ = triples(point, scale, nearby_, Rounding::ignored);
}

std::optional<bool> SurfaceProfile::exceeds(std::size_t target, Difference difference) const {
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
  const double most = cells_ ? bound_[target]
                             : std::min(bound_[target], 1e-5 * (std::isfinite(around) ? std::max(size, around) : size));
  const double rounding = std::isfinite(bound_[target]) ? most : 0.0;
  return found > part * reference + rounding;
}

/// Signs are read once with alpha_j = 1 and then held: where another psi vanishes at the point, too, its rounding must
/// not pass for a jump.
void SurfaceProfile::hold_others(Point& point) {
  const auto own = static_cast<std::size_t>(tape_[surface_.alpha].variable);
  point[own] = 1.0;
  if (others_ == OtherSelections::signs) evaluate(tape_, cone_, point, values_);
  for (const int node : cone_) {
    if (tape_[node].psi < 0 || node == surface_.alpha) continue;
    const auto variable = saltus::at(tape_[node].variable);
    point[variable] = others_ == OtherSelections::between
                          ? 0.5 + margin_of_between * seeded_draw(13000, seed_of(tape_, variable))
                          : (entry(values_.value, node) > 0.5 ? 1.0 : 0.0);
  }
}

/// @return psi_j at the point
double SurfaceProfile::triples(Point& point, const std::vector<double>& scale, std::vector<Triple>& triples,
                               Rounding rounding) {
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

}  // namespace saltus::model
