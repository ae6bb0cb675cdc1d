#include "saltus/mpcc/problem.hpp"

#include <fmt/format.h>

namespace saltus::mpcc {

linalg::Vector Problem::start() const {
  const Bounds& bounds = variable_bounds();
  return linalg::Vector::zero(variables()).at_least(bounds.lower).at_most(bounds.upper);
}

std::string Problem::name(int variable) const { return fmt::format("w[{}]", variable); }

std::string Problem::row_name(int row) const {
  if (row < constraints()) return fmt::format("g[{}]", row);
  const int side = row - constraints();
  return side < pairs() ? fmt::format("G[{}]", side) : fmt::format("H[{}]", side - pairs());
}

BranchClosure Problem::close_branch(const std::vector<ActiveSide>& sides) const {
  static_cast<void>(sides);
  return {};
}

std::vector<BranchMove> Problem::neighbours(const std::vector<ActiveSide>& sides, ConstVectorView w,
                                            const Multipliers& multipliers) {
  static_cast<void>(sides);
  static_cast<void>(w);
  static_cast<void>(multipliers);
  return {};
}

}  // namespace saltus::mpcc
