// The binary operators of the expression language, once: for the parser, for to_text and for the messages.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include "saltus/expression/syntax_tree.hpp"

namespace saltus::expression {

/// Says how tightly an expression holds together, loosest first.
enum class Precedence { logical_or, logical_and, logical_not, comparison, sum, product, sign, power, primary };

[[nodiscard]] constexpr Precedence tighter(Precedence precedence) {
  return static_cast<Precedence>(static_cast<int>(precedence) + 1);
}

struct BinaryGrammar {
  BinaryOperator op;
  std::string_view text;
  Precedence precedence;
};

/// In the order of the enumerators of BinaryOperator.
inline constexpr std::array binary_operators{
    BinaryGrammar{BinaryOperator::add, "+", Precedence::sum},
    BinaryGrammar{BinaryOperator::subtract, "-", Precedence::sum},
    BinaryGrammar{BinaryOperator::multiply, "*", Precedence::product},
    BinaryGrammar{BinaryOperator::divide, "/", Precedence::product},
    BinaryGrammar{BinaryOperator::power, "^", Precedence::power},
    BinaryGrammar{BinaryOperator::less, "<", Precedence::comparison},
    BinaryGrammar{BinaryOperator::less_equal, "<=", Precedence::comparison},
    BinaryGrammar{BinaryOperator::greater, ">", Precedence::comparison},
    BinaryGrammar{BinaryOperator::greater_equal, ">=", Precedence::comparison},
    BinaryGrammar{BinaryOperator::equal, "==", Precedence::comparison},
    BinaryGrammar{BinaryOperator::not_equal, "!=", Precedence::comparison},
    BinaryGrammar{BinaryOperator::logical_and, "and", Precedence::logical_and},
    BinaryGrammar{BinaryOperator::logical_or, "or", Precedence::logical_or},
};

[[nodiscard]] constexpr const BinaryGrammar& grammar_of(BinaryOperator op) {
  return binary_operators[static_cast<std::size_t>(op)];
}

[[nodiscard]] constexpr bool is_table_in_enumerator_order() {
  for (const auto& row : binary_operators) {
    if (grammar_of(row.op).text != row.text) return false;
  }
  return true;
}
static_assert(is_table_in_enumerator_order());

/// Returns the loosest left operand that needs no parentheses: 2^3^4 is 2^(3^4), a<b<c is nothing.
[[nodiscard]] constexpr Precedence left_operand(const BinaryGrammar& grammar) {
  const bool chains_to_the_left =
      grammar.precedence != Precedence::power && grammar.precedence != Precedence::comparison;
  return chains_to_the_left ? grammar.precedence : tighter(grammar.precedence);
}

/// Returns the loosest right operand that needs no parentheses; signs are welcome besides (2^-1, a*-b).
[[nodiscard]] constexpr Precedence right_operand(const BinaryGrammar& grammar) {
  return grammar.precedence == Precedence::power ? Precedence::power : tighter(grammar.precedence);
}

}  // namespace saltus::expression
