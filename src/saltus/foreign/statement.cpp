#include "saltus/foreign/statement.hpp"

#include <fmt/format.h>

namespace saltus::foreign {

using casadi::SX;

void add_box(Statement& statement, const SX& side, double lower, double upper, const SX& body,
             const std::string& name) {
  const auto first = static_cast<int>(statement.symbols.size());
  for (const char* part : {"plus", "minus"}) {
    statement.symbols.push_back(SX::sym(fmt::format("{}_{}", part, statement.splits.size())));
    statement.lower.push_back(0.0);
    statement.upper.push_back(infinity);
    statement.start.push_back(0.0);  // Problem::complete knows better
  }
  const SX p = statement.symbols[statement.symbols.size() - 2];
  const SX n = statement.symbols.back();
  statement.rows.push_back({body - p + n, 0.0, 0.0, name});
  statement.pairs.push_back({p, side - lower, name});
  statement.pairs.push_back({n, upper - side, name});
  statement.splits.push_back({body, first});
}

}  // namespace saltus::foreign
