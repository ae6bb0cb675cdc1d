#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "saltus/base/function_ref.hpp"
#include "saltus/model/sharing_internal.hpp"
#include "saltus/model/surfaces_internal.hpp"

namespace saltus::model {
namespace {

/// Points that count, and starts at most; a surface that few starts reach is given up as listed.
constexpr int enough_points = 64;
constexpr int seeded_starts = 192;
constexpr int neighbour_limit = 32;
/// Part of a branch difference nearby that still counts as none on the surface. Ten times larger would hide weak
/// friction beside strong springs, ten times smaller would come near the accuracy of the points.
constexpr double jump_tolerance = 1e-9;

double entry(const std::vector<double>& values, int index) { return values[static_cast<std::size_t>(index)]; }

/// Start number k: every second one around the initial state, the others around 0; sizes from 1e-3 to 1e3.
/// Only the given variables (moving ones) are set.
Point start_point(const Tape& tape, std::span<const int> variables, int k) {
  constexpr std::array<double, 7> magnitudes{1.0, 0.1, 10.0, 1e-2, 100.0, 1e-3, 1e3};
  const double magnitude = entry({magnitudes.begin(), magnitudes.end()}, (k / 2) % 7);
  Point point = blank_point(tape);
  for (const int index : variables) {
    const auto i = static_cast<std::size_t>(index);
    const Variable& variable = tape.variables()[i];
    const double draw = magnitude * seeded_draw(static_cast<std::uint64_t>(k) + 5000, i);
    const double base = variable.kind == VariableKind::time || !std::isfinite(variable.value) ? 0.0 : variable.value;
    point[i] = k % 2 == 0 ? base + draw : draw;
  }
  return point;
}

/// The variables t, x, u below the roots, also through alphas.
std::vector<int> moving_variables(const Tape& tape, std::span<const int> roots) {
  std::vector<int> found;
  for (const int node : tape.cone(roots, Links::through_alpha)) {
    const int variable = tape[node].variable;
    if (variable < 0 || tape[node].psi >= 0) continue;
    const VariableKind kind = tape.variables()[static_cast<std::size_t>(variable)].kind;
    if (kind != VariableKind::parameter) found.push_back(variable);
  }
  return found;
}

/// Moves points onto psi = 0 by Newton's method along the gradient; coordinates move in proportion to their size.
class Projection {
 public:
  Projection(const Tape& tape, int psi)
      : tape_(tape),
        psi_(psi),
        cone_(tape.cone(std::span(&psi, 1), Links::through_alpha)),
        variables_(moving_variables(tape, std::span(&psi, 1))) {}

  /// @return whether |psi| fell to rounding level; `scale` gets the sizes of the coordinates the point went through.
  bool onto_surface(Point& point, std::vector<double>& scale) {
    scale.assign(point.size(), 0.0);
    note_sizes(point, scale);
    evaluate_with_bounds(tape_, cone_, point, scale, 0.0, values_);
    const double size = std::max(std::abs(entry(values_.value, psi_)), entry(values_.bound, psi_));
    if (!std::isfinite(size)) return false;
    // psi = x^2 needs about 40 halvings to reach the tolerance, a transversal surface 3 to 8 steps.
    for (int iteration = 0; iteration < 60; ++iteration) {
      const double psi = entry(values_.value, psi_);
      if (std::abs(psi) <= 1e-14 * size) break;
      if (!step(point, scale)) break;
      evaluate(tape_, cone_, point, values_);
    }
    return std::abs(entry(values_.value, psi_)) <= 1e-12 * size;
  }

 private:
  void note_sizes(const Point& point, std::vector<double>& scale) const {
    for (const int variable : variables_) {
      double& size = scale[static_cast<std::size_t>(variable)];
      size = std::max(size, std::abs(entry(point, variable)));
    }
  }

  bool step(Point& point, std::vector<double>& scale) {
    const auto slope = gradient(tape_, values_, psi_);
    double weighted = 0.0;
    for (const int variable : variables_) {
      const double part = entry(slope, variable) * entry(scale, variable);
      weighted += part * part;
    }
    if (!(weighted > 0.0) || !std::isfinite(weighted)) return false;
    const double factor = entry(values_.value, psi_) / weighted;
    for (const int variable : variables_) {
      const double size = entry(scale, variable);
      point[static_cast<std::size_t>(variable)] -= factor * entry(slope, variable) * size * size;
    }
    note_sizes(point, scale);
    return true;
  }

  const Tape& tape_;
  int psi_;
  std::vector<int> cone_;
  std::vector<int> variables_;
  TapeValues values_;
};

std::vector<int> alpha_nodes(const Tape& tape, std::span<const int> roots, Links links) {
  std::vector<int> found;
  for (const int node : tape.cone(roots, links)) {
    if (tape[node].psi >= 0) found.push_back(node);
  }
  return found;
}

/// The psi of the other surfaces that take part in the targets, at most neighbour_limit.
std::vector<int> neighbours_of(const Tape& tape, const std::vector<int>& targets, int alpha) {
  std::vector<int> neighbours;
  for (const int node : alpha_nodes(tape, targets, Links::through_alpha)) {
    if (node != alpha && static_cast<int>(neighbours.size()) < neighbour_limit) neighbours.push_back(tape[node].psi);
  }
  return neighbours;
}

/// A small step off a surface, to either side of it in turns.
void displace(Point& point, const std::vector<double>& scale, int k) {
  for (std::size_t i = 0; i < point.size(); ++i) {
    if (scale[i] > 0.0) point[i] += 1e-3 * scale[i] * seeded_draw(static_cast<std::uint64_t>(k) + 7000, i);
  }
}

/// Points on one surface: from seeded starts, and from starts on either side of the neighbouring surfaces, since what
/// alpha_j multiplies may live in a thin region only.
class SurfaceWalk {
 public:
  SurfaceWalk(const Tape& tape, const Surface& surface, const std::vector<int>& targets)
      : tape_(tape), projection_(tape, surface.psi), neighbours_(neighbours_of(tape, targets, surface.alpha)) {
    std::vector<int> roots = targets;
    roots.push_back(surface.psi);
    variables_ = moving_variables(tape, roots);
  }

  /// Visits points until `visit` returns false or none are left.
  /// @return number of points visited
  int visit(FunctionRef<bool(const Point&, const std::vector<double>&)> visit) {
    int visited = 0;
    for (int k = 0; k < seeded_starts && visited < enough_points; ++k) {
      if (!visit_from(start_point(tape_, variables_, k), visit, visited)) return visited;
    }
    for (const int neighbour : neighbours_) {
      Projection onto_neighbour(tape_, neighbour);
      for (int k = 0; k < 12; ++k) {
        std::vector<double> scale;
        Point point = start_point(tape_, variables_, k);
        if (!onto_neighbour.onto_surface(point, scale)) continue;
        displace(point, scale, k);
        if (!visit_from(point, visit, visited)) return visited;
      }
    }
    return visited;
  }

 private:
  bool visit_from(Point point, FunctionRef<bool(const Point&, const std::vector<double>&)> visit, int& visited) {
    std::vector<double> scale;
    if (!projection_.onto_surface(point, scale)) return true;
    ++visited;
    return visit(point, scale);
  }

  const Tape& tape_;
  Projection projection_;
  std::vector<int> neighbours_;
  std::vector<int> variables_;
};

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
  }

  void at(Point point, const std::vector<double>& scale) {
    hold_others(point);
    psi_here_ = triples(point, scale, here_, Rounding::bounded);
    for (std::size_t i = 0; i < scale.size(); ++i) {
      if (scale[i] > 0.0) point[i] += 0.1 * scale[i] * seeded_draw(9000, i);
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
    const double rounding = std::isfinite(bound_[target]) ? std::min(bound_[target], 1e-5 * size) : 0.0;
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
      point[static_cast<std::size_t>(tape_[node].variable)] = entry(values_.value, node) > 0.5 ? 1.0 : 0.0;
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
  TapeValues values_;
  std::vector<Triple> here_, nearby_;
  std::vector<double> bound_;
  double psi_here_ = 0.0, psi_nearby_ = 0.0;
};

double jump_of(const Triple& values) { return values[2] - values[0]; }
double bend_of(const Triple& values) { return values[1] - 0.5 * (values[0] + values[2]); }

/// Whether a target's difference is found anywhere on the surface; assumed where no point shows anything.
bool found_on_surface(const Tape& tape, const Surface& surface, const std::vector<int>& targets,
                      double (*difference)(const Triple&)) {
  Profiler profiler(tape, surface, targets);
  bool found = false, reached = false;
  SurfaceWalk(tape, surface, targets).visit([&](const Point& point, const std::vector<double>& scale) {
    profiler.at(point, scale);
    for (std::size_t i = 0; i < targets.size(); ++i) {
      const auto exceeds = profiler.exceeds(i, difference);
      reached = reached || exceeds.has_value();
      found = found || exceeds.value_or(false);
    }
    return !found;
  });
  return found || !reached;
}

std::vector<int> containing(const std::vector<int>& targets, int alpha,
                            const std::vector<std::vector<int>>& alphas_of_target) {
  std::vector<int> found;
  for (std::size_t i = 0; i < targets.size(); ++i) {
    const auto& alphas = alphas_of_target[i];
    if (std::binary_search(alphas.begin(), alphas.end(), alpha)) found.push_back(targets[i]);
  }
  return found;
}

}  // namespace

std::vector<SwitchingRole> classify(const Tape& tape, const std::vector<Surface>& surfaces,
                                    const std::vector<int>& targets) {
  std::vector<std::vector<int>> alphas_of_target;
  for (const int target : targets) {
    alphas_of_target.push_back(alpha_nodes(tape, std::span(&target, 1), Links::written));
  }
  std::vector<SwitchingRole> roles;
  for (const Surface& surface : surfaces) {
    if ((tape[surface.psi].reached & kind_bit(VariableKind::state)) == 0) {
      roles.push_back(SwitchingRole::time_event);
      continue;
    }
    const auto affected = containing(targets, surface.alpha, alphas_of_target);
    const bool listed = !affected.empty() && found_on_surface(tape, surface, affected, jump_of);
    roles.push_back(listed ? SwitchingRole::listed : SwitchingRole::kink);
  }
  return roles;
}

bool bends_on_surface(const Tape& tape, const Surface& surface, int target) {
  return found_on_surface(tape, surface, {target}, bend_of);
}

}  // namespace saltus::model
