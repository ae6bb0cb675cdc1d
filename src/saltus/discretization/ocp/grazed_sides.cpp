// Surfaces that a motion touches and does not cross: what it does behind a crossing cannot be seen from there.
#include <algorithm>
#include <cmath>
#include <optional>

#include "saltus/discretization/ocp/element_items_internal.hpp"
#include "saltus/discretization/ocp/element_trial_internal.hpp"
#include "saltus/discretization/ocp/neighbours_internal.hpp"
#include "saltus/discretization/ocp/surface_states_internal.hpp"

namespace saltus::discretization {
namespace {

/// Of the width of its bounds, by which a control is changed: impacts grow with the square root of it.
constexpr double control_share = 0.05;
/// Width of a control without bounds, relative to its value.
constexpr double unbounded_width = 2.0;
constexpr int halvings = 50;

class GrazedSides {
 public:
  GrazedSides(const OcpStructure& made, const ElementSides& modes, mpcc::ConstVectorView w)
      : made_(made), modes_(modes), w_(w), states_(made), items_(made, modes, w) {}

  /// Where an element begins on a surface that is on the same side before it and behind it.
  [[nodiscard]] std::vector<std::size_t> touched(std::size_t e) const {
    std::vector<std::size_t> list;
    if (items_.stands_still(e - 1) || items_.stands_still(e)) return list;
    const auto before = modes_.modes(e - 1), after = modes_.modes(e);
    const ElementTrial trial(made_, w_);
    const auto lambda = trial.lambda(trial.left_of(e));
    for (std::size_t s = 0; s < states_.count() && before != after; ++s) {
      const int state = states_.of(before, s);
      if (state != 0 && state == states_.of(after, s) && states_.is_on(s, lambda)) list.push_back(s);
    }
    return list;
  }

  /// Points with other controls in the interval before, up to where one of these surfaces is reached earlier.
  void add_crossing(std::size_t e, const std::vector<std::size_t>& surfaces,
                    std::vector<linalg::Vector>& points) const {
    const auto k = at(made_.element[e - 1].interval);
    for (int i = 0; i < made_.kernel.shared.controls; ++i) {
      const int place = made_.interval[k].shared[at(i)];
      const double lower = made_.w_bounds.lower[place], upper = made_.w_bounds.upper[place];
      const double width =
          std::isfinite(upper - lower) ? upper - lower : unbounded_width * std::max(1.0, std::abs(w_[place]));
      for (const double sign : {-1.0, 1.0}) {
        linalg::Vector point = w_;
        point[place] = std::clamp(w_[place] + sign * control_share * width, lower, upper);
        if (point[place] != w_[place] && shorten(e, surfaces, point)) points.push_back(std::move(point));
      }
    }
  }

 private:
  /// Least multiplier behind the elements of the interval before e, all lengths times a factor; these are written.
  [[nodiscard]] std::optional<double> least_behind(std::size_t e, double factor, linalg::Vector& point) const {
    const auto k = at(made_.element[e - 1].interval);
    const linalg::Vector controls = point;
    const ElementTrial trial(made_, controls);
    const auto items = items_.of_interval(k);
    auto left = trial.left_of(at(made_.interval[k].first_element));
    for (auto n = at(made_.interval[k].first_element); n < e; ++n) {
      const auto modes = modes_.modes(n);
      const auto own = trial.solve(left, k, modes, factor * items[at(made_.element[n].number)].length);
      if (!own) return std::nullopt;
      point.segment(made_.element[n].first, own->size()) = *own;
      left = trial.right_of(*own);
    }
    const auto lambda = trial.lambda(left);
    return lambda.empty() ? std::nullopt : std::optional(*std::min_element(lambda.begin(), lambda.end()));
  }

  /// @return whether a surface is crossed where it was touched; then the point ends on it
  [[nodiscard]] bool shorten(std::size_t e, const std::vector<std::size_t>& surfaces, linalg::Vector& point) const {
    const auto whole = least_behind(e, 1.0, point);
    if (!whole || *whole >= -on_surface) return false;
    double low = 0.0, high = 1.0;
    for (int i = 0; i < halvings; ++i) {
      const double middle = 0.5 * (low + high);
      const auto least = least_behind(e, middle, point);
      if (!least) return false;
      (*least < 0.0 ? high : low) = middle;
    }
    if (!least_behind(e, low, point)) return false;
    set_lengths(e, low, point);
    const ElementTrial trial(made_, point);
    const auto lambda = trial.lambda(trial.left_of(e));
    return std::any_of(surfaces.begin(), surfaces.end(), [&](auto s) { return states_.is_on(s, lambda); });
  }

  /// What the elements before e lose those behind it get, if there are any in the interval.
  void set_lengths(std::size_t e, double factor, linalg::Vector& point) const {
    const auto& interval = made_.interval[at(made_.element[e - 1].interval)];
    if (interval.lengths.empty()) return;
    const auto place = made_.element[e - 1].number + 1;
    double before = 0.0;
    for (int n = 0; n < place; ++n) before += w_[interval.lengths[at(n)]];
    const double behind = 1.0 - before;
    for (int n = 0; n < interval.elements; ++n) {
      const bool is_before = n < place;
      point[interval.lengths[at(n)]] *= is_before ? factor : (1.0 - factor * before) / behind;
    }
  }

  const OcpStructure& made_;
  const ElementSides& modes_;
  mpcc::ConstVectorView w_;
  SurfaceStates states_;
  ElementItems items_;
};

}  // namespace

void add_grazed_sides(const SolvedBranch& branch, std::set<int>& crowded, Moves& moves) {
  const auto& [made, modes, w, multipliers] = branch;
  if (made.kernel.clock < 0) return;
  const GrazedSides grazed(made, modes, w);
  for (std::size_t e = 1; e < made.element.size(); ++e) {
    const auto surfaces = grazed.touched(e);
    if (surfaces.empty()) continue;
    std::vector<linalg::Vector> points;
    grazed.add_crossing(e, surfaces, points);
    const auto count = moves.size();
    for (const auto& point : points) add_insertions_at({made, modes, point, nullptr}, e, crowded, moves);
    for (auto i = count; i < moves.size(); ++i) moves[i].is_elsewhere = true;
  }
}

}  // namespace saltus::discretization
