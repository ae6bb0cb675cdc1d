#include <initializer_list>
#include <string>

#include <gtest/gtest.h>

#include "saltus/expression/parser.hpp"
#include "tree_tools.hpp"

namespace saltus::expression {
namespace {

/// What the user typed, where the finger points, and words that message and remedy must contain.
struct Mistake {
  std::string text;
  int column;
  std::string message, remedy;
};

void expect_explained(const Mistake& mistake) {
  SCOPED_TRACE(mistake.text);
  const auto tree = parse(mistake.text, {"model.toml", 3, 1}, {"road"});
  ASSERT_FALSE(tree) << shape(**tree);
  const Error& error = tree.error();
  EXPECT_EQ(error.location.file, "model.toml");
  EXPECT_EQ(error.location.line, 3);
  EXPECT_EQ(error.location.column, mistake.column) << error.message;
  EXPECT_NE(error.message.find(mistake.message), std::string::npos) << error.message;
  EXPECT_NE(error.remedy.find(mistake.remedy), std::string::npos) << error.remedy;
  const bool is_name = error.code == ErrorCode::unknown_name;
  EXPECT_EQ(is_name, mistake.message.starts_with("unknown function"));
  EXPECT_TRUE(is_name || error.code == ErrorCode::parse_failure);
}

void expect_explained(std::initializer_list<Mistake> mistakes) {
  for (const auto& mistake : mistakes) expect_explained(mistake);
}

TEST(Mistakes, names_of_the_model_come_before_those_of_other_languages) {
  const auto remedy = [](const std::string& text) {
    const auto tree = parse(text, {"model.toml", 3, 1}, {"ramps"}, {"gap", "friction"});
    return tree ? std::string() : tree.error().remedy;
  };
  EXPECT_EQ(remedy("ramp(x)"), "did you mean 'ramps'?");
  EXPECT_TRUE(remedy("friction(1 + x)").starts_with("for a product write friction*(…)"));
  EXPECT_EQ(remedy("gap(t)"), "names stand without their time: write gap");
  EXPECT_NE(remedy("force(x)").find("what the gap is"), std::string::npos);
}

TEST(Mistakes, operators_of_other_languages) {
  expect_explained({{"x**2", 2, "'**'", "write '^'"},
                    {"a && b", 3, "'&&'", "write 'and'"},
                    {"a || b", 3, "'||'", "write 'or'"},
                    {"!a", 1, "'!'", "write 'not'"},
                    {"a & b", 3, "'&'", "write 'and'"},
                    {"|x|", 1, "'|'", "abs(x)"},
                    {"if(a = 1, 2, 3)", 6, "'='", "'=='"},
                    {"a => b", 3, "'=>'", "write '>='"},
                    {"a =< b", 3, "'=<'", "write '<='"},
                    {"a > = b", 5, "apart from '>'", "'>='"},
                    {"a <> b", 3, "'<>'", "write '!='"},
                    {"a === b", 3, "'==='", "compare with '=='"},
                    {"a % 2", 3, "'%'", "mod(a, b)"},
                    {"a ? 1 : 2", 3, "'?'", "if(condition"},
                    {"[a + b]", 1, "'['", "parentheses"},
                    {"a//b", 2, "'//'", "floor(a/b)"},
                    {"x'", 2, "''", "[dynamics]"},
                    {"x.y", 2, "'.'", "names consist of"},
                    {"a @ b", 3, "'@'", "no expression contains it"},
                    {"a AND b", 3, "missing operator", "write 'and' in lower case"},
                    {"NOT a", 5, "missing operator", "write 'not' in lower case"}});
}

TEST(Mistakes, numbers) {
  expect_explained({{"1 + 1.2.3", 5, "malformed number '1.2.3'", "one decimal point"},
                    {"1e", 1, "malformed number '1e'", "1e3"},
                    {"2e*x", 1, "malformed number '2e'", "exp(1)"},
                    {"1e+", 1, "malformed number '1e+'", "1e3"},
                    {"1e-5.5*x", 1, "malformed number '1e-5.5'", "decimal point"},
                    {"1e5.5", 1, "malformed number '1e5.5'", "decimal point"},
                    {"1..2", 1, "malformed number '1..2'", "decimal point"},
                    {"0x10", 1, "malformed number '0x10'", "16, not 0x10"},
                    {"1_000", 1, "malformed number '1_000'", "without '_'"},
                    {"1e999", 1, "beyond the range", "units"},
                    {"1e-999", 1, "beyond the range", "units"},
                    {"1,5", 2, "unexpected ','", "1.5"},
                    {"(1,5)", 3, "unexpected ','", "1.5"}});
}

TEST(Mistakes, missing_operators) {
  expect_explained({{"2x", 2, "between '2' and 'x'", "write 2*x"},
                    {"2exp(x)", 2, "between '2' and 'exp'", "write 2*exp"},
                    {"3(x+1)", 2, "between '3' and '('", "write 3*("},
                    {"(a)(b)", 4, "between ')' and '('", "write '*'"},
                    {"a b", 3, "between 'a' and 'b'", "write a*b"},
                    {"sin(a b)", 7, "between 'a' and 'b'", "write a*b"},
                    {"a not b", 3, "'not'", "'and not'"},
                    {"1 if a else 2", 3, "'if'", "if(condition"}});
}

TEST(Mistakes, operands) {
  expect_explained({{"", 1, "empty expression", "write"},
                    {"  \n ", 1, "empty expression", "write"},
                    {"a +", 4, "after '+', found the end", "missing"},
                    {"a + * b", 5, "after '+', found '*'", "missing"},
                    {"* b", 1, "found '*'", "operand"},
                    {"()", 2, "nothing between", "write"},
                    {"a and or b", 7, "after 'and', found 'or'", "missing"},
                    {"a < not b", 5, "'not'", "parentheses"},
                    {"-not b", 2, "'not'", "parentheses"}});
}

TEST(Mistakes, parentheses) {
  expect_explained({{"2*(a + (b)", 11, "missing ')' for the '(' at line 3, column 3", "close"},
                    {"sin(a", 6, "missing ')' for the '(' at line 3, column 4", "close"},
                    {"a + b)", 6, "')' without a '('", "delete"},
                    {"max(a, b", 9, "missing ')' for the '(' at line 3, column 4", "close"},
                    {"((a)", 5, "column 1", "close"}});
}

TEST(Mistakes, comparisons) {
  expect_explained({{"a<b<c", 4, "do not chain", "write 'a<b and b<c'"},
                    {"0 <= x+1 <= 2", 10, "do not chain", "write '0<=x+1 and x+1<=2'"},
                    {"a == b == c", 8, "do not chain", "write 'a==b and b==c'"}});
}

TEST(Mistakes, functions) {
  expect_explained({{"1+sgn(x)", 3, "unknown function 'sgn'", "'sign'"},
                    {"deadzone(x, w)", 1, "unknown function 'deadzone'", "x - min(max(x, -w), w)"},
                    {"hill(x, n)", 1, "unknown function 'hill'", "x^n/(K^n + x^n)"},
                    {"linspace(0, 1, 5)", 1, "unknown function 'linspace'", "times = [0, 1]"},
                    {"heaviside(x)", 1, "unknown function", "'step'"},
                    {"ln(x)", 1, "unknown function 'ln'", "'log'"},
                    {"fabs(x)", 1, "unknown function", "'abs'"},
                    {"arcsin(x)", 1, "unknown function", "'asin'"},
                    {"Sin(x)", 1, "unknown function", "'sin'"},
                    {"sine(x)", 1, "unknown function", "'sin'"},
                    {"raod(x)", 1, "unknown function 'raod'", "'road'"},
                    {"roadd(x)", 1, "unknown function 'roadd'", "'road'"},
                    {"q(t)", 1, "unknown function 'q'", "write q"},
                    {"q(1 + t)", 1, "unknown function 'q'", "sin cos"},
                    {"x(1 + 2)", 1, "unknown function 'x'", "for a product write x*("},
                    {"clamp(x, 0, 1)", 1, "unknown function", "min(max("},
                    {"sin x", 1, "'sin' stands without", "write sin(x)"},
                    {"if x > 0", 1, "'if' stands without", "if(condition, a, b)"},
                    {"road", 1, "'road' stands without", "road(x)"},
                    {"atan2(x)", 1, "'atan2' takes 2 arguments, found 1", "atan2(y, x)"},
                    {"atan(y, x)", 1, "'atan' takes 1 argument, found 2", "atan2(y, x)"},
                    {"max(a, b, c)", 1, "'max' takes 2 arguments, found 3", "max(a, max(b, c))"},
                    {"log(x, 2)", 1, "found 2", "natural logarithm"},
                    {"if(a, b)", 1, "found 2", "if(condition, a, b)"},
                    {"road()", 1, "found 0", "road(x)"},
                    {"sin(x,)", 7, "after ',', found ')'", "missing"}});
}

TEST(Mistakes, foreign_characters) {
  expect_explained({{"a \u2212 b", 3, "'\u2212' (U+2212, minus sign)", "write '-'"},
                    {"a\u00D7b", 2, "(U+00D7, multiplication sign)", "write '*'"},
                    {"a\u00B7b", 2, "(U+00B7, middle dot)", "write '*'"},
                    {"a\u2264b", 2, "(U+2264, less-than or equal to)", "write '<='"},
                    {"x\u00B2", 2, "superscript two", "write '^2'"},
                    {"2*\u03B1", 3, "(U+03B1, Greek letter alpha)", "write 'alpha'"},
                    {"\u03C9", 1, "Greek letter omega", "write 'omega'"},
                    {"\u03A9", 1, "Greek capital letter omega", "ASCII"},
                    {"a\u00A0+ b", 2, "no-break space", "ordinary space"},
                    {"\u4E2D", 1, "(U+4E2D)", "ASCII"},
                    {"\U0001F600", 1, "(U+1F600)", "ASCII"},
                    {"a + \xFF", 5, "byte 0xFF", "UTF-8"},
                    {"a + \xE2\x88", 5, "byte 0xE2", "UTF-8"},
                    {"a + \xC0\x80", 5, "byte 0xC0", "UTF-8"},
                    {"a\x01", 2, "U+0001", "delete"},
                    {std::string("a\0b", 3), 2, "U+0000", "delete"}});
}

TEST(ParserErrors, position_in_a_text_of_several_lines) {
  const auto tree = parse("a +\r\n  b +\n    2x", {"model.toml", 5, 9});
  ASSERT_FALSE(tree);
  EXPECT_EQ(tree.error().location.line, 7);
  EXPECT_EQ(tree.error().location.column, 6);
}

TEST(ParserErrors, the_leftmost_mistake_is_told_first) {
  const auto tree = parse("2x + \u2212 1", {});
  ASSERT_FALSE(tree);
  EXPECT_EQ(tree.error().location.column, 2);
}

TEST(ParserErrors, long_names_are_shortened_in_messages) {
  const auto tree = parse(std::string(10000, 'a') + "(x)", {});
  ASSERT_FALSE(tree);
  EXPECT_LT(to_text(tree.error()).size(), 500U);
}

}  // namespace
}  // namespace saltus::expression
