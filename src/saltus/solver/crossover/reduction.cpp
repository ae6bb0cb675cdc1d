#include "saltus/solver/crossover/reduction.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <unordered_set>

#include "saltus/base/at.hpp"
#include "saltus/base/components.hpp"

namespace saltus::solver::crossover {
namespace {

using mpcc::ActiveSide;
using mpcc::Sign;

constexpr double no_bound = std::numeric_limits<double>::infinity();

/// Variables that are held, and those that are equal.
class Holding {
 public:
  explicit Holding(const mpcc::Problem& problem)
      : bounds_(problem.variable_bounds()),
        equal_(at(problem.variables())),
        hold_(at(problem.variables()), Hold::free),
        value_(linalg::Vector::zero(problem.variables())) {
    for (int i = 0; i < problem.variables(); ++i) {
      if (bounds_.lower[i] == bounds_.upper[i]) set(i, Hold::bounds, bounds_.lower[i]);
    }
  }

  void set(int variable, Hold why, double value) {
    if (hold_[at(variable)] == Hold::bounds || !std::isfinite(value)) return;
    hold_[at(variable)] = why;
    value_[variable] = value;
  }
  /// The first of the variables that are equal to this one.
  [[nodiscard]] int root(int variable) { return static_cast<int>(equal_.first(at(variable))); }
  void make_equal(int i, int j) { equal_.join(at(i), at(j)); }

  /// Whoever is equal to a held variable is held at the same value.
  void spread() {
    for (int i = 0; i < value_.size(); ++i) {
      const int top = root(i);
      if (hold_[at(i)] != Hold::free && hold_[at(top)] == Hold::free) set(top, Hold::closure, value_[i]);
    }
    for (int i = 0; i < value_.size(); ++i) {
      const int top = root(i);
      if (hold_[at(i)] == Hold::free && hold_[at(top)] != Hold::free) set(i, Hold::closure, value_[top]);
    }
  }
  [[nodiscard]] const std::vector<Hold>& hold() const { return hold_; }
  [[nodiscard]] const linalg::Vector& value() const { return value_; }

 private:
  const mpcc::Bounds& bounds_;
  Components equal_;
  std::vector<Hold> hold_;
  linalg::Vector value_;
};

void hold_closure(Holding& holding, const mpcc::Bounds& bounds, const mpcc::BranchClosure& closure,
                  const mpcc::BranchClosure::Freedom& freedom) {
  for (const auto* at_lower : {&closure.at_lower, &freedom.at_lower}) {
    for (const int i : *at_lower) holding.set(i, Hold::closure, bounds.lower[i]);
  }
  for (const auto* at_upper : {&closure.at_upper, &freedom.at_upper}) {
    for (const int i : *at_upper) holding.set(i, Hold::closure, bounds.upper[i]);
  }
  for (const auto& [i, j] : closure.equal) holding.make_equal(i, j);
}

/// An implied side is zero if and only if all its variables are at the bounds that it measures distances from.
void hold_side(Holding& holding, const mpcc::Bounds& bounds, const RowMatrix& jacobian, int row) {
  for (const linalg::Entry entry : jacobian.along(row)) {
    const int variable = entry.inner;
    if (entry.value > 0.0) holding.set(variable, Hold::side, bounds.lower[variable]);
    if (entry.value < 0.0) holding.set(variable, Hold::side, bounds.upper[variable]);
  }
}

/// Whether side G (or H) of the pair is a zero one.
bool is_zero_side(ActiveSide side, ActiveSide which) { return side == which || side == ActiveSide::biactive; }

/// The same function has the same value and derivatives, to the bit; pairs of one element share their sides.
class SeenRows {
 public:
  bool is_new(const RowMatrix& jacobian, const linalg::Vector& c, int row) {
    std::uint64_t sum = 14695981039346656037ull;
    const auto add = [&sum](double value) {
      std::uint64_t bits = 0;
      std::memcpy(&bits, &value, sizeof bits);
      sum = (sum ^ bits) * 1099511628211ull + (sum >> 29);
    };
    add(c[row]);
    for (const linalg::Entry entry : jacobian.along(row)) {
      add(static_cast<double>(entry.inner));
      add(entry.value);
    }
    return seen_.insert(sum).second;
  }

 private:
  std::unordered_set<std::uint64_t> seen_;
};

void place_variables(Holding& holding, const mpcc::Bounds& bounds, Reduction& reduction) {
  const int n = static_cast<int>(bounds.lower.size());
  reduction.hold = holding.hold();
  reduction.value = holding.value();
  reduction.place.assign(at(n), -1);
  std::vector<double> lower;
  std::vector<double> upper;
  for (int i = 0; i < n; ++i) {
    if (reduction.hold[at(i)] != Hold::free) continue;
    const int top = holding.root(i);  // never above i: it has its place already
    if (top == i) {
      reduction.place[at(i)] = reduction.variables();
      reduction.leader.push_back(i);
      lower.push_back(bounds.lower[i]);
      upper.push_back(bounds.upper[i]);
      continue;
    }
    const int place = reduction.place[at(i)] = reduction.place[at(top)];
    lower[at(place)] = std::max(lower[at(place)], bounds.lower[i]);
    upper[at(place)] = std::min(upper[at(place)], bounds.upper[i]);
  }
  reduction.bounds.lower = linalg::ConstView(lower);
  reduction.bounds.upper = linalg::ConstView(upper);
}

/// Takes rows one by one, leaves out those without free variables.
class RowList {
 public:
  RowList(const RowMatrix& jacobian, Reduction& reduction) : jacobian_(jacobian), reduction_(reduction) {}

  void add(int row, double lower, double upper) {
    for (const linalg::Entry entry : jacobian_.along(row)) {
      if (reduction_.place[at(entry.inner)] < 0) continue;
      reduction_.rows.push_back(row);
      lower_.push_back(lower);
      upper_.push_back(upper);
      return;
    }
  }
  void finish() {
    reduction_.row_bounds.lower = linalg::ConstView(lower_);
    reduction_.row_bounds.upper = linalg::ConstView(upper_);
  }

 private:
  const RowMatrix& jacobian_;
  Reduction& reduction_;
  std::vector<double> lower_;
  std::vector<double> upper_;
};

}  // namespace

int Reduction::equations() const {
  int count = 0;
  for (linalg::Index row = 0; row < row_bounds.lower.size(); ++row) {
    if (row_bounds.lower[row] == row_bounds.upper[row]) ++count;
  }
  return count;
}

Reduction reduce(const mpcc::Problem& problem, const std::vector<ActiveSide>& sides, const RowMatrix& jacobian,
                 const linalg::Vector& c, Closing closing) {
  const int n_g = problem.constraints();
  const int pairs = problem.pairs();
  const auto& bounds = problem.variable_bounds();
  const mpcc::BranchClosure closure = problem.close_branch(sides);
  Holding holding(problem);
  const auto freedom = closing == Closing::whole ? closure.freedom : mpcc::BranchClosure::Freedom{};
  hold_closure(holding, bounds, closure, freedom);

  std::vector<int> zero_rows;
  std::vector<int> other_rows;
  for (int side = 0; side < 2 * pairs; ++side) {
    const int pair = side % pairs;
    if (problem.pair_group(pair) < 0 || sides[at(pair)] == ActiveSide::none) continue;
    const bool is_zero = is_zero_side(sides[at(pair)], side < pairs ? ActiveSide::G : ActiveSide::H);
    const bool is_implied = problem.signs()[at(side)] == Sign::implied;
    if (is_zero && is_implied) hold_side(holding, bounds, jacobian, n_g + side);
    if (!is_implied) (is_zero ? zero_rows : other_rows).push_back(n_g + side);
  }
  holding.spread();

  Reduction reduction;
  place_variables(holding, bounds, reduction);
  std::vector<bool> is_dropped(at(n_g), false);
  for (const int row : closure.dropped_rows) is_dropped[at(row)] = true;
  RowList list(jacobian, reduction);
  for (int row = 0; row < n_g; ++row) {
    const double lower = problem.constraint_bounds().lower[row];
    const double upper = problem.constraint_bounds().upper[row];
    const bool is_bounded = std::isfinite(lower) || std::isfinite(upper);
    if (!is_dropped[at(row)] && is_bounded) list.add(row, lower, upper);
  }
  for (const int row : freedom.rows) list.add(row, 0.0, 0.0);
  SeenRows seen;
  for (const int row : zero_rows) {
    if (seen.is_new(jacobian, c, row)) list.add(row, 0.0, 0.0);
  }
  for (const int row : other_rows) {
    if (seen.is_new(jacobian, c, row)) list.add(row, 0.0, no_bound);
  }
  list.finish();
  return reduction;
}

}  // namespace saltus::solver::crossover
