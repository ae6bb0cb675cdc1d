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

std::vector<ActiveSide> Problem::freed(const std::vector<ActiveSide>& sides, ConstVectorView w, double paid) {
  linalg::Vector c(rows());
  functions(w, c);
  std::vector<ActiveSide> changed = sides;
  for (std::size_t pair = 0; pair < sides.size(); ++pair) {
    const bool is_G = sides[pair] == ActiveSide::G;
    const double value = c[constraints() + static_cast<int>(pair) + (is_G ? 0 : pairs())];
    if (value > paid) changed[pair] = is_G ? ActiveSide::H : ActiveSide::G;
  }
  return changed;
}

std::vector<BranchMove> Problem::neighbours(const std::vector<ActiveSide>& sides, ConstVectorView w,
                                            const Multipliers& multipliers) {
  static_cast<void>(sides);
  static_cast<void>(w);
  static_cast<void>(multipliers);
  return {};
}

}  // namespace saltus::mpcc
