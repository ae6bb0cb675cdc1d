#include <algorithm>
#include <array>
#include <cmath>

#include "saltus/base/at.hpp"
#include "saltus/model/graph/sharing_internal.hpp"
#include "saltus/model/recognition/surface_points_internal.hpp"

namespace saltus::model {

std::vector<int> moving_variables(const Tape& tape, std::span<const int> roots) {
  std::vector<int> found;
  for (const int node : tape.cone(roots, Links::through_alpha)) {
    const int variable = tape[node].variable;
    if (variable < 0 || tape[node].psi >= 0) continue;
    const VariableKind kind = tape.variables()[at(variable)].kind;
    if (kind != VariableKind::parameter && kind != VariableKind::cell) found.push_back(variable);
  }
  return found;
}

std::vector<int> alpha_nodes(const Tape& tape, std::span<const int> roots, Links links) {
  std::vector<int> found;
  const auto has_alpha = [&](int root) {
    return root >= 0 && (tape[root].written & kind_bit(VariableKind::alpha)) != 0;
  };
  if (std::none_of(roots.begin(), roots.end(), has_alpha)) return found;
  for (const int node : tape.cone(roots, links)) {
    if (tape[node].psi >= 0) found.push_back(node);
  }
  return found;
}

Point start_point(const Tape& tape, std::span<const int> variables, int k) {
  constexpr std::array<double, 7> magnitudes{1.0, 0.1, 10.0, 1e-2, 100.0, 1e-3, 1e3};
  // A model in small units has its jumps where no size above would show them; a quarter of the points looks there.
  constexpr std::array<double, 4> tiny{1e-8, 1e-14, 1e-20, 1e-30};
  constexpr int first_tiny = 48, end_of_tiny = 64;
  const auto pair = static_cast<std::size_t>(k / 2);
  const bool is_tiny = first_tiny <= k && k < end_of_tiny;
  const double magnitude = is_tiny ? tiny[pair % tiny.size()] : magnitudes[pair % magnitudes.size()];
  Point point = blank_point(tape);
  for (const int index : variables) {
    const auto i = static_cast<std::size_t>(index);
    const Variable& variable = tape.variables()[i];
    const double draw = magnitude * seeded_draw(static_cast<std::uint64_t>(k) + 5000, seed_of(tape, i));
    const double base = variable.kind == VariableKind::time || !std::isfinite(variable.value) ? 0.0 : variable.value;
    point[i] = k % 2 == 0 ? base + draw : draw;
  }
  return point;
}

Projection::Projection(const Tape& tape, int psi)
    : tape_(tape),
      psi_(psi),
      cone_(tape.cone(std::span(&psi, 1), Links::through_alpha)),
      variables_(moving_variables(tape, std::span(&psi, 1))) {}

void Projection::note_sizes(const Point& point, std::vector<double>& scale) const {
  for (const int variable : variables_) {
    double& size = scale[saltus::at(variable)];
    size = std::max(size, std::abs(entry(point, variable)));
  }
}

Projection::Value Projection::at(const Point& point) {
  std::vector<double> scale(point.size(), 0.0);
  note_sizes(point, scale);
  evaluate_with_bounds(tape_, cone_, point, scale, 0.0, values_);
  const double psi = entry(values_.value, psi_);
  return {psi, std::max(std::abs(psi), entry(values_.bound, psi_))};
}

bool Projection::onto(double level, Point& point, std::vector<double>& scale) {
  scale.assign(point.size(), 0.0);
  note_sizes(point, scale);
  const double size = at(point).size;
  if (!std::isfinite(size)) return false;
  // psi = x^2 needs about 40 halvings to reach the tolerance, a transversal surface 3 to 8 steps.
  for (int iteration = 0; iteration < 60; ++iteration) {
    if (std::abs(entry(values_.value, psi_) - level) <= 1e-14 * size) break;
    if (!step(level, point, scale)) break;
    evaluate(tape_, cone_, point, values_);
  }
  return std::abs(entry(values_.value, psi_) - level) <= 1e-12 * size;
}

bool Projection::step(double level, Point& point, std::vector<double>& scale) {
  const auto slope = gradient(tape_, values_, psi_);
  double weighted = 0.0;
  for (const int variable : variables_) {
    const double part = entry(slope, variable) * entry(scale, variable);
    weighted += part * part;
  }
  if (!(weighted > 0.0) || !std::isfinite(weighted)) return false;
  const double factor = (entry(values_.value, psi_) - level) / weighted;
  for (const int variable : variables_) {
    const double size = entry(scale, variable);
    point[saltus::at(variable)] -= factor * entry(slope, variable) * size * size;
  }
  note_sizes(point, scale);
  return true;
}

namespace {

/// A surface, and the side of it that a point is wanted on.
class WantedSide {
 public:
  WantedSide(const Tape& tape, int alpha, double side, const Selections& discrete)
      : projection_(tape, tape[alpha].psi), above_(side > 0.5) {
    const auto at_zero = discrete.find(alpha);
    closed_ = at_zero != discrete.end() && at_zero->second == side;
    const bool of_cells = (tape[tape[alpha].psi].reached & kind_bit(VariableKind::cell)) != 0;
    fixed_ = at_zero != discrete.end() && of_cells;
  }

  [[nodiscard]] bool holds(const Point& point) {
    const auto [psi, size] = projection_.at(point);
    // As near as a projection comes.
    return fixed_ || (above_ ? psi > 0.0 : psi < 0.0) || (closed_ && std::abs(psi) <= 1e-12 * size);
  }

  /// @param margin  distance from the surface where the side does not contain it, as a part of the terms of psi
  bool reach(double margin, Point& point, std::vector<double>& scale) {
    const double level = closed_ ? 0.0 : margin * projection_.at(point).size;
    return projection_.onto(above_ ? level : -level, point, scale);
  }

 private:
  Projection projection_;
  bool above_;
  bool closed_ = false;  ///< the side contains the surface
  bool fixed_ = false;   ///< no point changes it
};

}  // namespace

bool move_to_sides(const Tape& tape, Projection& held, const Selections& sides, const Selections& discrete,
                   Point& point, std::vector<double>& scale) {
  std::vector<WantedSide> wanted;
  for (const auto& [alpha, side] : sides) wanted.emplace_back(tape, alpha, side, discrete);
  // The margin falls to 1e-6 of the terms: narrower regions than that are not looked for.
  double margin = 0.2;
  for (int turn = 0; turn < 20; ++turn, margin *= 0.5) {
    bool moved = false;
    for (auto& surface : wanted) {
      if (surface.holds(point)) continue;
      moved = true;
      if (!surface.reach(margin, point, scale)) return false;
    }
    if (!held.onto(0.0, point, scale)) return false;
    if (moved || !std::all_of(wanted.begin(), wanted.end(), [&](auto& surface) { return surface.holds(point); })) {
      continue;
    }
    for (const auto& [alpha, side] : sides) {
      if (discrete.contains(alpha)) point[at(tape[alpha].variable)] = side;
    }
    return true;
  }
  return false;
}

}  // namespace saltus::model
