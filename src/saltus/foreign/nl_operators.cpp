// The operators of .nl texts. Source: [gay2005]; numbers are those of AMPL's opcode table.
#include <algorithm>
#include <array>

#include "saltus/foreign/nl_expression_internal.hpp"

namespace saltus::foreign {
namespace {

using casadi::SX;
using Operands = std::span<const SX>;

template <SX (*make)(const SX&)>
SX of_one(Operands operands) {
  return make(operands[0]);
}
template <SX (*make)(const SX&, const SX&)>
SX of_two(Operands operands) {
  return make(operands[0], operands[1]);
}
template <SX (*make)(const SX&, const SX&)>
SX of_all(Operands operands) {
  SX value = operands[0];
  for (const auto& next : operands.subspan(1)) value = make(value, next);
  return value;
}

SX truth(const SX& x) { return x != 0.0; }
SX truncated(const SX& x) { return SX::if_else(x < 0.0, SX::ceil(x), SX::floor(x)); }
SX nearest(const SX& x) { return SX::if_else(x < 0.0, SX::ceil(x - 0.5), SX::floor(x + 0.5)); }

SX plus(const SX& a, const SX& b) { return a + b; }
SX minus(const SX& a, const SX& b) { return a - b; }
SX times(const SX& a, const SX& b) { return a * b; }
SX divided(const SX& a, const SX& b) { return a / b; }
SX remainder_of(const SX& a, const SX& b) { return SX::mod(a, b); }
SX power(const SX& a, const SX& b) { return SX::pow(a, b); }
SX excess(const SX& a, const SX& b) { return SX::fmax(a - b, 0.0); }
SX smaller(const SX& a, const SX& b) { return SX::fmin(a, b); }
SX larger(const SX& a, const SX& b) { return SX::fmax(a, b); }
SX whole_quotient(const SX& a, const SX& b) { return truncated(a / b); }
SX with_digits(const SX& x, const SX& digits) {
  const SX size = SX::floor(SX::log10(SX::if_else(x == 0.0, 1.0, SX::abs(x))));
  const SX unit = SX::pow(10.0, size + 1.0 - digits);
  return nearest(x / unit) * unit;
}
SX with_decimals(const SX& x, const SX& decimals) {
  return nearest(x * SX::pow(10.0, decimals)) / SX::pow(10.0, decimals);
}
SX cut_decimals(const SX& x, const SX& decimals) {
  return truncated(x * SX::pow(10.0, decimals)) / SX::pow(10.0, decimals);
}
SX negative(const SX& x) { return -x; }
SX square(const SX& x) { return SX::sq(x); }

SX both(const SX& a, const SX& b) { return SX::logic_and(truth(a), truth(b)); }
SX either(const SX& a, const SX& b) { return SX::logic_or(truth(a), truth(b)); }
SX not_true(const SX& a) { return SX::logic_not(truth(a)); }
SX less(const SX& a, const SX& b) { return a < b; }
SX at_most(const SX& a, const SX& b) { return a <= b; }
SX equal(const SX& a, const SX& b) { return a == b; }
SX at_least(const SX& a, const SX& b) { return a >= b; }
SX greater(const SX& a, const SX& b) { return a > b; }
SX different(const SX& a, const SX& b) { return a != b; }
// "at least a of the statements that b counts", and so on: a is the number, b the count.
SX count_at_least(const SX& a, const SX& b) { return b >= a; }
SX count_at_most(const SX& a, const SX& b) { return b <= a; }
SX count_below(const SX& a, const SX& b) { return b < a; }
SX count_above(const SX& a, const SX& b) { return b > a; }
SX same_truth(const SX& a, const SX& b) { return truth(a) == truth(b); }
SX chosen(Operands o) { return SX::if_else(truth(o[0]), o[1], o[2]); }
SX implied(Operands o) { return SX::if_else(truth(o[0]), truth(o[1]), truth(o[2])); }

SX number_true(Operands operands) {
  SX count = 0.0;
  for (const auto& operand : operands) count += truth(operand);
  return count;
}
SX number_equal(Operands operands) {
  SX count = 0.0;
  for (const auto& operand : operands.subspan(1)) count += operand == operands[0];
  return count;
}
SX all_different(Operands operands) {
  SX value = 1.0;
  for (std::size_t i = 0; i < operands.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) value = SX::logic_and(value, operands[i] != operands[j]);
  }
  return value;
}
SX some_equal(Operands operands) { return SX::logic_not(all_different(operands)); }

constexpr int list = -1;
constexpr std::array operators{
    NlOperator{0, 2, 0, of_two<plus>},
    NlOperator{1, 2, 0, of_two<minus>},
    NlOperator{2, 2, 0, of_two<times>},
    NlOperator{3, 2, 0, of_two<divided>},
    NlOperator{4, 2, 0, of_two<remainder_of>},
    NlOperator{5, 2, 0, of_two<power>},
    NlOperator{6, 2, 0, of_two<excess>},
    NlOperator{11, list, 1, of_all<smaller>},
    NlOperator{12, list, 1, of_all<larger>},
    NlOperator{13, 1, 0, of_one<SX::floor>},
    NlOperator{14, 1, 0, of_one<SX::ceil>},
    NlOperator{15, 1, 0, of_one<SX::abs>},
    NlOperator{16, 1, 0, of_one<negative>},
    NlOperator{20, 2, 0, of_two<either>},
    NlOperator{21, 2, 0, of_two<both>},
    NlOperator{22, 2, 0, of_two<less>},
    NlOperator{23, 2, 0, of_two<at_most>},
    NlOperator{24, 2, 0, of_two<equal>},
    NlOperator{28, 2, 0, of_two<at_least>},
    NlOperator{29, 2, 0, of_two<greater>},
    NlOperator{30, 2, 0, of_two<different>},
    NlOperator{34, 1, 0, of_one<not_true>},
    NlOperator{35, 3, 0, chosen},
    NlOperator{37, 1, 0, of_one<SX::tanh>},
    NlOperator{38, 1, 0, of_one<SX::tan>},
    NlOperator{39, 1, 0, of_one<SX::sqrt>},
    NlOperator{40, 1, 0, of_one<SX::sinh>},
    NlOperator{41, 1, 0, of_one<SX::sin>},
    NlOperator{42, 1, 0, of_one<SX::log10>},
    NlOperator{43, 1, 0, of_one<SX::log>},
    NlOperator{44, 1, 0, of_one<SX::exp>},
    NlOperator{45, 1, 0, of_one<SX::cosh>},
    NlOperator{46, 1, 0, of_one<SX::cos>},
    NlOperator{47, 1, 0, of_one<SX::atanh>},
    NlOperator{48, 2, 0, of_two<SX::atan2>},
    NlOperator{49, 1, 0, of_one<SX::atan>},
    NlOperator{50, 1, 0, of_one<SX::asinh>},
    NlOperator{51, 1, 0, of_one<SX::asin>},
    NlOperator{52, 1, 0, of_one<SX::acosh>},
    NlOperator{53, 1, 0, of_one<SX::acos>},
    NlOperator{54, list, 1, of_all<plus>},
    NlOperator{55, 2, 0, of_two<whole_quotient>},
    NlOperator{56, 2, 0, of_two<with_digits>},
    NlOperator{57, 2, 0, of_two<with_decimals>},
    NlOperator{58, 2, 0, of_two<cut_decimals>},
    NlOperator{59, list, 1, number_true},
    NlOperator{60, list, 1, number_equal},
    NlOperator{62, 2, 0, of_two<count_at_least>},
    NlOperator{63, 2, 0, of_two<count_at_most>},
    NlOperator{66, 2, 0, of_two<equal>},
    NlOperator{67, 2, 0, of_two<count_below>},
    NlOperator{68, 2, 0, of_two<count_above>},
    NlOperator{69, 2, 0, of_two<different>},
    NlOperator{70, list, 1, of_all<both>},
    NlOperator{71, list, 1, of_all<either>},
    NlOperator{72, 3, 0, implied},
    NlOperator{73, 2, 0, of_two<same_truth>},
    NlOperator{74, list, 1, all_different},
    NlOperator{75, list, 1, some_equal},
    NlOperator{76, 2, 0, of_two<power>},
    NlOperator{77, 1, 0, of_one<square>},
    NlOperator{78, 2, 0, of_two<power>},
};

}  // namespace

const NlOperator* nl_operator(long code) {
  const auto has_code = [&](const NlOperator& candidate) { return candidate.code == code; };
  const auto* found = std::find_if(operators.begin(), operators.end(), has_code);
  return found == operators.end() ? nullptr : found;
}

SX piecewise_linear(const std::vector<double>& slopes, const std::vector<double>& breakpoints, const SX& x) {
  SX value = slopes.front() * x;
  for (std::size_t i = 0; i < breakpoints.size(); ++i) {
    const double at_zero = std::max(-breakpoints[i], 0.0);
    value += (slopes[i + 1] - slopes[i]) * (SX::fmax(x - breakpoints[i], 0.0) - at_zero);
  }
  return value;
}

}  // namespace saltus::foreign
