#include <algorithm>
#include <cmath>
#include <limits>

#include "saltus/adapters/ipopt/ipopt_program_internal.hpp"
#include "saltus/base/at.hpp"
#include "saltus/base/contracts.hpp"
#include "saltus/base/stopwatch.hpp"
#include "saltus/mpcc/elimination.hpp"

namespace saltus::adapters {
namespace {

using Input = linalg::ConstView;
using Output = linalg::View;

/// Adds the time until its end to a sum.
class Timer {
 public:
  explicit Timer(double& seconds) : seconds_(seconds) {}
  ~Timer() { seconds_ += stopwatch_.seconds(); }
  Timer(const Timer&) = delete;
  Timer& operator=(const Timer&) = delete;

 private:
  double& seconds_;
  Stopwatch stopwatch_;
};

/// Copies the entries of these numbers to as many behind each other.
void take(Input from, const std::vector<int>& numbers, double* to) {
  for (const int number : numbers) *to++ = from[number];
}

/// Copies all entries to those of these numbers.
void put(Input from, const std::vector<int>& numbers, Output to) {
  linalg::Index next = 0;
  for (const int number : numbers) to[number] = from[next++];
}

void write_pattern(const mpcc::Pattern& pattern, Ipopt::Index* row, Ipopt::Index* column) {
  std::copy(pattern.row.begin(), pattern.row.end(), row);
  std::copy(pattern.column.begin(), pattern.column.end(), column);
}

/// Steps below do not move the point any more.
constexpr double standstill = 1e-8;
/// Such steps in a row after which the solver is stopped: at a singular point it would go on to its limit.
constexpr int patience = 12;
/// Where the optimality conditions are singular Ipopt finds the optimum and then wanders about it, as no step can
/// satisfy them to the last digit. An objective that changes by less than this, relative above 1, has been found.
constexpr double equal_objective = 1e-11;
constexpr double feasible = 1e-9;
constexpr double small_barrier = 1e-7;
constexpr int patience_at_optimum = 4;
/// Below these violations, barrier parameters and gradients of the Lagrangian an objective is that of the solution but
/// for this, relative above 1. The barrier parameter alone says nothing: it falls far from any solution, too.
constexpr double nearly_solved = 1e-5;
constexpr double nearly_optimal = 1e-4;

}  // namespace

void IpoptProgram::set(mpcc::Problem& problem, solver::NlpPoint& point, const solver::NlpOptions& options) {
  problem_ = &problem;
  point_ = &point;
  is_interrupted_ = options.is_interrupted;
  evaluation_seconds_ = 0.0;
  standing_ = equal_ = 0;
  last_objective_ = best_error_ = std::numeric_limits<double>::infinity();
  acceptable_ = options.acceptable_tolerance;
  feasible_ = std::min(options.tolerance, feasible);
  cutoff_ = options.objective_cutoff.value_or(last_objective_);
  is_cut_off_ = is_near_ = false;
  curved_below_ = options.curved_below;
  pace_ = {};
  find_rows();
}

bool IpoptProgram::stands_still() const { return standing_ >= patience; }

bool IpoptProgram::is_exhausted() const { return equal_ >= patience_at_optimum && best_error_ <= acceptable_; }

void IpoptProgram::watch(double objective, double primal_infeasibility, double dual_infeasibility, double mu,
                         const Ipopt::IpoptData* data, Ipopt::IpoptCalculatedQuantities* quantities) {
  const bool is_equal = std::abs(objective - last_objective_) <= equal_objective * std::max(1.0, std::abs(objective));
  last_objective_ = objective;
  const double scale = std::max(1.0, std::abs(cutoff_));
  is_cut_off_ = std::max({primal_infeasibility, dual_infeasibility, mu}) <= nearly_solved &&
                objective > cutoff_ + nearly_optimal * scale;
  is_near_ = primal_infeasibility <= feasible_ && mu <= small_barrier;
  equal_ = is_near_ && is_equal ? equal_ + 1 : 0;
  if (!is_near_ || !(dual_infeasibility < best_error_)) return;
  if (read_iterate(data, quantities, best_)) best_error_ = dual_infeasibility;
}

bool IpoptProgram::read_iterate(const Ipopt::IpoptData* data, Ipopt::IpoptCalculatedQuantities* quantities,
                                solver::NlpPoint& point) {
  const auto n = static_cast<Ipopt::Index>(point_->w.size());
  const auto m = static_cast<Ipopt::Index>(rows_.size());
  point.w.resize(n);
  point.z_lower.resize(n);
  point.z_upper.resize(n);
  point.y.resize(m);
  return get_curr_iterate(data, quantities, /*scaled=*/false, n, point.w.data(), point.z_lower.data(),
                          point.z_upper.data(), m, nullptr, point.y.data());
}

void IpoptProgram::take_iterate(const Ipopt::IpoptData* data, Ipopt::IpoptCalculatedQuantities* quantities) {
  pace_.untaken = 0;
  if (!read_iterate(data, quantities, best_)) return;
  y_.set_zero();
  put(best_.y, rows_, y_);
  *point_ = {.w = best_.w, .y = y_, .z_lower = best_.z_lower, .z_upper = best_.z_upper};
}

void IpoptProgram::find_rows() {
  const auto& bounds = problem_->constraint_bounds();
  rows_.clear();
  std::vector<int> own_row(static_cast<std::size_t>(problem_->constraints()), -1);
  for (int row = 0; row < problem_->constraints(); ++row) {
    if (!std::isfinite(bounds.lower[row]) && !std::isfinite(bounds.upper[row])) continue;
    own_row[static_cast<std::size_t>(row)] = static_cast<int>(rows_.size());
    rows_.push_back(row);
  }
  entries_.clear();
  jacobian_pattern_ = {};
  const auto& pattern = problem_->jacobian_pattern();
  for (int e = 0; e < pattern.entries(); ++e) {
    const int row = own_row[static_cast<std::size_t>(pattern.row[static_cast<std::size_t>(e)])];
    if (row < 0) continue;
    entries_.push_back(e);
    jacobian_pattern_.add(row, pattern.column[static_cast<std::size_t>(e)]);
  }
  c_ = y_ = linalg::Vector::zero(problem_->constraints());
  jacobian_ = linalg::Vector::zero(pattern.entries());
}

std::vector<int> IpoptProgram::elimination_blocks(int size) const {
  const auto of_variables = problem_->elimination_blocks();
  if (of_variables.empty()) return {};
  const auto of_rows = mpcc::blocks_of_rows(of_variables, problem_->jacobian_pattern(), problem_->constraints());
  std::vector<int> blocks, of_equations, of_inequalities;
  for (int i = 0; i < problem_->variables(); ++i) {
    const bool is_fixed = problem_->variable_bounds().lower[i] == problem_->variable_bounds().upper[i];
    if (!is_fixed) blocks.push_back(of_variables[at(i)]);
  }
  for (const int row : rows_) {
    const bool is_equation = problem_->constraint_bounds().lower[row] == problem_->constraint_bounds().upper[row];
    (is_equation ? of_equations : of_inequalities).push_back(of_rows[at(row)]);
  }
  for (const auto& more : {of_inequalities, of_equations, of_inequalities}) {
    blocks.insert(blocks.end(), more.begin(), more.end());
  }
  return std::ssize(blocks) == size ? blocks : std::vector<int>();
}

bool IpoptProgram::get_nlp_info(Ipopt::Index& n, Ipopt::Index& m, Ipopt::Index& jacobian_entries,
                                Ipopt::Index& hessian_entries, IndexStyleEnum& index_style) {
  SALTUS_ASSERT(problem_->pairs() == 0);
  n = problem_->variables();
  m = static_cast<Ipopt::Index>(rows_.size());
  jacobian_entries = static_cast<Ipopt::Index>(entries_.size());
  hessian_entries = problem_->hessian_pattern().entries();
  index_style = C_STYLE;
  return true;
}

bool IpoptProgram::get_bounds_info(Ipopt::Index n, double* w_lower, double* w_upper, Ipopt::Index m, double* g_lower,
                                   double* g_upper) {
  Output(w_lower, n) = problem_->variable_bounds().lower;
  Output(w_upper, n) = problem_->variable_bounds().upper;
  SALTUS_ASSERT(static_cast<std::size_t>(m) == rows_.size());
  take(problem_->constraint_bounds().lower, rows_, g_lower);
  take(problem_->constraint_bounds().upper, rows_, g_upper);
  return true;
}

bool IpoptProgram::get_starting_point(Ipopt::Index n, bool wants_w, double* w, bool wants_z, double* z_lower,
                                      double* z_upper, Ipopt::Index m, bool wants_y, double* y) {
  if (wants_w) Output(w, n) = point_->w;
  if (wants_z) {
    if (point_->z_lower.size() != n || point_->z_upper.size() != n) return false;
    Output(z_lower, n) = point_->z_lower;
    Output(z_upper, n) = point_->z_upper;
  }
  if (wants_y) {
    if (point_->y.size() != problem_->constraints()) return false;
    SALTUS_ASSERT(static_cast<std::size_t>(m) == rows_.size());
    take(point_->y, rows_, y);
  }
  return true;
}

bool IpoptProgram::eval_f(Ipopt::Index n, const double* w, bool /*is_new*/, double& value) {
  const Timer timer(evaluation_seconds_);
  value = problem_->objective(Input(w, n));
  return std::isfinite(value);
}

bool IpoptProgram::eval_grad_f(Ipopt::Index n, const double* w, bool /*is_new*/, double* gradient) {
  const Timer timer(evaluation_seconds_);
  problem_->objective_gradient(Input(w, n), Output(gradient, n));
  return Input(gradient, n).all_finite();
}

bool IpoptProgram::eval_g(Ipopt::Index n, const double* w, bool /*is_new*/, Ipopt::Index m, double* g) {
  const Timer timer(evaluation_seconds_);
  problem_->functions(Input(w, n), c_);
  take(c_, rows_, g);
  return Input(g, m).all_finite();
}

bool IpoptProgram::eval_jac_g(Ipopt::Index n, const double* w, bool /*is_new*/, Ipopt::Index /*m*/,
                              Ipopt::Index entries, Ipopt::Index* row, Ipopt::Index* column, double* values) {
  if (values == nullptr) {
    write_pattern(jacobian_pattern_, row, column);
    return true;
  }
  const Timer timer(evaluation_seconds_);
  problem_->jacobian(Input(w, n), jacobian_);
  take(jacobian_, entries_, values);
  return Input(values, entries).all_finite();
}

bool IpoptProgram::eval_h(Ipopt::Index n, const double* w, bool /*is_new*/, double objective_factor, Ipopt::Index m,
                          const double* y, bool /*is_new_y*/, Ipopt::Index entries, Ipopt::Index* row,
                          Ipopt::Index* column, double* values) {
  if (values == nullptr) {
    write_pattern(problem_->hessian_pattern(), row, column);
    return true;
  }
  const Timer timer(evaluation_seconds_);
  put(Input(y, m), rows_, y_);
  if (curved_below_) y_.set_zero();
  problem_->hessian(Input(w, n), objective_factor, y_, Output(values, entries));
  return Input(values, entries).all_finite();
}

bool IpoptProgram::intermediate_callback(Ipopt::AlgorithmMode mode, Ipopt::Index /*iteration*/, double objective,
                                         double primal_infeasibility, double dual_infeasibility, double mu,
                                         double step_norm, double /*regularisation*/, double /*dual_step*/,
                                         double primal_step, Ipopt::Index /*trials*/, const Ipopt::IpoptData* data,
                                         Ipopt::IpoptCalculatedQuantities* quantities) {
  ++pace_.untaken;
  if (mode == Ipopt::RegularMode && primal_infeasibility <= curved_below_.value_or(0.0)) curved_below_.reset();
  if (pace_.longest > 0) return !is_too_long() && !(is_interrupted_ && is_interrupted_());
  standing_ = primal_step * step_norm <= standstill ? standing_ + 1 : 0;
  watch(objective, primal_infeasibility, dual_infeasibility, mu, data, quantities);
  return !stands_still() && !is_exhausted() && !is_cut_off() && !(is_interrupted_ && is_interrupted_());
}

void IpoptProgram::finalize_solution(Ipopt::SolverReturn status, Ipopt::Index n, const double* w, const double* z_lower,
                                     const double* z_upper, Ipopt::Index m, const double* /*g*/, const double* y,
                                     double objective, const Ipopt::IpoptData* /*data*/,
                                     Ipopt::IpoptCalculatedQuantities* /*quantities*/) {
  y_.set_zero();
  put(Input(y, m), rows_, y_);
  *point_ = {.w = Input(w, n), .y = y_, .z_lower = Input(z_lower, n), .z_upper = Input(z_upper, n)};
  objective_ = objective;
  const bool is_limited = status == Ipopt::MAXITER_EXCEEDED || status == Ipopt::WALLTIME_EXCEEDED;
  const bool was_nearer = is_limited && !is_near_ && std::isfinite(best_error_);
  if (!is_exhausted() && !was_nearer) return;
  put(best_.y, rows_, y_);
  *point_ = {.w = best_.w, .y = y_, .z_lower = best_.z_lower, .z_upper = best_.z_upper};
  objective_ = problem_->objective(best_.w);
}

}  // namespace saltus::adapters
