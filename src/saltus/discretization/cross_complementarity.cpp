#include "saltus/base/contracts.hpp"
#include "saltus/discretization/element_expressions_internal.hpp"

namespace saltus::discretization {

using casadi::SX;

ElementPairs element_pairs(const std::vector<SelectionPair>& pairs, const ElementVariables& variables,
                           const SX& left_lambda) {
  std::vector<SX> rows;
  for (const auto& pair : pairs) {
    const SX selection = variables.selection(pair.selection, casadi::Slice());
    rows.push_back(pair.complement ? 1.0 - selection : selection);
  }
  return {rows.empty() ? SX(0, variables.selection.size2()) : SX::vertcat(rows),
          SX::horzcat({left_lambda, variables.lambda})};
}

void add_cross_complementarities(CrossComplementarity mode, const ElementPairs& pairs, LocalExpressions& expressions) {
  const casadi_int stages = pairs.a.size2();
  const casadi_int points = pairs.lambda.size2();
  for (casadi_int k = 0; k < pairs.a.size1(); ++k) {
    const SX a = pairs.a(k, casadi::Slice());
    const SX lambda = pairs.lambda(k, casadi::Slice());
    switch (mode) {
      case CrossComplementarity::stage_stage:
        for (casadi_int point = 0; point < points; ++point) {
          for (casadi_int m = 0; m < stages; ++m) expressions.pair(a(m), lambda(point));
        }
        break;
      case CrossComplementarity::fe_stage:
        for (casadi_int point = 0; point < points; ++point) expressions.pair(SX::sum2(a), lambda(point));
        break;
      case CrossComplementarity::stage_fe:
        for (casadi_int m = 0; m < stages; ++m) expressions.pair(a(m), SX::sum2(lambda));
        break;
      case CrossComplementarity::fe_fe:
        expressions.pair(SX::sum2(a), SX::sum2(lambda));
        break;
      case CrossComplementarity::paper:
      case CrossComplementarity::same_stage:
        for (casadi_int m = 0; m < stages; ++m) expressions.pair(a(m), lambda(m + 1));
        break;
    }
  }
}

void add_paper_cross_complementarity(const Boundary& boundary, LocalExpressions& expressions) {
  SX sum = 0.0;
  for (const ElementPairs* element : {&boundary.before, &boundary.after}) {
    for (casadi_int m = 0; m < element->a.size2(); ++m) {
      for (casadi_int point = 0; point < element->lambda.size2(); ++point) {
        if (point == m + 1) continue;
        sum += SX::dot(element->a(casadi::Slice(), m), element->lambda(casadi::Slice(), point));
      }
    }
  }
  // A sum of products that are not negative is zero: as the pair sum _|_ 1 it is relaxed like every other pair.
  expressions.pair(sum, 1.0);
}

}  // namespace saltus::discretization
