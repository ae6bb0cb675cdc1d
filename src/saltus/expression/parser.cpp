#include "saltus/expression/parser.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/contains.hpp"
#include "saltus/expression/complaints_internal.hpp"
#include "saltus/expression/grammar_internal.hpp"
#include "saltus/expression/lexer_internal.hpp"
#include "saltus/expression/limits_internal.hpp"

namespace saltus::expression {
namespace {

/// A tree under construction; shared because NodePtr is, but nobody else holds it yet.
struct Parsed {
  std::shared_ptr<Node> node;
  int height = 1;  ///< nodes on the longest way down
};

const BinaryGrammar* as_binary_operator(const Token& token) {
  if (token.kind != TokenKind::symbol && token.kind != TokenKind::name) return nullptr;
  const auto found = std::find_if(binary_operators.begin(), binary_operators.end(),
                                  [&](const auto& grammar) { return grammar.text == token.text; });
  return found == binary_operators.end() ? nullptr : &*found;
}

/// Written without parentheses of its own, so that a second comparison would chain to it.
bool is_open_comparison(const Node& node) {
  const auto* binary = std::get_if<Binary>(&node.value);
  return binary && !node.parenthesised && grammar_of(binary->op).precedence == Precedence::comparison;
}

/// Operator precedence parser (V. R. Pratt, Top down operator precedence, POPL 1973).
/// `level` counts what nests: parentheses, calls, signs, nots and exponents.
/// The functions that recurse return nothing on failure and leave the Error with the complaints: a dozen Errors that
/// each of them might return would make their frames ten times larger.
class Parser {
 public:
  Parser(const Tokens& tokens, const std::string& file, const std::vector<std::string>& extra_functions,
         const std::vector<std::string>& declared)
      : tokens_(tokens), complain_{tokens, file}, extra_functions_(extra_functions), declared_(declared) {}

  Expected<NodePtr> run() {
    auto whole = parse_whole();
    if (!whole) return tl::unexpected(complain_.take());
    return NodePtr(std::move(whole->node));
  }

 private:
  const Token& current() const { return tokens_.list[position_]; }
  bool at_symbol(std::string_view text) const { return current().is(TokenKind::symbol, text); }
  const Token& take() { return tokens_.list[position_++]; }

  std::optional<Parsed> parse_whole() {
    if (current().kind == TokenKind::end) return complain_.empty(current());
    auto whole = parse_binary(Precedence::logical_or, 0);
    if (whole && current().kind != TokenKind::end) return complain_.after_operand(position_, nullptr);
    return whole;
  }

  /// Operands joined by operators that bind at least as tightly as `loosest`.
  std::optional<Parsed> parse_binary(Precedence loosest, int level) {
    auto left = parse_operand(loosest, level);
    while (left) {
      const auto* grammar = as_binary_operator(current());
      if (!grammar || grammar->precedence < loosest) break;
      left = extend(std::move(*left), *grammar, level);
    }
    return left;
  }

  std::optional<Parsed> extend(Parsed left, const BinaryGrammar& grammar, int level) {
    const Token& token = take();
    auto right = parse_binary(right_operand(grammar), grammar.op == BinaryOperator::power ? level + 1 : level);
    if (!right) return right;
    if (grammar.precedence == Precedence::comparison && is_open_comparison(*left.node)) {
      return complain_.chained_comparison(token, *left.node, *right->node);
    }
    const int height = std::max(left.height, right->height);
    return make(Binary{grammar.op, std::move(left.node), std::move(right->node)}, token, height);
  }

  /// Not inlined into parse_binary, which recurses through all precedences before it comes here.
  [[gnu::noinline]] std::optional<Parsed> parse_operand(Precedence loosest, int level) {
    const Token& token = current();
    if (level > max_nesting) return complain_.too_nested(token);
    if (token.kind == TokenKind::number) return make(Number{token.value, std::string(token.text)}, take(), 0);
    if (at_symbol("-")) return parse_unary(UnaryOperator::minus, Precedence::sign, level);
    if (at_symbol("+")) return parse_unary(UnaryOperator::plus, Precedence::sign, level);
    if (at_symbol("(")) return parse_parenthesised(level);
    if (token.is(TokenKind::name, "not")) {
      if (loosest > Precedence::logical_not) return complain_.misplaced_not(token);
      return parse_unary(UnaryOperator::logical_not, Precedence::logical_not, level);
    }
    if (token.kind == TokenKind::name && !as_binary_operator(token)) return parse_name(level);
    return complain_.missing_operand(position_);
  }

  std::optional<Parsed> parse_unary(UnaryOperator op, Precedence loosest, int level) {
    const Token& token = take();
    auto operand = parse_binary(loosest, level + 1);
    if (!operand) return operand;
    return make(Unary{op, std::move(operand->node)}, token, operand->height);
  }

  std::optional<Parsed> parse_parenthesised(int level) {
    const Token& opening = take();
    auto inner = parse_binary(Precedence::logical_or, level + 1);
    if (!inner) return inner;
    if (!at_symbol(")")) return complain_.after_operand(position_, &opening);
    take();
    inner->node->parenthesised = true;
    return inner;
  }

  std::optional<Parsed> parse_name(int level) {
    const Token& token = take();
    const auto arguments = number_of_arguments(token.text);
    if (at_symbol("(")) {
      if (!arguments) return complain_.unknown_function(position_ - 1, extra_functions_, declared_);
      return parse_call(token, *arguments, level);
    }
    if (arguments && !contains(declared_, token.text)) return complain_.function_without_arguments(token);
    return make(Name{std::string(token.text)}, token, 0);
  }

  std::optional<Parsed> parse_call(const Token& name, int expected, int level) {
    const Token& opening = take();
    Call call{std::string(name.text), {}};
    int height = 0;
    while (call.arguments.empty() ? !at_symbol(")") : at_symbol(",")) {
      if (!call.arguments.empty()) take();
      auto argument = parse_binary(Precedence::logical_or, level + 1);
      if (!argument) return argument;
      height = std::max(height, argument->height);
      call.arguments.push_back(std::move(argument->node));
    }
    if (!at_symbol(")")) return complain_.after_operand(position_, &opening);
    take();
    const int found = static_cast<int>(call.arguments.size());
    if (found != expected) return complain_.wrong_arguments(name, expected, found);
    return make(std::move(call), name, height);
  }

  std::optional<int> number_of_arguments(std::string_view function) const {
    for (const auto& known : functions()) {
      if (known.name == function) return known.arguments;
    }
    const bool extra = contains(extra_functions_, function);
    return extra ? std::optional(1) : std::nullopt;
  }

  /// Never inlined, for the same reason.
  template <class Value>
  [[gnu::noinline]] std::optional<Parsed> make(Value value, const Token& token, int height_below) {
    if (height_below >= max_height) return complain_.too_high(token);
    return Parsed{std::make_shared<Node>(Node{std::move(value), complain_.at(token), false}), height_below + 1};
  }

  const Tokens& tokens_;
  Complaints complain_;
  const std::vector<std::string>& extra_functions_;
  const std::vector<std::string>& declared_;
  std::size_t position_ = 0;
};

}  // namespace

Expected<NodePtr> parse(std::string_view text, const SourceLocation& start,
                        const std::vector<std::string>& extra_functions, const std::vector<std::string>& declared) {
  if (text.size() > max_text_size) {
    return tl::unexpected(Error{ErrorCode::parse_failure,
                                fmt::format("expression of {} bytes; at most {} are read", text.size(), max_text_size),
                                "name parts of it in [definitions]",
                                {start.file, std::max(start.line, 1), std::max(start.column, 1)},
                                {}});
  }
  const Tokens tokens = tokenize(text, start);
  return Parser(tokens, start.file, extra_functions, declared).run();
}

}  // namespace saltus::expression
