// Problems whose objective falls without end.
#include <algorithm>
#include <cmath>

#include "saltus/solver/certificate/linearise.hpp"
#include "saltus/solver/crossover/sides.hpp"
#include "saltus/solver/run_internal.hpp"

namespace saltus::solver {

bool falls_without_end(Run& run, const linalg::Vector& w) {
  // So far that all distances of the point are nothing against it.
  constexpr double far = 1e12;
  const double length = far * std::max(1.0, w.max_abs());
  auto& problem = run.problem;
  linalg::Vector c(problem.rows());
  problem.functions(w, c);
  const double before = problem.objective(w);
  if (!c.all_finite() || !std::isfinite(before)) return false;
  const double tolerance = run.options.tolerance;
  const auto sides = crossover::smaller_sides(problem, run.groups, c);
  const auto states = certificate::pair_states(problem, w, sides, tolerance);
  const auto linear = certificate::linearise(problem, w, states, nullptr, length);
  const LpccSolution found = run.lpcc.solve(linear.problem, seconds_of_lpcc(run));
  const bool has_ray =
      found.termination == result::Termination::completed && found.objective < -tolerance * linear.scale;
  if (!has_ray) return false;
  // What is not affine leaves the tangent, or its objective the slope.
  const linalg::Vector ahead = w + length * found.d;
  const double violation =
      std::max(certificate::scaled_infeasibility(problem, ahead), certificate::complementarity(problem, ahead));
  return violation <= tolerance * length && problem.objective(ahead) <= before + 0.5 * length * found.objective;
}

}  // namespace saltus::solver
