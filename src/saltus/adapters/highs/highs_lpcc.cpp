#include "saltus/adapters/highs/highs_lpcc.hpp"

#include <Highs.h>
#include <algorithm>
#include <cmath>
#include <limits>

#include "saltus/base/at.hpp"
#include "saltus/base/contracts.hpp"
#include "saltus/base/stopwatch.hpp"
#include "saltus/solver/sparse.hpp"

namespace saltus::adapters {
namespace {

using result::Termination;
using solver::LpccProblem;
using solver::LpccSolution;

/// HiGHS's own smallest; rows and variables are of order 1.
constexpr double feasibility = 1e-10;
/// A row this near to its bound is at it.
constexpr double at_bound = 1e-9;
/// What is better than the best solution by less is not looked at.
constexpr double gap = 1e-12;

HighsLp linear_program(const LpccProblem& problem) {
  const auto n = static_cast<int>(problem.cost.size());
  const auto m = static_cast<int>(problem.rows.lower.size());
  const auto matrix = solver::sparse<linalg::Major::columns>(problem.pattern, problem.entries, m, n);
  const auto copy = [](const linalg::Vector& values) { return std::vector<double>(values.begin(), values.end()); };
  HighsLp lp;
  lp.num_col_ = n;
  lp.num_row_ = m;
  lp.col_cost_ = copy(problem.cost);
  lp.col_lower_ = copy(problem.variables.lower);
  lp.col_upper_ = copy(problem.variables.upper);
  lp.row_lower_ = copy(problem.rows.lower);
  lp.row_upper_ = copy(problem.rows.upper);
  lp.a_matrix_.format_ = MatrixFormat::kColwise;
  lp.a_matrix_.num_col_ = n;
  lp.a_matrix_.num_row_ = m;
  lp.a_matrix_.start_.assign(matrix.start().begin(), matrix.start().end());
  lp.a_matrix_.index_.assign(matrix.inner().begin(), matrix.inner().end());
  lp.a_matrix_.value_.assign(matrix.values().begin(), matrix.values().end());
  return lp;
}

class Search {
 public:
  Search(const LpccProblem& problem, double seconds, int node_limit)
      : problem_(problem),
        seconds_(seconds),
        node_limit_(node_limit),
        choice_(problem.disjunctions.size(), Choice::open) {
    bool is_set = highs_.setOptionValue("output_flag", false) == HighsStatus::kOk;
    is_set = is_set && highs_.setOptionValue("primal_feasibility_tolerance", feasibility) == HighsStatus::kOk;
    is_set = is_set && highs_.setOptionValue("dual_feasibility_tolerance", feasibility) == HighsStatus::kOk;
    is_set = is_set && highs_.setOptionValue("threads", 1) == HighsStatus::kOk;
    is_set = is_set && highs_.setOptionValue("solver", "simplex") == HighsStatus::kOk;
    SALTUS_ASSERT(is_set);
  }

  LpccSolution run() {
    best_.d = linalg::Vector::zero(problem_.cost.size());
    for (const auto& [first, second] : problem_.disjunctions) {
      best_.first_is_active.push_back(problem_.rows.lower[first] == 0.0);
    }
    best_.objective = zero_is_feasible() ? 0.0 : std::numeric_limits<double>::infinity();
    if (highs_.passModel(linear_program(problem_)) == HighsStatus::kError) return std::move(best_);
    explore();
    if (is_cut_short_) {
      best_.termination = out_of_time() ? Termination::time_limit : Termination::not_converged;
    } else {
      best_.termination = std::isfinite(best_.objective) ? Termination::completed : Termination::infeasible;
    }
    return std::move(best_);
  }

 private:
  enum class Choice { open, first, second };

  [[nodiscard]] bool out_of_time() const { return stopwatch_.seconds() >= seconds_; }

  /// 0 is a solution unless rows or bounds exclude it: a bound to begin with.
  [[nodiscard]] bool zero_is_feasible() const {
    const auto holds = [](const mpcc::Bounds& bounds) {
      return bounds.lower.size() == 0 || (bounds.lower.max() <= 0.0 && bounds.upper.min() >= 0.0);
    };
    const bool are_at_bounds =
        std::all_of(problem_.disjunctions.begin(), problem_.disjunctions.end(), [&](const auto& disjunction) {
          return problem_.rows.lower[disjunction.first] == 0.0 || problem_.rows.lower[disjunction.second] == 0.0;
        });
    return holds(problem_.rows) && holds(problem_.variables) && are_at_bounds;
  }

  [[nodiscard]] double distance(int row) const {
    return highs_.getSolution().row_value[at(row)] - problem_.rows.lower[row];
  }

  /// The open disjunction that the program's solution violates most; -1 if it violates none.
  [[nodiscard]] int most_violated() const {
    double largest = at_bound;
    int found = -1;
    for (std::size_t i = 0; i < choice_.size(); ++i) {
      if (choice_[i] != Choice::open) continue;
      const double violation =
          std::min(distance(problem_.disjunctions[i].first), distance(problem_.disjunctions[i].second));
      if (violation > largest) {
        largest = violation;
        found = static_cast<int>(i);
      }
    }
    return found;
  }

  void keep() {
    const auto& values = highs_.getSolution().col_value;
    best_.d = linalg::ConstView(values);
    best_.objective = highs_.getInfo().objective_function_value;
    for (std::size_t i = 0; i < choice_.size(); ++i) {
      const auto& [first, second] = problem_.disjunctions[i];
      const bool is_nearer = distance(first) <= distance(second);
      best_.first_is_active[i] = choice_[i] == Choice::open ? is_nearer : choice_[i] == Choice::first;
    }
  }

  /// From the basis of the node before; where simplex does not come to an end from there, from the beginning.
  HighsModelStatus solve_node() {
    const auto is_decided = [&] {
      const auto status = highs_.getModelStatus();
      return status == HighsModelStatus::kOptimal || status == HighsModelStatus::kInfeasible;
    };
    highs_.run();
    for (const char* presolve : {"on", "off"}) {
      if (is_decided() || out_of_time()) break;
      highs_.clearSolver();
      highs_.setOptionValue("presolve", presolve);
      highs_.run();
    }
    highs_.setOptionValue("presolve", "choose");
    return highs_.getModelStatus();
  }

  void explore() {
    if (is_cut_short_ || best_.nodes >= node_limit_ || out_of_time()) {
      is_cut_short_ = true;
      return;
    }
    ++best_.nodes;
    const HighsModelStatus status = solve_node();
    if (status == HighsModelStatus::kInfeasible) return;
    if (status != HighsModelStatus::kOptimal) {
      is_cut_short_ = true;
      return;
    }
    if (highs_.getInfo().objective_function_value >= best_.objective - gap) return;
    const int violated = most_violated();
    if (violated < 0) {
      keep();
      return;
    }
    const auto& [first, second] = problem_.disjunctions[at(violated)];
    const bool first_before = distance(first) <= distance(second);
    for (const bool is_first : {first_before, !first_before}) {
      const int row = is_first ? first : second;
      const double lower = problem_.rows.lower[row];
      const double upper = highs_.getLp().row_upper_[at(row)];  // another disjunction may hold the same row
      choice_[at(violated)] = is_first ? Choice::first : Choice::second;
      highs_.changeRowBounds(row, lower, lower);
      explore();
      highs_.changeRowBounds(row, lower, upper);
    }
    choice_[at(violated)] = Choice::open;
  }

  const LpccProblem& problem_;
  double seconds_;
  int node_limit_;
  std::vector<Choice> choice_;
  Highs highs_;
  LpccSolution best_;
  bool is_cut_short_ = false;
  Stopwatch stopwatch_;
};

}  // namespace

HighsLpcc::HighsLpcc(int node_limit) : node_limit_(node_limit) {}
HighsLpcc::~HighsLpcc() = default;

LpccSolution HighsLpcc::solve(const LpccProblem& problem, double seconds) {
  return Search(problem, seconds, node_limit_).run();
}

}  // namespace saltus::adapters
