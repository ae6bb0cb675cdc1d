#include "saltus/expression/latex.hpp"

#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "saltus/expression/parser.hpp"

namespace saltus::expression {
namespace {

std::string latex_of_text(const std::string& text) {
  const auto tree = parse(text, {});
  return tree ? to_latex(**tree) : tree.error().message;
}

TEST(Latex, WritesExpressions) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"a+b*c", "a + b \\, c"},
      {"(a+b)*c", "\\left(a + b\\right) \\, c"},
      {"a-(b-c)", "a - \\left(b - c\\right)"},
      {"(a+b)/(c*d)", "\\frac{a + b}{c \\, d}"},
      {"x^2", "{x}^{2}"},
      {"(-x)^(n+1)", "{\\left(-x\\right)}^{n + 1}"},
      {"-(a+b)", "-\\left(a + b\\right)"},
      {"2*3", "2 \\cdot 3"},
      {"1.5e-3*x", "1.5 \\cdot 10^{-3} \\, x"},
      {"sqrt(abs(x))*sign(x)", "\\sqrt{\\left|x\\right|} \\, \\operatorname{sign}\\left(x\\right)"},
      {"max(sin(t), 0)", "\\max\\left(\\sin\\left(t\\right), 0\\right)"},
      {"if(x > 0 and not y <= 1, 1, -1)",
       "\\begin{cases} 1 & x > 0 \\wedge \\neg y \\le 1 \\\\ -1 & \\text{else} \\end{cases}"},
      {"a/b^2", "\\frac{a}{{b}^{2}}"},
      {"(a/b)^2", "{\\left(\\frac{a}{b}\\right)}^{2}"},
  };
  for (const auto& [text, latex] : cases) EXPECT_EQ(latex_of_text(text), latex) << text;
}

TEST(Latex, WritesNames) {
  EXPECT_EQ(latex_name("x"), "x");
  EXPECT_EQ(latex_name("x12"), "x_{12}");
  EXPECT_EQ(latex_name("omega_ref"), "\\omega_{\\mathrm{ref}}");
  EXPECT_EQ(latex_name("q_1"), "q_{1}");
  EXPECT_EQ(latex_name("belt"), "\\mathrm{belt}");
  EXPECT_EQ(latex_name("k_on_off"), "k_{\\mathrm{on\\_off}}");
  EXPECT_EQ(latex_name("_a"), "\\mathrm{\\_a}");
}

}  // namespace
}  // namespace saltus::expression
