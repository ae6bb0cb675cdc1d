// The syntax tree of the expression language of model files.
#pragma once

#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "saltus/base/error.hpp"

namespace saltus::expression {

struct Node;
/// Immutable and shared: definitions are referred to, not copied.
using NodePtr = std::shared_ptr<const Node>;

enum class UnaryOperator { minus, plus, logical_not };
enum class BinaryOperator {
  add,
  subtract,
  multiply,
  divide,
  power,
  less,
  less_equal,
  greater,
  greater_equal,
  equal,
  not_equal,
  logical_and,
  logical_or,
};

struct Number {
  double value = 0.0;
  std::string spelling{};  ///< as it was written; empty for a number that no text states
};
struct Name {
  std::string name;
};  ///< of a state, a parameter or a definition, or `t`, `pi`, `otherwise`; the model resolves it
struct Unary {
  UnaryOperator op;
  NodePtr operand;
};
struct Binary {
  BinaryOperator op;
  NodePtr left, right;
};
struct Call {
  std::string function;
  std::vector<NodePtr> arguments;
};

struct Node {
  std::variant<Number, Name, Unary, Binary, Call> value;
  SourceLocation location;     ///< of the first character of this (sub)expression's own token
  bool parenthesised = false;  ///< written inside its own pair of parentheses
};

}  // namespace saltus::expression
