// Bounds that an optimal motion comes to and does not leave: of a switching function beside its surface, or of a
// selection on it. No equation says whether it is beyond them between two stages.
#include <algorithm>
#include <cmath>
#include <tuple>
#include <vector>

#include "saltus/discretization/ocp/ocp_problem_internal.hpp"
#include "saltus/discretization/ocp/surface_states_internal.hpp"

namespace saltus::discretization {
namespace {

using mpcc::ActiveSide;

/// Of what the neighbours are off, at least; how far beyond the parabola; and what a distance grows by.
constexpr double least_share = 1e-3, beyond_parabola = 2.0, growth = 2.0;

/// What is not zero of a pair, at a point of elements of equal sides.
struct PointOfSide {
  double t = 0.0;
  double value = 0.0;
  int variable = -1;  ///< -1: where the side begins or ends
  std::size_t interval = 0;
};
using Points = std::vector<PointOfSide>;

/// The multiplier where the selection is zero, else the selection, over stretches of elements.
class StretchPoints {
 public:
  StretchPoints(const OcpStructure& made, const std::vector<ActiveSide>& sides, mpcc::ConstVectorView w)
      : made_(made), modes_(made, sides), trial_(made, w), w_(w) {}

  /// One list per stretch; where the motion comes to a bound at its ends, it leaves it.
  [[nodiscard]] std::vector<Points> of(std::size_t pair, ActiveSide side) const {
    std::vector<Points> list;
    double t = 0.0;
    bool was_there = false;
    for (std::size_t e = 0; e < made_.element.size(); ++e) {
      const double length = trial_.length_of(e);
      const bool is_there = modes_.of(e, pair) == side;
      if (is_there && !was_there) list.emplace_back();
      if (is_there) add(e, pair, side, t, length, list.back());
      was_there = is_there;
      t += length;
    }
    std::erase_if(list, [](const Points& points) { return points.empty(); });
    for (auto& points : list) points.back().variable = -1;
    return list;
  }

 private:
  void add(std::size_t e, std::size_t pair, ActiveSide side, double t, double length, Points& points) const {
    if (length <= vanished) return;
    const auto& layout = made_.kernel.layout;
    const auto& [of_pair, element] = std::tie(made_.kernel.pairs[pair], made_.element[e]);
    const int count = side == ActiveSide::G ? layout.lambda.count : layout.stages;
    for (int point = 0; point < count; ++point) {
      const double c = point < layout.stages ? made_.kernel.tableau.c[point] : 1.0;
      const int variable = element.variable(side == ActiveSide::G ? layout.lambda.at(point, static_cast<int>(pair))
                                                                  : layout.selection.at(point, of_pair.selection));
      const bool is_complement = side == ActiveSide::H && of_pair.complement;
      const double value = is_complement ? 1.0 - w_[variable] : w_[variable];
      if (points.empty()) {
        const double at_start = side == ActiveSide::G ? trial_.lambda(trial_.left_of(e))[pair] : value;
        points.push_back({.t = t, .value = at_start});
      }
      points.push_back({t + c * length, value, variable, at(element.interval)});
    }
  }

  const OcpStructure& made_;
  ElementSides modes_;
  ElementTrial trial_;
  mpcc::ConstVectorView w_;
};

/// By how much the parabola through three points is below the middle one.
double depth(const PointOfSide& before, const PointOfSide& here, const PointOfSide& after) {
  const double a = here.t - before.t, b = after.t - here.t;
  const double left = (before.value - here.value) / a, right = (after.value - here.value) / b;
  const double curvature = (left + right) / (a + b), slope = (right * a - left * b) / (a + b);
  return curvature > 0.0 ? std::pow(0.5 * slope, 2) / curvature : 0.0;
}

}  // namespace

double OcpProblem::keep_off_touched(const std::vector<ActiveSide>& sides, mpcc::ConstVectorView w, int missed_in) {
  auto& made = *implementation_->structure;
  double largest = 0.0;
  const auto keep_off = [&](const Points& points, bool is_complement) {
    for (std::size_t i = 1; i + 1 < points.size(); ++i) {
      const auto& [t, value, variable, interval] = points[i];
      if (variable < 0) continue;
      double& bound = (is_complement ? made.w_bounds.upper : made.w_bounds.lower)[variable];
      const double least = is_complement ? 1.0 - bound : bound;
      const bool is_new = least <= 0.0;
      const bool is_missed = interval == at(missed_in) || points[i + 1].interval == at(missed_in);  // its node, too
      if (value > least + on_surface || !(is_new || is_missed)) continue;
      const double around = std::max(points[i - 1].value, points[i + 1].value);
      const double first = beyond_parabola * depth(points[i - 1], points[i], points[i + 1]) + least_share * around;
      const double next = is_new ? std::max(first, on_surface) : growth * least;
      bound = is_complement ? 1.0 - next : next;
      largest = std::max(largest, next);
    }
  };
  const StretchPoints stretches(made, sides, w);
  for (std::size_t pair = 0; pair < made.kernel.pairs.size(); ++pair) {
    for (const auto& points : stretches.of(pair, ActiveSide::G)) keep_off(points, false);
    const bool is_complement = made.kernel.pairs[pair].complement;
    for (const auto& points : stretches.of(pair, ActiveSide::H)) keep_off(points, is_complement);
  }
  return largest;
}

}  // namespace saltus::discretization
