#include <algorithm>

#include "saltus/adapters/ipopt/block_solver_internal.hpp"
#include "saltus/linalg/block_order.hpp"

namespace saltus::adapters {
namespace {

/// Where solutions are not exact enough, pivots are compared with their columns more strictly. Ipopt's limit for MUMPS:
/// above, thousands of rows are delayed for no more digits.
constexpr double stricter = 100.0;
constexpr double strictest = 0.1;

}  // namespace

bool BlockSolver::InitializeImpl(const Ipopt::OptionsList& /*options*/, const std::string& /*prefix*/) {
  tolerance_ = linalg::BlockLdl::usual_tolerance;
  is_out_of_date_ = true;
  return true;
}

Ipopt::ESymSolverStatus BlockSolver::InitializeStructure(Ipopt::Index size, Ipopt::Index entries,
                                                         const Ipopt::Index* row, const Ipopt::Index* column) {
  std::vector<int> rows(row, row + entries), columns(column, column + entries);
  for (int& i : rows) --i;
  for (int& j : columns) --j;
  auto blocks = program_.elimination_blocks(size);
  if (rows == rows_ && columns == columns_ && blocks == blocks_) return Ipopt::SYMSOLVER_SUCCESS;
  rows_ = std::move(rows);
  columns_ = std::move(columns);
  blocks_ = std::move(blocks);
  values_.assign(rows_.size(), 0.0);
  const int equations = program_.rows();
  const auto order = blocks_.empty() ? linalg::blocks_by_minimum_degree(size, equations, rows_, columns_)
                                     : linalg::divide_blocks(equations, rows_, columns_, blocks_);
  factors_.analyse(size, rows_, columns_, order);
  return Ipopt::SYMSOLVER_SUCCESS;
}

Ipopt::ESymSolverStatus BlockSolver::MultiSolve(bool is_new, const Ipopt::Index* /*row*/,
                                                const Ipopt::Index* /*column*/, Ipopt::Index right_sides, double* right,
                                                bool checks_negative, Ipopt::Index expected_negative) {
  if (is_new || is_out_of_date_) {
    inertia_ = factors_.factorise(values_, tolerance_);
    is_out_of_date_ = false;
  }
  if (inertia_.zero > 0) return Ipopt::SYMSOLVER_SINGULAR;
  if (checks_negative && inertia_.negative != expected_negative) return Ipopt::SYMSOLVER_WRONG_INERTIA;
  const auto size = static_cast<std::size_t>(inertia_.positive + inertia_.negative);
  for (Ipopt::Index k = 0; k < right_sides; ++k, right += size) factors_.solve({right, size});
  return Ipopt::SYMSOLVER_SUCCESS;
}

bool BlockSolver::IncreaseQuality() {
  if (tolerance_ >= strictest) return false;
  tolerance_ = std::min(strictest, stricter * tolerance_);
  is_out_of_date_ = true;
  return true;
}

}  // namespace saltus::adapters
