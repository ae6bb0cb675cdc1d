#include "saltus/switching/point/point_solver.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/base/contains.hpp"
#include "saltus/base/stop.hpp"
#include "saltus/switching/point/open_unknowns_internal.hpp"

namespace saltus::switching {
namespace {

using Options = std::vector<std::vector<Face>>;

constexpr double few_leaves = 4096.0, most_leaves = 65536.0;  ///< tried at once; tried where pivots find nothing
constexpr double leaves_of_open = 64.0;  ///< as many cost as much as the choice of z that faces leave open

std::vector<Face> faces_of(const Block& block) {
  switch (block.kind) {
    case Block::Kind::absent:
      return {Face::open};
    case Block::Kind::free:
      return {Face::inside};
    case Block::Kind::half_line:
      return {Face::closed, Face::open};
    case Block::Kind::box:
      return {Face::inside, Face::lower, Face::upper};
    case Block::Kind::friction:
      break;
  }
  std::vector<Face> faces;
  if (block.is_at_rest()) faces.push_back(Face::stick);
  if (block.in_plane()) {
    faces.push_back(Face::slip);
  } else {
    if (block.velocity[0] >= 0.0) faces.push_back(Face::slip_up);
    if (block.velocity[0] <= 0.0) faces.push_back(Face::slip_down);
  }
  if (!block.is_given) faces.push_back(Face::open);
  return faces;
}

std::size_t active_blocks(const PointProblem& problem) {
  return at(std::count_if(problem.blocks.begin(), problem.blocks.end(),
                          [](const Block& block) { return block.kind != Block::Kind::absent; }));
}

/// Half lines whose rows do not depend on each other have one y, by one z: who clearly presses is closed in all
/// solutions, who clearly leaves is open.
void drop_impossible(const PointProblem& problem, Options& options) {
  constexpr std::size_t few = 2;  // as fast tried
  const auto is_other = [](const Block& block) {
    return block.kind != Block::Kind::absent && block.kind != Block::Kind::half_line;
  };
  if (active_blocks(problem) <= few || std::any_of(problem.blocks.begin(), problem.blocks.end(), is_other)) return;
  std::vector<Face> all;
  for (const Block& block : problem.blocks) {
    all.push_back(block.kind == Block::Kind::absent ? Face::open : Face::closed);
  }
  HeldRows rows(problem.constant.size());
  PointSolution found;
  if (!solve_least(problem, all, rows, found) || found.is_open) return;
  const auto vertex = vertex_by_pivots(problem, options);
  if (!vertex || !solve_least(problem, vertex->faces, rows, found) || found.margin < face_holds) return;
  const auto [y, z] = sizes_of(problem, found);
  constexpr double clear = 1e-3;
  for (std::size_t b = 0; b < problem.blocks.size(); ++b) {
    const int row = problem.blocks[b].row;
    if (problem.blocks[b].kind == Block::Kind::absent) continue;
    const bool presses = found.z(row) > clear * z, leaves = found.y(row) > clear * y;
    if (presses || leaves) options[b].assign(1, presses ? Face::closed : Face::open);
  }
}

bool moves_alike(const PointProblem& problem, const PointSolution& a, const PointSolution& b) {
  constexpr double rounded = 1e-6;
  return (a.y - b.y).max_abs() <= rounded * problem.terms;
}

bool moves_otherwise(const PointProblem& problem, const PointSolutions& known, const PointSolution& solution) {
  return std::none_of(known.all.begin(), known.all.end(),
                      [&](const PointSolution& other) { return moves_alike(problem, other, solution); });
}

void take_if_held(const PointProblem& problem, double holds, PointSolution& solution, PointSolutions& found) {
  if (solution.is_open) choose_open(problem, solution);
  if (solution.margin >= holds) found.all.push_back(std::move(solution));
}

/// Of those with one motion the first ones do. False where this costs more than all leaves without open z.
bool search_all(const PointProblem& problem, const Options& options, double holds, PointSolutions& found) {
  constexpr std::size_t enough = 16;
  std::vector<std::size_t> number(options.size(), 0);
  std::vector<Face> faces(options.size());
  HeldRows rows(problem.constant.size());
  PointSolution solution;
  for (double cost = 0.0; cost <= most_leaves;) {
    heed_stop();
    for (std::size_t b = 0; b < options.size(); ++b) faces[b] = options[b][number[b]];
    if (solve_least(problem, faces, rows, solution) &&
        (found.all.size() < enough || moves_otherwise(problem, found, solution))) {
      cost += solution.is_open ? leaves_of_open : 0.0;
      take_if_held(problem, holds, solution, found);
    }
    std::size_t b = 0;
    while (b < options.size() && ++number[b] == options[b].size()) number[b++] = 0;
    if (b == options.size()) return found.complete = true;
  }
  return false;
}

/// Of a solution: what does not move is held, as far as its options go; what slips does so along its y.
std::vector<Face> widest_faces(const PointProblem& problem, const Options& options, const PointSolution& solution) {
  constexpr double moved = 1e-8;
  const double still = moved * sizes_of(problem, solution).y;
  auto faces = solution.faces;
  for (std::size_t b = 0; b < faces.size(); ++b) {
    const Block& block = problem.blocks[b];
    if (block.kind == Block::Kind::absent || std::abs(solution.y(block.row)) > still) continue;
    const linalg::Vector along = block.along(solution.y);
    const bool slides = along.max_abs() > still;
    const Face slip = block.in_plane() ? Face::slip : along[0] > 0.0 ? Face::slip_up : Face::slip_down;
    for (const Face wider : {Face::closed, Face::inside, slides ? slip : Face::stick}) {
      if (contains(options[b], wider)) faces[b] = wider;
    }
  }
  return faces;
}

void search_some(const PointProblem& problem, const Options& options, const FaceHints& hints, PointSolutions& found) {
  PointSolution solution;
  const auto add = [&](const std::vector<Face>& faces) {
    if (!solve_on(problem, faces, solution)) return false;
    const bool holds = solution.margin >= hints.holds;
    const auto is_known = [&](const PointSolution& other) { return other.faces == faces; };
    if (holds && std::none_of(found.all.begin(), found.all.end(), is_known)) found.all.push_back(solution);
    return true;
  };
  const auto are_options = [&] {
    if (hints.before.empty()) return false;
    for (std::size_t b = 0; b < options.size(); ++b) {
      if (!contains(options[b], hints.before[b])) return false;
    }
    return true;
  };
  if (are_options()) static_cast<void>(add(hints.before));
  const auto pivoted = vertex_by_pivots(problem, options);
  if (!pivoted) return;
  PointSolution vertex;
  vertex.faces = pivoted->faces;
  vertex.z = pivoted->z;
  vertex.y = problem.constant + problem.effects * vertex.z;
  static_cast<void>(add(vertex.faces));
  static_cast<void>(add(widest_faces(problem, options, vertex)));
  std::stable_partition(found.all.begin(), found.all.end(),
                        [&](const PointSolution& one) { return one.margin > -hints.holds; });
}

}  // namespace

bool is_same_with_open(const PointProblem& problem, const PointSolution& solution, const PointSolution& other) {
  bool any = false;
  for (std::size_t b = 0; b < problem.blocks.size(); ++b) {
    if (other.faces[b] == solution.faces[b]) continue;
    if (other.faces[b] != Face::open) return false;
    any = true;
  }
  return any && moves_alike(problem, solution, other);
}

double margin_of_forces(const PointProblem& problem, PointSolution solution) {
  for (std::size_t b = 0; b < problem.blocks.size(); ++b) {
    if (solution.faces[b] == Face::open) solution.y(problem.blocks[b].row) = std::numeric_limits<double>::infinity();
  }
  return margin_of(problem, solution);
}

PointSolutions solve_point(const PointProblem& problem, const FaceHints& hints) {
  PointSolutions found;
  Options options;
  double leaves = 1.0;
  for (std::size_t b = 0; b < problem.blocks.size(); ++b) {
    auto faces = faces_of(problem.blocks[b]);
    const bool is_absent = problem.blocks[b].kind == Block::Kind::absent;
    if (!is_absent && !hints.excluded.empty())
      std::erase_if(faces, [&](Face face) { return contains(hints.excluded[b], face); });
    if (faces.empty()) return {{}, true};
    options.push_back(std::move(faces));
  }
  if (std::all_of(hints.excluded.begin(), hints.excluded.end(), [](const auto& faces) { return faces.empty(); }))
    drop_impossible(problem, options);
  for (const auto& faces : options) leaves *= static_cast<double>(faces.size());
  if (leaves > few_leaves || !search_all(problem, options, hints.holds, found)) {
    search_some(problem, options, hints, found);
    if (found.all.empty() && leaves <= most_leaves) search_all(problem, options, hints.holds, found);
  }
  const auto is_open = [](Face face) { return face == Face::open; };
  if (std::all_of(hints.before.begin(), hints.before.end(), is_open)) return found;
  std::stable_partition(found.all.begin(), found.all.end(),
                        [&](const PointSolution& one) { return one.faces == hints.before; });
  return found;
}

std::optional<bool> is_one_motion(const PointProblem& problem, const PointSolutions& solutions, std::size_t chosen) {
  const PointSolution& own = solutions.all[chosen];
  const bool one = std::all_of(solutions.all.begin(), solutions.all.end(),
                               [&](const PointSolution& other) { return moves_alike(problem, other, own); }) &&
                   is_determined(problem, own);
  if (!one) return false;
  return solutions.complete ? std::optional(true) : std::nullopt;
}

}  // namespace saltus::switching
