#include <algorithm>
#include <array>

#include "saltus/base/contains.hpp"
#include "saltus/expression/parser.hpp"

namespace saltus::expression {
namespace {

constexpr std::array<std::string_view, 6> reserved_words{"t", "pi", "and", "or", "not", "otherwise"};

bool may_begin_name(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }

}  // namespace

const std::vector<FunctionSignature>& functions() {
  static const std::vector<FunctionSignature> table{
      {"sin", 1},   {"cos", 1},   {"tan", 1},  {"asin", 1},    {"acos", 1}, {"atan", 1},  {"atan2", 2},
      {"sinh", 1},  {"cosh", 1},  {"tanh", 1}, {"exp", 1},     {"log", 1},  {"log10", 1}, {"sqrt", 1},
      {"hypot", 2}, {"pow", 2},   {"step", 1}, {"sign", 1},    {"if", 3},   {"abs", 1},   {"max", 2},
      {"min", 2},   {"floor", 1}, {"mod", 2},  {"initial", 1},
  };
  return table;
}

bool is_reserved(std::string_view name) {
  const auto& table = functions();
  return contains(reserved_words, name) ||
         std::any_of(table.begin(), table.end(), [&](const auto& function) { return function.name == name; });
}

bool is_identifier(std::string_view name) {
  return !name.empty() && may_begin_name(name.front()) &&
         std::all_of(name.begin(), name.end(), [](char c) { return may_begin_name(c) || (c >= '0' && c <= '9'); });
}

}  // namespace saltus::expression
