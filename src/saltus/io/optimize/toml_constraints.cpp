// Constraints of [optimize]: comparisons of expressions, which are split here and parsed side by side.
#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/text.hpp"
#include "saltus/expression/parser.hpp"
#include "saltus/io/constant_value_internal.hpp"
#include "saltus/io/optimize/toml_optimize_internal.hpp"
#include "saltus/io/toml/toml_words_internal.hpp"

namespace saltus::io {
namespace {

using model::Relation;

struct Spelling {
  std::string_view text;
  Relation relation;
};
constexpr std::array relations{Spelling{"<=", Relation::less_equal}, Spelling{">=", Relation::greater_equal},
                               Spelling{"==", Relation::equal}};

/// What looks like a relation of a constraint and is none, longer ones first.
struct Wrong {
  std::string_view text;
  std::string_view remedy;
};
constexpr std::array wrong_signs{
    Wrong{"!=", "a constraint holds where two sides are equal or one is larger: write <=, >= or =="},
    Wrong{"=<", "write <="},
    Wrong{"=>", "write >="},
    Wrong{"<", "write <=: a solution may lie on the edge of what is allowed"},
    Wrong{">", "write >=: a solution may lie on the edge of what is allowed"},
    Wrong{"=", "write == for an equation"},
};
constexpr std::array wrong_words{
    Wrong{"and", "all constraints hold together: write each as an entry of its own"},
    Wrong{"or", "constraints hold all together; a choice between two is a pair of path_complementarities"},
    Wrong{"not", "turn the comparison round"},
};

const std::vector<std::pair<std::string, model::ConstraintNorm>> norms{
    {"l1", model::ConstraintNorm::l1}, {"l2", model::ConstraintNorm::l2}, {"linf", model::ConstraintNorm::linf}};

constexpr std::string_view expected_constraint = "a constraint in quotes, e.g. \"q <= 3\"";

bool is_of_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '.'; }

/// Where a relation stands, or the end of the text.
struct Cut {
  std::size_t offset, length;
};

/// Splits one text at the relations outside of all parentheses.
class ConstraintReader {
 public:
  ConstraintReader(TomlReader& reader, const TomlString& text) : reader_(reader), string_(text), text_(text.text) {}

  model::ConstraintDescription read() {
    const auto begin = std::min(text_.find_first_not_of(" \t\r\n"), text_.size());
    constraint_.location = place_in_string(string_, begin);
    constraint_.text = trimmed(text_, " \t\r\n");
    scan();
    check_relations();
    if (!reader_.failed()) parse_sides();
    return std::move(constraint_);
  }

 private:
  void scan() {
    std::size_t at = 0;
    int depth = 0;
    while (at < text_.size() && !reader_.failed()) {
      const char c = text_[at];
      if (is_of_word(c)) {
        at = word(at, depth);
        continue;
      }
      depth += c == '(' ? 1 : c == ')' ? -1 : 0;
      at += depth > 0 ? 1 : sign(at);
    }
    cuts_.push_back({text_.size(), 0});
  }

  /// Behind the word or number that begins here.
  std::size_t word(std::size_t begin, int depth) {
    auto end = begin;
    while (end < text_.size() && is_of_word(text_[end])) ++end;
    const auto found = text_.substr(begin, end - begin);
    if (depth > 0) return end;
    for (const auto& wrong : wrong_words) {
      if (wrong.text == found)
        fail(fmt::format("a constraint is one comparison, without '{}'", found), wrong.remedy, begin);
    }
    return end;
  }

  /// Length of the relation that begins here, else 1.
  std::size_t sign(std::size_t begin) {
    const auto rest = text_.substr(begin);
    for (const auto& [spelling, relation] : relations) {
      if (!rest.starts_with(spelling)) continue;
      cuts_.push_back({begin, spelling.size()});
      constraint_.relations.push_back(relation);
      return spelling.size();
    }
    for (const auto& [spelling, remedy] : wrong_signs) {
      if (!rest.starts_with(spelling)) continue;
      fail(fmt::format("'{}' is no relation of a constraint; there are <=, >= and ==", spelling), remedy, begin);
      has_wrong_sign_ = true;
      break;
    }
    return 1;
  }

  void check_relations() {
    if (has_wrong_sign_) return;
    const auto& found = constraint_.relations;
    if (found.empty()) {
      const bool inside = text_.find_first_of("<>=") != std::string_view::npos;
      fail(fmt::format("the constraint '{}' has no comparison{}", constraint_.text,
                       inside ? " outside of parentheses" : ""),
           inside ? "remove the parentheses around the comparison"
                  : "write e.g. \"q <= 3\", \"v == 0\" or \"-1 <= u <= 1\"",
           0);
    } else if (found.size() > 2) {
      fail(fmt::format("expected one comparison or two, found {} in '{}'", found.size(), constraint_.text),
           "write several constraints", cuts_[2].offset);
    } else if (found.size() == 2 && (found[0] != found[1] || found[0] == Relation::equal)) {
      fail(fmt::format("the two comparisons of '{}' do not bound one expression from both sides", constraint_.text),
           "write a <= e <= b, or two constraints", cuts_[1].offset);
    }
  }

  void parse_sides() {
    std::size_t begin = 0;
    for (const auto& cut : cuts_) {
      const auto side = text_.substr(begin, cut.offset - begin);
      if (side.find_first_not_of(" \t\r\n") == std::string_view::npos) {
        const bool behind = begin > 0;
        fail(fmt::format("nothing stands {} a comparison of '{}'", behind ? "behind" : "before", constraint_.text),
             "write an expression on both sides", behind ? begin - 1 : cut.offset);
        return;
      }
      auto tree = reader_.expression_in(string_, begin, side.size());
      if (tree == nullptr) return;
      check_side(*tree);
      constraint_.sides.push_back(std::move(tree));
      begin = cut.offset + cut.length;
    }
  }

  /// A side is a number: comparisons stand in conditions of if() only.
  void check_side(const expression::Node& node) {
    if (const auto* call = std::get_if<expression::Call>(&node.value)) {
      const bool skip = call->function == "if" && !call->arguments.empty();
      for (std::size_t i = skip ? 1 : 0; i < call->arguments.size(); ++i) check_side(*call->arguments[i]);
    } else if (const auto* unary = std::get_if<expression::Unary>(&node.value)) {
      if (unary->op == expression::UnaryOperator::logical_not) truth(node.location);
      check_side(*unary->operand);
    } else if (const auto* binary = std::get_if<expression::Binary>(&node.value)) {
      if (binary->op >= expression::BinaryOperator::less) truth(node.location);
      check_side(*binary->left);
      check_side(*binary->right);
    }
  }

  void truth(const SourceLocation& location) {
    reader_.fail({ErrorCode::parse_failure,
                  fmt::format("a side of the constraint '{}' is true or false, not a number", constraint_.text),
                  "comparisons inside a side belong into if(condition, a, b)",
                  location,
                  {}});
  }

  void fail(std::string message, std::string_view remedy, std::size_t offset) {
    reader_.fail(
        {ErrorCode::parse_failure, std::move(message), std::string(remedy), place_in_string(string_, offset), {}});
  }

  TomlReader& reader_;
  const TomlString& string_;
  std::string_view text_;
  std::vector<Cut> cuts_;
  bool has_wrong_sign_ = false;
  model::ConstraintDescription constraint_;
};

model::ConstraintDescription read_text(TomlReader& reader, const TomlValue& value) {
  const auto* text = std::get_if<TomlString>(&value.value);
  if (text != nullptr) return ConstraintReader(reader, *text).read();
  reader.wrong_type(expected_constraint, value);
  return {};
}

/// { constraint = "v == 0", penalty = 1e3, norm = "l1" }.
model::ConstraintDescription read_soft(TomlReader& reader, const TomlValue& value, const TomlTable& table) {
  model::ConstraintDescription constraint;
  expression::NodePtr penalty;
  auto norm = model::ConstraintNorm::l1;
  for (const auto& entry : table) {
    if (entry.key == "constraint") {
      constraint = read_text(reader, entry.value);
    } else if (entry.key == "penalty") {
      penalty = reader.expression(entry.value);
      const auto number = penalty ? constant_value(*penalty) : std::nullopt;
      if (number && !(*number > 0.0)) {
        reader.fail({ErrorCode::invalid_option,
                     fmt::format("penalty: expected a number > 0, found {}", *number),
                     "a constraint without penalty is hard: write it as a string alone",
                     entry.value.location,
                     {}});
      }
    } else if (entry.key == "norm") {
      norm = read_enum(reader, entry.value, norms, norm);
    } else {
      reader.unknown_key(entry, {"constraint", "penalty", "norm"});
    }
  }
  if (constraint.sides.empty() || penalty == nullptr) {
    reader.fail({ErrorCode::parse_failure,
                 fmt::format("this table has no `{}`", constraint.sides.empty() ? "constraint" : "penalty"),
                 "write { constraint = \"v == 0\", penalty = 1e3, norm = \"l1\" }",
                 value.location,
                 {}});
  }
  constraint.penalty = std::move(penalty);
  constraint.norm = norm;
  return constraint;
}

}  // namespace

std::vector<model::ConstraintDescription> read_constraints(TomlReader& reader, const TomlEntry& entry) {
  std::vector<model::ConstraintDescription> list;
  const auto* array = std::get_if<TomlArray>(&entry.value.value);
  if (array == nullptr) {
    reader.wrong_type("a list of constraints, e.g. [\"q <= 3\"]", entry.value);
    return list;
  }
  for (const auto& value : *array) {
    const auto* table = std::get_if<TomlTable>(&value.value);
    list.push_back(table != nullptr ? read_soft(reader, value, *table) : read_text(reader, value));
  }
  return list;
}

}  // namespace saltus::io
