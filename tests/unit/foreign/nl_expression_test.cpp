// Every operator of .nl texts: value and derivatives.
#include <cmath>
#include <functional>
#include <vector>

#include "../mpcc/derivative_check.hpp"
#include "nl_text.hpp"

namespace saltus::foreign {
namespace {

constexpr double va = 0.7, vb = 1.9;  // v0, v1 in all of the cases

struct OperatorCase {
  const char* expression;  ///< lines, separated by blanks
  double value;
};

std::string lines_of_words(std::string words) {
  std::replace(words.begin(), words.end(), ' ', '\n');
  return words + "\n";
}

void expect_value(const std::string& expression, double value) {
  const auto problem = parsed(nl_objective(2, lines_of_words(expression)));
  ASSERT_NE(problem, nullptr) << expression;
  const auto w = point({va, vb});
  EXPECT_NEAR(problem->objective(w), value, 1e-14 * (1.0 + std::abs(value))) << expression;
  mpcc::expect_correct_derivatives(*problem, w);
}

TEST(NlExpression, Arithmetic) {
  for (const auto& [expression, value] : std::vector<OperatorCase>{
           {"o0 v0 v1", va + vb},
           {"o1 v0 v1", va - vb},
           {"o2 v0 v1", va * vb},
           {"o3 v0 v1", va / vb},
           {"o4 v1 v0", std::fmod(vb, va)},
           {"o5 v0 v1", std::pow(va, vb)},
           {"o5 v0 n2", va * va},
           {"o5 n2 v0", std::pow(2.0, va)},
           {"o6 v1 v0", vb - va},
           {"o6 v0 v1", 0.0},
           {"o16 v0", -va},
           {"o54 3 v0 v1 n2", va + vb + 2.0},
           {"o54 1 v0", va},
           {"o76 v0 n3.5", std::pow(va, 3.5)},
           {"o77 v0", va * va},
           {"o78 n3.5 v0", std::pow(3.5, va)},
           {"o2 s3 v0", 3.0 * va},
           {"o2 l-70000 v0", -70000.0 * va},
           {"o2 n1e-2 v0", 0.01 * va},
           {"o1 o2 v0 o0 v1 n1 o16 v1", va * (vb + 1.0) + vb},
       }) {
    expect_value(expression, value);
  }
}

TEST(NlExpression, Functions) {
  for (const auto& [expression, value] : std::vector<OperatorCase>{
           {"o37 v0", std::tanh(va)},
           {"o38 v0", std::tan(va)},
           {"o39 v0", std::sqrt(va)},
           {"o40 v0", std::sinh(va)},
           {"o41 v0", std::sin(va)},
           {"o42 v0", std::log10(va)},
           {"o43 v0", std::log(va)},
           {"o44 v0", std::exp(va)},
           {"o45 v0", std::cosh(va)},
           {"o46 v0", std::cos(va)},
           {"o47 v0", std::atanh(va)},
           {"o48 v0 v1", std::atan2(va, vb)},
           {"o49 v0", std::atan(va)},
           {"o50 v0", std::asinh(va)},
           {"o51 v0", std::asin(va)},
           {"o52 v1", std::acosh(vb)},
           {"o53 v0", std::acos(va)},
           {"o15 o16 v0", va},
           {"o11 3 v0 v1 n9", va},
           {"o12 2 v0 v1", vb},
           {"o13 v1", 1.0},
           {"o14 v1", 2.0},
           {"o55 v1 v0", 2.0},
           {"o55 o16 v1 v0", -2.0},
           {"o56 n1234.5 n2", 1200.0},
           {"o57 n1.256 n2", 1.26},
           {"o57 n-1.256 n1", -1.3},
           {"o58 n1.256 n2", 1.25},
           {"o58 n-1.29 n1", -1.2},
       }) {
    expect_value(expression, value);
  }
}

TEST(NlExpression, Conditions) {
  for (const auto& [expression, value] : std::vector<OperatorCase>{
           {"o35 o22 v0 v1 v0 v1", va},
           {"o35 o22 v1 v0 v0 v1", vb},
           {"o35 o23 v0 v0 v0 v1", va},
           {"o35 o24 v0 v1 v0 v1", vb},
           {"o35 o28 v0 v1 v0 v1", vb},
           {"o35 o29 v1 v0 v0 v1", va},
           {"o35 o30 v1 v0 v0 v1", va},
           {"o35 o34 o30 v1 v0 v0 v1", vb},
           {"o35 o20 o22 v1 v0 o22 v0 v1 v0 v1", va},
           {"o35 o21 o22 v1 v0 o22 v0 v1 v0 v1", vb},
           {"o35 n1 v0 v1", va},
           {"o35 o70 3 o22 v0 v1 n1 n1 v0 v1", va},
           {"o35 o71 3 o22 v1 v0 n0 n0 v0 v1", vb},
           {"o35 o72 o22 v0 v1 n0 n1 v0 v1", vb},
           {"o35 o73 n0 o22 v1 v0 v0 v1", va},
           {"o35 o74 3 v0 v1 n1 v0 v1", va},
           {"o35 o75 3 v0 v1 v0 v0 v1", va},
           {"o59 3 o22 v0 v1 o22 v1 v0 n1", 2.0},
           {"o60 4 n1 n1 n2 n1", 2.0},
           {"o35 o62 n2 o59 3 n1 n0 n1 v0 v1", va},
           {"o35 o63 n1 o59 3 n1 n0 n1 v0 v1", vb},
           {"o35 o66 n2 o59 3 n1 n0 n1 v0 v1", va},
           {"o35 o67 n3 o59 3 n1 n0 n1 v0 v1", va},
           {"o35 o68 n2 o59 3 n1 n0 n1 v0 v1", vb},
           {"o35 o69 n2 o59 3 n1 n0 n1 v0 v1", vb},
       }) {
    expect_value(expression, value);
  }
}

TEST(NlExpression, PiecewiseLinearTermsAreZeroAtZero) {
  // Slopes 1, 3, -2 with kinks at -1 and 2.
  const auto problem = parsed(nl_objective(1, lines_of_words("o64 3 n1 n-1 n3 n2 n-2 v0")));
  ASSERT_NE(problem, nullptr);
  for (const auto& [x, value] : {std::pair{0.0, 0.0}, {1.0, 3.0}, {2.0, 6.0}, {3.0, 4.0}, {-1.0, -3.0}, {-2.0, -4.0}}) {
    EXPECT_DOUBLE_EQ(problem->objective(point({x})), value) << x;
  }
  mpcc::expect_correct_derivatives(*problem, point({0.3}));
}

TEST(NlExpression, DefinedExpressionsMayUseEachOther) {
  const auto text = nl_header(2, 0) +
                    "V2 1 0\n1 3\no44\nv0\n"  // exp(v0) + 3 v1
                    "V3 0 0\no2\nv2\nv2\n"
                    "O0 0\no0\nv3\nv2\nb\n3\n3\n";
  const auto problem = parsed(text);
  ASSERT_NE(problem, nullptr);
  const double first = std::exp(va) + 3.0 * vb;
  EXPECT_DOUBLE_EQ(problem->objective(point({va, vb})), first * first + first);
  mpcc::expect_correct_derivatives(*problem, point({va, vb}), 1e-6);
}

TEST(NlExpression, NestingHasNoLimit) {
  std::string expression;
  constexpr int depth = 100000;
  for (int i = 0; i < depth; ++i) expression += "o0\nn1\n";
  const auto problem = parsed(nl_objective(1, expression + "v0\n"));
  ASSERT_NE(problem, nullptr);
  EXPECT_DOUBLE_EQ(problem->objective(point({0.5})), depth + 0.5);
}

}  // namespace
}  // namespace saltus::foreign
