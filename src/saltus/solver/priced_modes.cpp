#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/solver/crossover/priced_sides.hpp"
#include "saltus/solver/crossover/sides.hpp"
#include "saltus/solver/run_internal.hpp"

namespace saltus::solver {
namespace {

using mpcc::ActiveSide;
using Sides = std::vector<ActiveSide>;

/// Prices of the sum of zero sides, in units of the objective. At the first one sides are only brought near.
constexpr double first_price = 10.0, price_factor = 10.0, last_price = 1e6;
/// What is paid for a group of pairs at such a price is more than what a barrier leaves.
constexpr double paid_at_all = 1e-2;
constexpr int most_rounds = 30;
constexpr int first_limit = 1500, round_limit = 500, branch_limit = 500;
constexpr double round_tolerance = 1e-4;
/// Barrier parameters of the first problem, of those behind it, and of the branch.
constexpr double first_mu = 1e-2, next_mu = 1e-3, branch_mu = 1e-4;
constexpr double near_a_branch = 1e-4;
/// Violation of rows up to which the start is no motion, and multipliers say nothing.
constexpr double no_motion = 0.1;

class PricedModes {
 public:
  PricedModes(Run& run, linalg::Vector start) : run_(run), w_(std::move(start)) {
    linalg::Vector c(run.problem.rows());
    run.problem.functions(w_, c);
    sides_ = crossover::smaller_sides(run.problem, run.groups, c);
  }

  bool solve() {
    for (int round = 0; round < most_rounds && price_ <= last_price && !run_.is_over(); ++round) {
      const bool is_solved = solve_round(round == 0);
      if (run_.is_over()) break;
      const double paid = paid_at_all / price_;
      const Sides next = run_.problem.freed(sides_, w_, paid);
      const bool is_free = next == sides_;
      if (is_solved && is_free && price_ > first_price && solve_branch()) return true;
      const bool is_new = std::find(tried_.begin(), tried_.end(), next) == tried_.end();
      if (price_ > first_price && !is_free && is_new) {
        tried_.push_back(next);
        sides_ = next;
      } else {
        price_ *= price_factor;
      }
    }
    return false;
  }

 private:
  bool solve_round(bool is_first) {
    const double started = run_.seconds();
    crossover::PricedSides priced(run_.problem, sides_, price_);
    NlpOptions options = run_.nlp_options(is_first ? first_limit : round_limit);
    options.tolerance = round_tolerance;
    options.first_barrier_mu = is_first ? first_mu : next_mu;
    options.curved_below = no_motion;
    NlpPoint point{.w = w_, .y = {}, .z_lower = {}, .z_upper = {}};
    run_.problem.with_method_terms(w_);
    const NlpReport report = run_.nlp.solve(priced, point, options);
    run_.problem.without_method_terms();
    if (point.w.all_finite()) w_ = point.w;
    result::HomotopyStep step;
    step.sigma = 1.0 / price_;
    step.objective = run_.problem.objective(w_);
    step.primal_infeasibility = certificate::scaled_infeasibility(run_.problem, w_);
    step.complementarity_residual = certificate::complementarity(run_.problem, w_);
    step.message = fmt::format("modes with a price of {:.3g}", price_);
    if (!report.message.empty()) step.message += ": " + report.message;
    run_.record(step, &report, started);
    return report.termination == result::Termination::completed;
  }

  /// Where it has come near a limit is no reason to give it up.
  bool solve_branch() {
    const std::string message = "modes without a price";
    auto branch = run_.solve_branch(sides_, w_, branch_limit, message, std::nullopt, {}, branch_mu);
    const bool is_unfinished = branch.report.termination == result::Termination::iteration_limit;
    if (is_unfinished && branch.primal_infeasibility <= near_a_branch) {
      branch = run_.solve_branch(sides_, branch.w, first_limit, message, std::nullopt, {}, branch_mu);
    }
    if (!branch.is_feasible(run_.options.tolerance) || !std::isfinite(branch.objective)) return false;
    run_.branch = std::move(branch);
    return true;
  }

  Run& run_;
  linalg::Vector w_;
  Sides sides_;
  std::vector<Sides> tried_{};
  double price_ = first_price;
};

}  // namespace

bool solve_modes(Run& run, const linalg::Vector& start) { return PricedModes(run, start).solve(); }

}  // namespace saltus::solver
