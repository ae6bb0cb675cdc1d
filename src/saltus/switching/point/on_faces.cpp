#include "saltus/switching/point/on_faces.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/base/contains.hpp"
#include "saltus/switching/point/open_unknowns_internal.hpp"

namespace saltus::switching {

using linalg::Index;
using linalg::Matrix;
using linalg::Vector;

Sizes sizes_of(const PointProblem& problem, const PointSolution& solution) {
  // Where what acts on a block vanishes, what is left of it is the rounding of its terms.
  constexpr double rounded = 1e-5;
  double largest = 0.0;
  for (Index i = 0; i < problem.constant.size(); ++i) {
    const double part = solution.y(i) - problem.constant(i);
    largest = std::max(largest, std::abs(problem.constant(i)) + std::abs(part));
  }
  const double response = problem.effects.max_abs();
  const double least = response > 0.0 ? rounded * problem.terms / response : 0.0;
  return {std::max(rounded * problem.terms, largest), std::max(least, solution.z.max_abs())};
}

double margin_of(const PointProblem& problem, const PointSolution& solution) {
  const Sizes sizes = sizes_of(problem, solution);
  double least = std::numeric_limits<double>::infinity();
  const auto note = [&](double value, double size) { least = std::min(least, size > 0.0 ? value / size : 0.0); };
  for (std::size_t b = 0; b < problem.blocks.size(); ++b) {
    const Block& block = problem.blocks[b];
    const Face face = solution.faces[b];
    const double z = solution.z(block.row), y = solution.y(block.row);
    if (block.kind == Block::Kind::absent || block.kind == Block::Kind::free) continue;
    if (face == Face::open || face == Face::lower) note(y, sizes.y);
    if (face == Face::upper) note(-y, sizes.y);
    if (face == Face::inside) note(std::min(z - block.lower, block.upper - z), block.upper - block.lower);
    if (block.kind == Block::Kind::box || face == Face::open) continue;
    const bool is_idle = contains(solution.idle, static_cast<int>(b));
    if (!is_idle) note(z, sizes.z);
    if (!is_idle && face == Face::stick) note(block.friction * z - block.along(solution.z).norm(), sizes.z);
    if (!slips(face)) continue;
    const Vector& direction = solution.directions[b];
    const Vector velocity{block.velocity[0], block.velocity[1]};
    block.is_at_rest() ? note(direction.dot(block.along(solution.y)), sizes.y)
                       : note(direction.dot(velocity), velocity.norm());
  }
  return least;
}

void find_held_rows(const PointProblem& problem, const PointSolution& solution, HeldRows& rows) {
  rows.clear();
  for (std::size_t b = 0; b < problem.blocks.size(); ++b) {
    const Block& block = problem.blocks[b];
    const Face face = solution.faces[b];
    if (block.kind == Block::Kind::absent || face == Face::open) continue;
    if (face == Face::lower || face == Face::upper) {
      rows.give(block.row, face == Face::lower ? block.lower : block.upper);
      continue;
    }
    if (contains(solution.idle, static_cast<int>(b))) continue;
    if (block.is_given) rows.give(block.row, 1.0);
    const int normal = block.is_given ? -1 : rows.hold(block.row);
    for (int tangent = 0; tangent < 2 && block.tangents[at(tangent)] >= 0; ++tangent) {
      const int row = block.tangents[at(tangent)];
      rows.share(row, normal, -block.friction * solution.directions[b](tangent));
      if (face == Face::stick) rows.hold(row);
    }
  }
}

bool solve_rows(const PointProblem& problem, HeldRows& rows, PointSolution& solution) {
  find_held_rows(problem, solution, rows);
  const auto found = rows.solve(problem.effects, problem.constant, solution.z);
  if (found == HeldRows::Solution::none) return false;
  solution.is_open = found == HeldRows::Solution::open;
  solution.y.resize(solution.z.size());
  linalg::multiply(problem.effects, solution.z, solution.y);
  solution.y += problem.constant;
  return true;
}

namespace {

/// Against the forces that would keep these blocks from slipping; where others hold them, too, these forces are not
/// one, and the way is that of a motion without friction.
void guess_directions(const PointProblem& problem, const std::vector<int>& free, HeldRows& rows,
                      PointSolution& solution) {
  PointSolution guess = solution;
  for (const int b : free) guess.faces[at(b)] = Face::stick;
  const bool sticks = solve_rows(problem, rows, guess) && !guess.is_open;
  const bool moves = !sticks && solve_rows(problem, rows, guess = solution);
  for (const int b : free) {
    const Block& block = problem.blocks[at(b)];
    const Vector needed = sticks  ? Vector(-block.along(guess.z))
                          : moves ? block.along(guess.y)
                                  : block.along(problem.constant);
    solution.directions[at(b)] = needed.norm() > 0.0 ? Vector(needed.normalized()) : Vector{1.0, 0.0};
  }
}

}  // namespace

bool solve_least(const PointProblem& problem, const std::vector<Face>& faces, HeldRows& rows, PointSolution& solution) {
  solution.faces = faces;
  solution.directions.resize(faces.size());
  solution.idle.clear();
  std::vector<int> free;
  for (std::size_t b = 0; b < faces.size(); ++b) {
    const Block& block = problem.blocks[b];
    if (block.kind != Block::Kind::friction) continue;
    Vector& direction = solution.directions[b];
    direction.set_zero(2);
    if (faces[b] == Face::slip_up) direction = Vector{1.0, 0.0};
    if (faces[b] == Face::slip_down) direction = Vector{-1.0, 0.0};
    if (faces[b] != Face::slip) continue;
    if (block.is_at_rest()) {
      free.push_back(static_cast<int>(b));
    } else {
      direction = Vector{block.velocity[0], block.velocity[1]}.normalized();
    }
  }
  const auto solve = [&] { return solve_rows(problem, rows, solution); };
  if (!free.empty()) guess_directions(problem, free, rows, solution);
  if (!(free.empty() ? solve() : find_directions(problem, free, solution.directions, solution.z, solution.y, solve)))
    return false;
  solution.margin = margin_of(problem, solution);
  solution.is_stressed = false;
  return true;
}

bool solve_on(const PointProblem& problem, const std::vector<Face>& faces, PointSolution& solution) {
  HeldRows rows(problem.constant.size());
  if (!solve_least(problem, faces, rows, solution)) return false;
  if (solution.is_open) choose_open(problem, solution);
  return true;
}

bool solve_without(const PointProblem& problem, const std::vector<int>& idle, PointSolution& solution) {
  HeldRows rows(problem.constant.size());
  solution.idle = idle;
  if (!solve_rows(problem, rows, solution)) return false;
  solution.margin = margin_of(problem, solution);
  return solution.margin >= face_holds;
}

Matrix open_changes(const PointProblem& problem, const PointSolution& solution) {
  HeldRows rows(problem.constant.size());
  find_held_rows(problem, solution, rows);
  return rows.open(problem.effects);
}

bool is_determined(const PointProblem& problem, const PointSolution& solution) {
  PointSolution base = solution;
  base.idle.clear();
  if (!solution.is_open && solution.idle.empty()) return true;
  const Matrix open = open_changes(problem, base);
  const double response = problem.effects.max_abs();
  constexpr double small = 1e-6, moved = 1e-12;
  for (Index k = 0; k < open.cols(); ++k) {
    const Vector z = open.col(k) * (small * problem.terms / (response * open.col(k).max_abs()));
    const Vector change = problem.effects * z;
    if (!(change.max_abs() > moved * problem.terms)) continue;
    for (const double sign : {1.0, -1.0}) {
      PointSolution other = base;
      other.z += sign * z;
      other.y += sign * change;
      if (margin_of(problem, other) >= face_holds) return false;
    }
  }
  return true;
}

bool find_directions(const PointProblem& problem, const std::vector<int>& free, std::vector<Vector>& directions,
                     const Vector& z, const Vector& y, FunctionRef<bool()> solve) {
  // A step along the rate, as long as would turn friction around: one block without other influences needs one. Where
  // the normal part depends on the direction, too, that may be too long.
  constexpr int most_steps = 500;
  constexpr double settled = 1e-15, found = 1e-9;
  double change = 0.0, length = 1.0;
  for (int step = 0; step < most_steps; ++step) {
    if (!solve()) return false;
    const double last = change;
    change = 0.0;
    for (const int b : free) {
      const Block& block = problem.blocks[at(b)];
      const auto [first, second] = block.tangents;
      const double push =
          block.friction * z(block.row) * std::max(problem.effects(first, first), problem.effects(second, second));
      Vector& direction = directions[at(b)];
      const Vector rate = block.along(y);
      const auto behind = [&](double part) { return push > 0.0 ? Vector(direction + part * rate / push) : rate; };
      const Vector next = behind(length);
      if (!(next.norm() > 0.0)) continue;
      change = std::max(change, (behind(1.0).normalized() - direction).norm());
      direction = next.normalized();
    }
    if (change <= settled) break;
    if (step > 0 && change >= last) length *= 0.5;
  }
  return change <= found && solve();
}

}  // namespace saltus::switching
