#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/base/contains.hpp"
#include "saltus/linalg/factors.hpp"
#include "saltus/switching/point/nonnegative_solution.hpp"
#include "saltus/switching/point/on_faces.hpp"
#include "saltus/switching/point/open_unknowns_internal.hpp"

namespace saltus::switching {
namespace {

using linalg::Index;
using linalg::Matrix;
using linalg::Vector;

constexpr double left_of_rows = 1e-9;  ///< relative, where they depend on others
constexpr double independent = 1e-6;   ///< of unit vectors

/// What is above 0 as long as a face holds: parts of z times these numbers, and a constant.
struct Slack {
  std::array<int, 3> rows{-1, -1, -1};
  std::array<double, 3> parts{};
  double constant = 0.0;
  [[nodiscard]] double operator()(linalg::ConstView z) const {
    double value = 0.0;
    for (std::size_t k = 0; k < 3; ++k) value += rows[k] < 0 ? 0.0 : parts[k] * z[rows[k]];
    return value;
  }
};

Slack cone_slack(const Block& block, double first, double second) {
  return {{block.row, block.tangents[0], block.tangents[1]}, {block.friction, -first, -second}};
}

bool is_closed(const PointProblem& problem, const PointSolution& solution, std::size_t b) {
  const auto kind = problem.blocks[b].kind;
  return (kind == Block::Kind::half_line || kind == Block::Kind::friction) && solution.faces[b] != Face::open &&
         !contains(solution.idle, static_cast<int>(b));
}

/// A cone of two tangents is the meet of half spaces: of some, and those that are found to be missing.
std::vector<Slack> slacks_of(const PointProblem& problem, const PointSolution& solution) {
  constexpr int sides = 8;
  std::vector<Slack> slacks;
  for (std::size_t b = 0; b < problem.blocks.size(); ++b) {
    const Block& block = problem.blocks[b];
    if (solution.faces[b] == Face::inside && block.kind == Block::Kind::box) {
      slacks.push_back({{block.row, -1, -1}, {1.0}, -block.lower});
      slacks.push_back({{block.row, -1, -1}, {-1.0}, block.upper});
    }
    if (!is_closed(problem, solution, b)) continue;
    if (!block.is_given) slacks.push_back({{block.row, -1, -1}, {1.0}});
    if (solution.faces[b] != Face::stick) continue;
    for (int side = 0; side < (block.in_plane() ? sides : 2); ++side) {
      const double angle = 2.0 * std::numbers::pi * side / (block.in_plane() ? sides : 2);
      slacks.push_back(cone_slack(block, std::cos(angle), block.in_plane() ? std::sin(angle) : 0.0));
    }
  }
  return slacks;
}

/// The open changes of z, orthonormal, that leave all of y as it is.
Matrix without_motion(const PointProblem& problem, const HeldRows& rows) {
  constexpr double none = 1e-9;
  Matrix open = rows.open(problem.effects);
  if (open.cols() == 0) return open;
  for (Index k = 0; k < open.cols(); ++k) open.col(k) /= open.col(k).norm();
  const Matrix motion = problem.effects * open;
  if (motion.max_abs() > none * problem.effects.max_abs()) {
    linalg::OrthogonalFactors factors;
    factors.set_threshold(none);
    factors.compute(motion);
    open = Matrix(open * factors.null_space());
  }
  // The orthogonal complement of what is orthogonal to them.
  if (open.cols() < 2) return open;
  Matrix orthonormal(open.rows(), open.cols());
  for (Index k = 0; k < open.cols(); ++k) {
    Vector rest = open.col(k);
    for (int twice = 0; twice < 2; ++twice) {
      for (Index i = 0; i < k; ++i) rest.add_scaled(-orthonormal.col(i).dot(rest), orthonormal.col(i));
    }
    orthonormal.col(k) = rest.normalized();
  }
  return orthonormal;
}

/// The least change along `open`, in the unit of z, with which the least slack is as large as can be, or enough. It is
/// a problem of least distance in the change and in what is missing [lawson1974].
Vector best_change(const std::vector<Slack>& slacks, const Matrix& open, const Vector& z, double unit,
                   double enough = 1.0) {
  // Of what is missing: large changes only where small ones do not do.
  constexpr double far_larger = 1e3, exact = 1e5;
  const double weight = enough > 0.0 ? far_larger : exact;
  const Index k = open.cols();
  Matrix columns(k + 2, index(slacks.size()));
  for (std::size_t s = 0; s < slacks.size(); ++s) {
    auto column = columns.col(index(s));
    for (Index i = 0; i < k; ++i) column[i] = slacks[s](open.col(i));
    column[k] = 1.0 / weight;
    column[k + 1] = enough - (slacks[s](z) + slacks[s].constant) / unit;
  }
  const Vector goal = Vector::unit(k + 2, k + 1);
  const Vector rest = goal - columns * nonnegative_solution(columns, goal);
  return -1.0 / rest[k + 1] * rest.head(k);
}

/// Adds the half spaces of cones that the others leave out; whether there are any.
bool add_missing(const PointProblem& problem, const PointSolution& solution, double unit, std::vector<Slack>& slacks) {
  constexpr double near = 1e-9;
  const std::size_t known = slacks.size();
  for (std::size_t b = 0; b < problem.blocks.size(); ++b) {
    const Block& block = problem.blocks[b];
    if (!block.in_plane() || solution.faces[b] != Face::stick || !is_closed(problem, solution, b)) continue;
    const Vector along = block.along(solution.z).normalized();
    const Slack own = cone_slack(block, along[0], along[1]);
    double least = own(solution.z) + 2.0 * near * unit;
    for (std::size_t s = 0; s < known; ++s) {
      if (slacks[s].rows == own.rows) least = std::min(least, slacks[s](solution.z));
    }
    if (own(solution.z) < least - near * unit) slacks.push_back(own);
  }
  return slacks.size() > known;
}

/// Goes to where the faces hold best. Whether that is better than before.
bool take_best(const PointProblem& problem, const Matrix& open, double unit, PointSolution& solution) {
  if (open.cols() == 0 || !(unit > 0.0)) return false;
  const PointSolution start = solution;
  auto slacks = slacks_of(problem, solution);
  constexpr int most_rounds = 30;
  for (int round = 0; round < most_rounds && !slacks.empty(); ++round) {
    const Vector change = best_change(slacks, open, start.z, unit);
    if (!change.all_finite()) break;
    solution.z = start.z + unit * (open * change);
    if (!add_missing(problem, solution, unit, slacks)) break;
  }
  solution.margin = margin_of(problem, solution);
  if (solution.margin > start.margin) return true;
  solution = start;
  return false;
}

/// Rows that depend on others, chosen one after the other so that those that are left still hold them.
class Dependent {
 public:
  Dependent(const Matrix& effects, const std::vector<int>& rows) : place_(at(effects.rows()), -1) {
    for (std::size_t k = 0; k < rows.size(); ++k) place_[at(rows[k])] = static_cast<int>(k);
    linalg::OrthogonalFactors factors;
    factors.set_threshold(left_of_rows);
    factors.compute(effects.selected(rows, rows));
    if (factors.rank() < index(rows.size())) open_ = factors.null_space();
    left_ = open_.cols();
  }
  [[nodiscard]] Index left() const { return left_; }
  /// Whether these can be left out, too; they are then.
  bool leave(const std::vector<int>& rows) {
    const std::size_t before = taken_.size();
    for (const int row : rows) {
      Vector part = place_[at(row)] < 0 ? Vector::zero(open_.cols()) : Vector(open_.row(place_[at(row)]));
      for (const Vector& other : taken_) part.add_scaled(-other.dot(part), other);
      if (!(part.norm() > independent)) {
        taken_.resize(before);
        return false;
      }
      taken_.push_back(part.normalized());
    }
    left_ = open_.cols() - static_cast<Index>(taken_.size());
    return true;
  }

 private:
  std::vector<int> place_;
  Matrix open_{0, 0};
  Index left_ = 0;
  std::vector<Vector> taken_;
};

/// The rows of a block whose z vanish with it: those that do not follow from its normal part.
std::vector<int> own_rows(const PointProblem& problem, const PointSolution& solution, int b) {
  const Block& block = problem.blocks[at(b)];
  std::vector<int> rows{block.row};
  for (const int tangent : block.tangents) {
    if (tangent >= 0 && solution.faces[at(b)] == Face::stick) rows.push_back(tangent);
  }
  return rows;
}

/// Closed blocks: those with the least z_n come first, of equal ones the last.
std::vector<int> by_size(const PointProblem& problem, const PointSolution& solution) {
  std::vector<int> order;
  for (std::size_t b = problem.blocks.size(); b-- > 0;) {
    if (is_closed(problem, solution, b) && !problem.blocks[b].is_given) order.push_back(static_cast<int>(b));
  }
  constexpr double equal = 1e-9;
  const double unit = equal * solution.z.max_abs();
  const auto size = [&](int b) { return unit > 0.0 ? std::round(solution.z(problem.blocks[at(b)].row) / unit) : 0.0; };
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return size(a) < size(b); });
  return order;
}

std::vector<int> normal_rows(const PointProblem& problem, const std::vector<int>& blocks) {
  std::vector<int> rows;
  for (const int b : blocks) rows.push_back(problem.blocks[at(b)].row);
  return rows;
}

/// What is left of changes that leave some rows of z as they are.
Matrix without_rows(const Matrix& open, const std::vector<int>& rows) {
  linalg::OrthogonalFactors factors;
  factors.set_threshold(left_of_rows);
  factors.compute(open.selected_rows(rows));
  return open * factors.null_space();
}

/// A block of a closed one that its rows leave open: others take its forces over along `open`.
struct Relief {
  PointSolution solution;
  Matrix open;
  Dependent of_normals, of_all;
};

/// What follows where a block is left idle; nothing where others do not hold its normal row, or all of them its rows.
std::optional<Relief> without(const PointProblem& problem, const Relief& state, int b, double unit) {
  const auto rows = own_rows(problem, state.solution, b);
  const Matrix own = state.open.selected_rows(rows);
  const Vector needed = state.solution.z.selected_rows(rows);
  const Vector change = linalg::OrthogonalFactors(own).solve(needed);
  constexpr double rounding = 1e-12;
  if ((own * change - needed).max_abs() > rounding * state.solution.z.max_abs()) return std::nullopt;
  Relief next = state;
  if (!next.of_normals.leave({problem.blocks[at(b)].row}) || !next.of_all.leave(rows)) return std::nullopt;
  next.solution.z -= state.open * change;
  for (const int row : rows) next.solution.z(row) = 0.0;
  next.solution.idle.push_back(b);
  next.open = without_rows(state.open, rows);
  next.solution.margin = margin_of(problem, next.solution);
  static_cast<void>(take_best(problem, next.open, unit, next.solution));
  return next;
}

/// Leaves blocks idle, one after the other: the first that costs less than half of the margin, else the one that costs
/// least.
void leave_idle(const PointProblem& problem, const HeldRows& held, const Matrix& open, double unit,
                PointSolution& solution) {
  const auto normals = normal_rows(problem, by_size(problem, solution));
  if (normals.empty() || open.cols() == 0) return;
  Relief state{solution, open, Dependent(problem.effects, normals), Dependent(problem.effects, held.held())};
  while (state.of_normals.left() > 0 && state.open.cols() > 0) {
    std::optional<Relief> best;
    for (const int b : by_size(problem, state.solution)) {
      auto next = without(problem, state, b, unit);
      if (!next || (best && !(next->solution.margin > best->solution.margin))) continue;
      best = std::move(next);
      if (best->solution.margin > 0.5 * state.solution.margin) break;
    }
    if (!best) break;
    state = std::move(*best);
  }
  solution = std::move(state.solution);
}

/// One block after the other, each where the faces hold best without it: for those whose forces move something.
void leave_one_by_one(const PointProblem& problem, PointSolution& solution) {
  HeldRows rows(problem.constant.size());
  for (;;) {
    find_held_rows(problem, solution, rows);
    const auto closed = by_size(problem, solution);
    std::optional<PointSolution> best;
    for (const int b : closed) {
      Dependent of_normals(problem.effects, normal_rows(problem, closed));
      if (of_normals.left() == 0) return;
      Dependent of_all(problem.effects, rows.held());
      if (!of_normals.leave({problem.blocks[at(b)].row}) || !of_all.leave(own_rows(problem, solution, b))) continue;
      PointSolution without = solution;
      without.idle.push_back(b);
      HeldRows fewer(problem.constant.size());
      if (!solve_rows(problem, fewer, without)) continue;
      without.margin = margin_of(problem, without);
      if (!best || without.margin > best->margin) best = std::move(without);
    }
    if (!best) return;
    solution = std::move(*best);
  }
}

/// Whether a closed block bears nothing in the least z that holds.
bool presses_for_nothing(const PointProblem& problem, const Matrix& open, double unit, const PointSolution& solution) {
  constexpr double nothing = 1e-7;
  if (open.cols() == 0 || !(unit > 0.0)) return false;
  const Vector own = open.transpose() * solution.z;
  const Vector least = solution.z - open * own;
  const Vector z = least + unit * (open * best_change(slacks_of(problem, solution), open, least, unit, 0.0));
  for (std::size_t b = 0; b < problem.blocks.size(); ++b) {
    const bool bears = is_closed(problem, solution, b) && !problem.blocks[b].is_given;
    if (bears && z(problem.blocks[b].row) <= nothing * unit) return true;
  }
  return false;
}

}  // namespace

void choose_open(const PointProblem& problem, PointSolution& solution) {
  const PointSolution least = solution;
  HeldRows rows(problem.constant.size());
  const auto improve = [&] {
    find_held_rows(problem, solution, rows);
    const Matrix open = without_motion(problem, rows);
    const double unit = sizes_of(problem, solution).z;
    static_cast<void>(take_best(problem, open, unit, solution));
    solution.is_stressed = solution.margin >= face_holds && presses_for_nothing(problem, open, unit, solution);
    return std::pair(open, unit);
  };
  const auto [open, unit] = improve();
  PointSolution fewer = solution;
  leave_idle(problem, rows, open, unit, fewer);
  const auto idle = fewer.idle;
  fewer = least;
  fewer.idle = idle;
  if (!idle.empty() && !solve_rows(problem, rows, fewer)) return;
  fewer.margin = margin_of(problem, fewer);
  if (fewer.is_open) leave_one_by_one(problem, fewer);
  if (fewer.idle.empty()) return;
  solution = std::move(fewer);
  if (solution.is_open) static_cast<void>(improve());
}

}  // namespace saltus::switching
