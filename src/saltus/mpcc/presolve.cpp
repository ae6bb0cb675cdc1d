#include "saltus/mpcc/presolve.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/at.hpp"

namespace saltus::mpcc {
namespace {

constexpr double no_bound = std::numeric_limits<double>::infinity();
/// What neither rounding of the file's numbers nor the tolerance of a solver takes for zero.
constexpr double certain = 1e-6;

bool is_above(double value, double bound) {
  return std::isfinite(bound) && value > bound + certain * std::max(1.0, std::abs(bound));
}

class Finder {
 public:
  Finder(const Problem& problem, const Bounds& ranges) : problem_(problem), ranges_(ranges) {
    has_variable_.assign(at(problem.rows()), false);
    const auto& [lower, upper] = problem.variable_bounds();
    const auto& pattern = problem.jacobian_pattern();
    for (int e = 0; e < pattern.entries(); ++e) has_variable_[at(pattern.row[at(e)])] = true;
    for (int i = 0; i < problem.variables(); ++i) {
      found_.fixed_variables += lower[i] == upper[i] ? 1 : 0;
      if (is_above(lower[i], upper[i])) {
        found_.infeasible.push_back(fmt::format("{}: bounds {} > {}", problem.name(i), lower[i], upper[i]));
      }
    }
  }

  Presolve find() {
    for (int row = 0; row < problem_.constraints(); ++row) look_at_row(row);
    for (int pair = 0; pair < problem_.pairs(); ++pair) look_at_pair(pair);
    return std::move(found_);
  }

 private:
  void look_at_row(int row) {
    const double lower = problem_.constraint_bounds().lower[row], upper = problem_.constraint_bounds().upper[row];
    contradict(row, lower, upper);
    const bool is_empty = !has_variable_[at(row)] || (!std::isfinite(lower) && !std::isfinite(upper));
    found_.empty_rows += is_empty ? 1 : 0;
    if (!is_empty) found_.kept_rows.push_back(row);
  }

  void look_at_pair(int pair) {
    const int G = problem_.constraints() + pair, H = G + problem_.pairs();
    contradict(G, 0.0, no_bound);
    contradict(H, 0.0, no_bound);
    if (is_positive(G) && is_positive(H)) {
      found_.infeasible.push_back(
          fmt::format("{} and {}: both are positive within the bounds of the variables and of rows of one variable",
                      problem_.row_name(G), problem_.row_name(H)));
    }
    for (const auto& [side, other] : {std::pair(G, H), std::pair(H, G)}) {
      if (is_positive(side)) {
        ++found_.forced_pairs;
        found_.zero_sides.push_back(other);
        return;
      }
      if (ranges_.upper[side] == 0.0 && ranges_.lower[side] == 0.0) {
        ++found_.fixed_pairs;
        found_.positive_sides.push_back(other);
        return;
      }
    }
    found_.kept_pairs.push_back(pair);
  }

  [[nodiscard]] bool is_positive(int side) const { return ranges_.lower[side] > certain; }

  void contradict(int row, double lower, double upper) {
    if (!is_above(ranges_.lower[row], upper) && !is_above(lower, ranges_.upper[row])) return;
    found_.infeasible.push_back(
        fmt::format("{}: {:.6g} to {:.6g} within the bounds of the variables, but {:.6g} to {:.6g} is asked for",
                    problem_.row_name(row), ranges_.lower[row], ranges_.upper[row], lower, upper));
  }

  const Problem& problem_;
  const Bounds& ranges_;
  std::vector<bool> has_variable_;
  Presolve found_;
};

}  // namespace

Presolve presolve(const Problem& problem, const Bounds& ranges) { return Finder(problem, ranges).find(); }

PresolvedProblem::PresolvedProblem(Problem& problem, Presolve found)
    : problem_(problem), found_(std::move(found)), variable_bounds_(problem.variable_bounds()) {
  fix_zero_sides();
  const auto& bounds = problem.constraint_bounds();
  std::vector<double> lower, upper;
  const auto add = [&](int row, double least, double most) {
    rows_.push_back(row);
    lower.push_back(least);
    upper.push_back(most);
  };
  for (const int row : found_.kept_rows) add(row, bounds.lower[row], bounds.upper[row]);
  for (const int side : found_.zero_sides) add(side, 0.0, 0.0);
  for (const int side : found_.positive_sides) add(side, 0.0, no_bound);
  constraint_bounds_ = {linalg::ConstView(lower), linalg::ConstView(upper)};
  for (const int first : {0, problem.pairs()}) {
    for (const int pair : found_.kept_pairs) {
      rows_.push_back(problem.constraints() + first + pair);
      signs_.push_back(problem.signs()[at(first + pair)]);
    }
  }
  find_pattern();
}

/// A sum of distances is zero if and only if each of them is: as bounds, gradients do not depend on those of bounds.
void PresolvedProblem::fix_zero_sides() {
  linalg::Vector values(problem_.jacobian_pattern().entries());
  problem_.jacobian(problem_.start(), values);
  const auto& pattern = problem_.jacobian_pattern();
  std::vector<bool> is_fixed(at(problem_.rows()), false);
  const auto is_implied = [&](int side) {
    return problem_.signs()[at(side - problem_.constraints())] == Sign::implied;
  };
  for (const int side : found_.zero_sides) is_fixed[at(side)] = is_implied(side);
  for (int e = 0; e < pattern.entries(); ++e) {
    if (!is_fixed[at(pattern.row[at(e)])] || values[e] == 0.0) continue;
    const int i = pattern.column[at(e)];
    auto& [lower, upper] = variable_bounds_;
    (values[e] > 0.0 ? upper : lower)[i] = values[e] > 0.0 ? lower[i] : upper[i];
  }
  std::erase_if(found_.zero_sides, is_implied);
  std::erase_if(found_.positive_sides, is_implied);
}

void PresolvedProblem::find_pattern() {
  std::vector<int> place(at(problem_.rows()), -1);
  for (std::size_t row = 0; row < rows_.size(); ++row) place[at(rows_[row])] = static_cast<int>(row);
  const auto& pattern = problem_.jacobian_pattern();
  for (int e = 0; e < pattern.entries(); ++e) {
    const int row = place[at(pattern.row[at(e)])];
    if (row < 0) continue;
    jacobian_entries_.push_back(e);
    jacobian_pattern_.add(row, pattern.column[at(e)]);
  }
}

void PresolvedProblem::functions(ConstVectorView w, VectorView c) {
  linalg::Vector all(problem_.rows());
  problem_.functions(w, all);
  for (linalg::Index row = 0; row < c.size(); ++row) c[row] = all[rows_[at(row)]];
}

void PresolvedProblem::jacobian(ConstVectorView w, VectorView values) {
  linalg::Vector all(problem_.jacobian_pattern().entries());
  problem_.jacobian(w, all);
  for (linalg::Index e = 0; e < values.size(); ++e) values[e] = all[jacobian_entries_[at(e)]];
}

void PresolvedProblem::hessian(ConstVectorView w, double objective_factor, ConstVectorView y, VectorView values) {
  linalg::Vector all = linalg::Vector::zero(problem_.rows());
  for (linalg::Index row = 0; row < y.size(); ++row) all[rows_[at(row)]] = y[row];
  problem_.hessian(w, objective_factor, all, values);
}

}  // namespace saltus::mpcc
