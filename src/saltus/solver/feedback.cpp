#include "saltus/solver/feedback.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "saltus/base/at.hpp"
#include "saltus/linalg/sparse_factors.hpp"
#include "saltus/solver/crossover/branch_problem.hpp"
#include "saltus/solver/crossover/sides.hpp"

namespace saltus::solver {
namespace {

constexpr double diagonal_shift = 1e-9;
/// Of the size of a bound: what is nearer is on it.
constexpr double on_bound = 1e-7;
constexpr int no_element = std::numeric_limits<int>::max();

bool is_on(double value, double bound) {
  return std::isfinite(bound) && std::abs(value - bound) <= on_bound * std::max(1.0, std::abs(bound));
}

std::vector<bool> on_bounds(const linalg::Vector& values, const mpcc::Bounds& bounds) {
  std::vector<bool> on;
  for (linalg::Index i = 0; i < values.size(); ++i) {
    on.push_back(is_on(values[i], bounds.lower[i]) || is_on(values[i], bounds.upper[i]));
  }
  return on;
}

std::vector<bool> equal_bounds(const mpcc::Bounds& bounds) {
  std::vector<bool> equal;
  for (linalg::Index i = 0; i < bounds.lower.size(); ++i) equal.push_back(bounds.lower[i] == bounds.upper[i]);
  return equal;
}

crossover::BranchProblem branch_of(mpcc::Problem& problem, const Solution& solution) {
  linalg::Vector c(problem.rows());
  problem.functions(solution.w, c);
  const auto sides =
      solution.crossed_over ? solution.sides : crossover::smaller_sides(problem, crossover::groups_of(problem), c);
  return {problem, crossover::reduce(problem, sides, jacobian_matrix(problem, solution.w), c)};
}

/// The optimality conditions of the branch problem, and the conditions of what is behind an element's start as a part
/// of them.
class Conditions {
 public:
  Conditions(mpcc::Problem& problem, const Solution& solution, const std::optional<TrackingScales>& scales)
      : chain_(*problem.chain()), branch_(branch_of(problem, solution)), place_(branch_.reduction().place) {
    const linalg::Vector v = branch_.reduced(solution.w);
    linalg::Vector values(branch_.jacobian_pattern().entries()), c(branch_.constraints());
    branch_.jacobian(v, values);
    rows_ = sparse<linalg::Major::rows>(branch_.jacobian_pattern(), values, branch_.constraints(), branch_.variables());
    if (scales) {
      is_active_ = equal_bounds(branch_.constraint_bounds());
      is_fixed_ = equal_bounds(branch_.variable_bounds());
      take_tracking(*scales);
      find_elements();
      return;
    }
    branch_.functions(v, c);
    is_active_ = on_bounds(c, branch_.constraint_bounds());
    is_fixed_ = on_bounds(v, branch_.variable_bounds());
    take_hessian(v, multipliers(problem, solution.multipliers));
    find_elements();
  }

  /// d u_k / d x at the start of element e of interval k; 0 where the conditions cannot be factorised.
  [[nodiscard]] linalg::Matrix gain(int k, int e, int controls, int states) {
    mark(k, e, states);
    linalg::Matrix gain = linalg::Matrix::zero(controls, states);
    std::vector<linalg::Triplet> entries;
    linalg::Matrix right = linalg::Matrix::zero(unknowns_ + rows_.rows(), states);
    add_hessian(entries, right);
    const linalg::Index size = add_rows(entries, right);
    const linalg::SparseLu factors(linalg::SparseColumns(size, size, entries));
    if (!factors.is_factorised()) return gain;
    const linalg::Matrix change = factors.solve(right.top_rows(size));
    const auto& shared = chain_.intervals[at(k)].shared;
    for (int i = 0; i < controls; ++i) {
      const int place = place_[at(shared.first + i)];
      if (place < 0 || unknown_[at(place)] < 0) continue;
      if (change.row(unknown_[at(place)]).all_finite()) gain.row(i) = change.row(unknown_[at(place)]);
    }
    return gain;
  }

 private:
  /// Of the rows of the branch problem, in L = f + y'c.
  [[nodiscard]] linalg::Vector multipliers(const mpcc::Problem& problem, const MpccMultipliers& found) const {
    linalg::Vector all = linalg::Vector::zero(problem.rows());
    if (found.rows.size() == problem.constraints()) all.head(found.rows.size()) = found.rows;
    if (found.G.size() == problem.pairs() && found.H.size() == problem.pairs()) {
      all.segment(problem.constraints(), problem.pairs()) = -found.G;
      all.tail(problem.pairs()) = -found.H;
    }
    const auto& rows = branch_.reduction().rows;
    linalg::Vector y(static_cast<linalg::Index>(rows.size()));
    for (std::size_t i = 0; i < rows.size(); ++i) y[index(i)] = all[rows[i]];
    return y;
  }

  void take_hessian(const linalg::Vector& v, const linalg::Vector& y) {
    const auto& pattern = branch_.hessian_pattern();
    linalg::Vector values(pattern.entries());
    branch_.hessian(v, 1.0, y, values);
    for (int e = 0; e < pattern.entries(); ++e) {
      const int i = pattern.row[at(e)], j = pattern.column[at(e)];
      hessian_.push_back({i, j, values[e]});
      if (i != j) hessian_.push_back({j, i, values[e]});
    }
  }

  /// Squares of deviations at the ends of intervals.
  void take_tracking(const TrackingScales& scales) {
    const auto weigh = [&](int variable, double scale) {
      const int place = place_[at(variable)];
      if (place >= 0) hessian_.push_back({place, place, 1.0 / (scale * scale)});
    };
    for (const auto& [shared, first, elements] : chain_.intervals) {
      for (std::size_t i = 0; i < scales.controls.size(); ++i)
        weigh(shared.first + static_cast<int>(i), scales.controls[i]);
      const auto& end = chain_.elements[at(first + elements - 1)].link_state;
      for (std::size_t i = 0; i < std::min(end.size(), scales.states.size()); ++i) weigh(end[i], scales.states[i]);
    }
  }

  /// Of each place the first element that has a variable of it; -1 for what belongs to none. What an interval shares
  /// belongs to the last element whose equations speak of it: controls and the speed of time to that of the interval,
  /// a length to its own.
  void find_elements() {
    element_.assign(at(branch_.variables()), no_element);
    is_shared_.assign(element_.size(), false);
    const auto note = [&](int variable, int e) {
      if (const int place = place_[at(variable)]; place >= 0) element_[at(place)] = std::min(element_[at(place)], e);
    };
    for (const auto& range : {chain_.border, chain_.start}) {
      for (int w = range.first; w < range.end(); ++w) note(w, -1);
    }
    for (const auto& [shared, first, elements] : chain_.intervals) {
      for (int w = shared.first; w < shared.end(); ++w) {
        note(w, first);
        if (place_[at(w)] >= 0) is_shared_[at(place_[at(w)])] = true;
      }
      for (int e = first; e < first + elements; ++e) {
        const auto& own = chain_.elements[at(e)].variables;
        for (int w = own.first; w < own.end(); ++w) note(w, e);
      }
    }
    row_element_.assign(at(rows_.rows()), no_element);
    for (int row = 0; row < rows_.rows(); ++row) {
      if (is_active_[at(row)]) find_element(row);
    }
  }

  /// Of an equation the last element whose own variables it has.
  void find_element(int row) {
    int last = -1;
    for (const linalg::Entry entry : rows_.along(row)) {
      const auto place = at(entry.inner);
      if (!is_shared_[place] && element_[place] != no_element) last = std::max(last, element_[place]);
    }
    if (last >= 0) row_element_[at(row)] = last;
    for (const linalg::Entry entry : rows_.along(row)) {
      const auto place = at(entry.inner);
      if (is_shared_[place] && element_[place] >= 0) element_[place] = std::max(element_[place], last);
    }
  }

  /// What is behind the start of element e: numbers of unknowns, of the states there, and what is held.
  void mark(int k, int e, int states) {
    first_element_ = chain_.intervals[at(k)].first_element;
    next_element_ = e;
    const std::size_t n = element_.size();
    unknown_.assign(n, -1);
    state_.assign(n, -1);
    is_held_.assign(n, false);
    unknowns_ = 0;
    const auto& left = chain_.elements[at(e - 1)];
    for (std::size_t i = 0; i < left.link_state.size(); ++i) {
      const int place = place_[at(left.link_state[i])];
      if (place < 0) continue;
      is_held_[at(place)] = true;
      if (static_cast<int>(i) < states) state_[at(place)] = static_cast<int>(i);
    }
    for (const int variable : left.link_multipliers) {
      if (place_[at(variable)] >= 0) is_held_[at(place_[at(variable)])] = true;
    }
    for (std::size_t p = 0; p < n; ++p) {
      if (element_[p] >= e && !is_fixed_[p] && !is_held_[p]) {
        unknown_[p] = unknowns_++;
      } else if (element_[p] < 0 || is_fixed_[p] || is_shared_[p]) {
        is_held_[p] = true;
      }
    }
  }

  void add_hessian(std::vector<linalg::Triplet>& entries, linalg::View right) const {
    for (const auto& entry : hessian_) {
      const int row = unknown_[at(entry.row)];
      if (row < 0) continue;
      if (const int column = unknown_[at(entry.column)]; column >= 0) entries.push_back({row, column, entry.value});
      if (const int state = state_[at(entry.column)]; state >= 0) right(row, state) -= entry.value;
    }
    for (int i = 0; i < unknowns_; ++i) entries.push_back({i, i, diagonal_shift});
  }

  /// Those that speak of unknowns, of the states at the start and of what is held only. @return the size of the
  /// conditions
  linalg::Index add_rows(std::vector<linalg::Triplet>& entries, linalg::View right) const {
    int next = unknowns_;
    for (int row = 0; row < rows_.rows(); ++row) {
      if (!is_active_[at(row)] || !is_behind(row)) continue;
      for (const linalg::Entry entry : rows_.along(row)) {
        const auto place = at(entry.inner);
        if (const int column = unknown_[place]; column >= 0) {
          entries.push_back({next, column, entry.value});
          entries.push_back({column, next, entry.value});
        } else if (state_[place] >= 0) {
          right(next, state_[place]) -= entry.value;
        }
      }
      entries.push_back({next, next, -diagonal_shift});
      ++next;
    }
    return next;
  }

  [[nodiscard]] bool is_behind(int row) const {
    // What is past in this interval has its controls, too.
    if (row_element_[at(row)] >= first_element_ && row_element_[at(row)] < next_element_) return false;
    bool has_unknown = false;
    for (const linalg::Entry entry : rows_.along(row)) {
      const auto place = at(entry.inner);
      if (unknown_[place] < 0 && !is_held_[place]) return false;
      has_unknown = has_unknown || unknown_[place] >= 0;
    }
    return has_unknown;
  }

  const mpcc::Chain& chain_;
  crossover::BranchProblem branch_;
  const std::vector<int>& place_;
  RowMatrix rows_;
  std::vector<linalg::Triplet> hessian_;  ///< both triangles
  std::vector<bool> is_active_, is_fixed_;
  std::vector<int> element_, row_element_;
  std::vector<bool> is_shared_;  ///< by the elements of an interval
  // Of the element under way, by place.
  std::vector<int> unknown_, state_;
  std::vector<bool> is_held_;
  int unknowns_ = 0, first_element_ = 0, next_element_ = 0;
};

}  // namespace

std::vector<linalg::Matrix> feedback_gains(mpcc::Problem& problem, const Solution& solution, int controls, int states,
                                           const std::optional<TrackingScales>& scales) {
  if (problem.chain() == nullptr || !solution.w.all_finite()) return {};
  problem.without_method_terms();
  problem.relaxed_by(0.0);
  Conditions conditions(problem, solution, scales);
  const auto& chain = *problem.chain();
  std::vector<linalg::Matrix> gains(chain.elements.size());
  for (std::size_t k = 0; k < chain.intervals.size(); ++k) {
    const int first = chain.intervals[k].first_element, count = scales ? chain.intervals[k].elements : 1;
    for (int e = first; e < first + count; ++e) {
      gains[at(e)] =
          e == 0 ? linalg::Matrix::zero(controls, states) : conditions.gain(static_cast<int>(k), e, controls, states);
    }
  }
  return gains;
}

}  // namespace saltus::solver
