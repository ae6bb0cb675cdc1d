#include <cmath>
#include <string_view>
#include <type_traits>
#include <unordered_set>
#include <utility>

#include <fmt/format.h>

#include "saltus/expression/grammar_internal.hpp"
#include "saltus/expression/parser.hpp"

namespace saltus::expression {
namespace {

template <class... Fs>
struct overloaded : Fs... {
  using Fs::operator()...;
};
template <class... Fs>
overloaded(Fs...) -> overloaded<Fs...>;  // still needed by clang 14

Precedence precedence_of(const Node& node) {
  if (node.parenthesised) return Precedence::primary;
  return std::visit(overloaded{
                        // Only a tree made by number() can hold a negative one.
                        [](const Number& x) { return std::signbit(x.value) ? Precedence::sign : Precedence::primary; },
                        [](const Name&) { return Precedence::primary; },
                        [](const Unary& x) {
                          return x.op == UnaryOperator::logical_not ? Precedence::logical_not : Precedence::sign;
                        },
                        [](const Binary& x) { return grammar_of(x.op).precedence; },
                        [](const Call&) { return Precedence::primary; },
                    },
                    node.value);
}

/// Shortest decimal text that reads back as the same double; 1e-9, not 1e-09.
/// Never inlined: it would enlarge the frames of the recursion.
[[gnu::noinline]] std::string number_text(double value) {
  std::string text = fmt::format("{}", value);
  const auto exponent = text.find('e');
  if (exponent == std::string::npos) return text;
  const bool negative = text[exponent + 1] == '-';
  const auto digits = text.find_first_not_of("+-0", exponent + 1);
  return text.substr(0, exponent) + (negative ? "e-" : "e") + text.substr(digits);
}

enum class Spacing { tight, spaced };

class Writer {
 public:
  explicit Writer(Spacing spacing) : spaced_(spacing == Spacing::spaced) {}

  /// Appends the node, in parentheses if they were written or if `loosest` binds tighter than the node does.
  void write(const Node& node, Precedence loosest) {
    const bool enclosed = node.parenthesised || precedence_of(node) < loosest;
    if (enclosed) text_ += '(';
    std::visit([this](const auto& value) { write_value(value); }, node.value);
    if (enclosed) text_ += ')';
  }

  std::string take() { return std::move(text_); }

 private:
  void write_value(const Number& number) {
    text_ += number.spelling.empty() ? number_text(number.value) : number.spelling;
  }

  void write_value(const Name& name) { text_ += name.name; }

  void write_value(const Unary& unary) {
    switch (unary.op) {
      case UnaryOperator::minus:
        text_ += '-';
        return write(*unary.operand, Precedence::sign);
      case UnaryOperator::plus:
        text_ += '+';
        return write(*unary.operand, Precedence::sign);
      case UnaryOperator::logical_not:
        text_ += "not ";
        return write(*unary.operand, Precedence::logical_not);
    }
  }

  void write_value(const Binary& binary) {
    const auto& grammar = grammar_of(binary.op);
    write(*binary.left, left_operand(grammar));
    const bool is_word =
        grammar.precedence <= Precedence::logical_and || (spaced_ && grammar.precedence <= Precedence::sum);
    if (is_word) text_ += ' ';
    text_ += grammar.text;
    if (is_word) text_ += ' ';
    // A sign needs no parentheses on the right, however tight the operator: 2^-1.
    const bool signed_right = precedence_of(*binary.right) == Precedence::sign;
    write(*binary.right, signed_right ? Precedence::sign : right_operand(grammar));
  }

  void write_value(const Call& call) {
    text_ += call.function;
    text_ += '(';
    for (std::size_t i = 0; i < call.arguments.size(); ++i) {
      if (i > 0) text_ += spaced_ ? ", " : ",";
      write(*call.arguments[i], Precedence::logical_or);
    }
    text_ += ')';
  }

  std::string text_;
  bool spaced_ = false;
};

/// The names of an expression, each once, in their order.
class NameCollector {
 public:
  void collect(const Node& node) {
    std::visit(overloaded{
                   [](const Number&) {},
                   [&](const Name& name) {
                     if (known_.insert(name.name).second) names_.push_back(name.name);
                   },
                   [&](const Unary& unary) { collect(*unary.operand); },
                   [&](const Binary& binary) {
                     collect(*binary.left);
                     collect(*binary.right);
                   },
                   [&](const Call& call) {
                     for (const auto& argument : call.arguments) collect(*argument);
                   },
               },
               node.value);
  }
  [[nodiscard]] std::vector<std::string> take() { return std::move(names_); }

 private:
  std::vector<std::string> names_;
  std::unordered_set<std::string_view> known_;  ///< in the nodes
};

}  // namespace

std::string to_text(const Node& node) {
  Writer writer(Spacing::tight);
  writer.write(node, Precedence::logical_or);
  return writer.take();
}

std::string to_spaced_text(const Node& node) {
  Writer writer(Spacing::spaced);
  writer.write(node, Precedence::logical_or);
  return writer.take();
}

std::vector<std::string> names_in(const Node& node) {
  NameCollector collector;
  collector.collect(node);
  return collector.take();
}

NodePtr number(double value, const SourceLocation& location) {
  return std::make_shared<const Node>(Node{Number{value}, location, false});
}

std::string difference_text(const NodePtr& a, const NodePtr& b) {
  const auto* unary = std::get_if<Unary>(&b->value);
  const bool is_negative = unary != nullptr && unary->op == UnaryOperator::minus;
  Node difference;
  difference.value =
      is_negative ? Binary{BinaryOperator::add, a, unary->operand} : Binary{BinaryOperator::subtract, a, b};
  return to_text(difference);
}

NodePtr unreadable(const SourceLocation& location) {
  return std::make_shared<const Node>(Node{Name{}, location, false});
}

}  // namespace saltus::expression
