#include "saltus/expression/parser.hpp"

#include <initializer_list>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "tree_tools.hpp"

namespace saltus::expression {
namespace {

NodePtr tree_of(std::string_view text) {
  auto tree = parse(text, {"model.toml", 1, 1}, {"road"});
  if (tree) return *tree;
  ADD_FAILURE() << text << ": " << to_text(tree.error());
  return number(std::numeric_limits<double>::quiet_NaN(), {});
}

std::string shape_of(std::string_view text) { return shape(*tree_of(text)); }

struct ShapeCase {
  std::string text, shape;
};

void expect_shapes(std::initializer_list<ShapeCase> cases) {
  for (const auto& [text, expected] : cases) EXPECT_EQ(shape_of(text), expected) << text;
}

TEST(Shapes, operators) {
  expect_shapes({{"1-2-3", "(subtract (subtract 1 2) 3)"},
                 {"8/4/2", "(divide (divide 8 4) 2)"},
                 {"a*b/c*d", "(multiply (divide (multiply a b) c) d)"},
                 {"a+b*c-d", "(subtract (add a (multiply b c)) d)"},
                 {"2^3^2", "(power 2 (power 3 2))"},
                 {"-2^2", "(minus (power 2 2))"},
                 {"(-2)^2", "(power (minus 2) 2)"},
                 {"2^-1", "(power 2 (minus 1))"},
                 {"2^-x^2", "(power 2 (minus (power x 2)))"},
                 {"2^-1*b", "(multiply (power 2 (minus 1)) b)"},
                 {"-a*b", "(multiply (minus a) b)"},
                 {"a*-b+c", "(add (multiply a (minus b)) c)"},
                 {"a--b", "(subtract a (minus b))"},
                 {"+-+a", "(plus (minus (plus a)))"},
                 {"a < -b + c", "(less a (add (minus b) c))"},
                 {"a+1 <= b*2", "(less_equal (add a 1) (multiply b 2))"},
                 {"a>=b", "(greater_equal a b)"},
                 {"a>b", "(greater a b)"},
                 {"a==b", "(equal a b)"},
                 {"a!=b", "(not_equal a b)"},
                 {"(a<b)==(c<d)", "(equal (less a b) (less c d))"},
                 {"not a < b", "(not (less a b))"},
                 {"not not a", "(not (not a))"},
                 {"a and not b or c", "(or (and a (not b)) c)"},
                 {"a or b and c", "(or a (and b c))"},
                 {"a or b or c", "(or (or a b) c)"},
                 {"not a and b", "(and (not a) b)"},
                 {"(a)and(b)", "(and a b)"},
                 {"a<1 and (b<2 or not (c<3))", "(and (less a 1) (or (less b 2) (not (less c 3))))"}});
}

TEST(Shapes, calls) {
  expect_shapes({{"sin(x)^2", "(power (sin x) 2)"},
                 {"atan2( y , x )", "(atan2 y x)"},
                 {"if(v>0 and not (w<1), 4, -1)*sign(v)",
                  "(multiply (if (and (greater v 0) (not (less w 1))) 4 (minus 1)) (sign v))"},
                 {"max(min(x, 1), -1)", "(max (min x 1) (minus 1))"},
                 {"floor(t) + mod (t, 2)", "(add (floor t) (mod t 2))"},
                 {"road(x)", "(road x)"},
                 {"otherwise", "otherwise"},
                 {"nothing*android", "(multiply nothing android)"}});
}

struct NumberCase {
  std::string text;
  double value;
};

void expect_values(std::initializer_list<NumberCase> cases) {
  for (const auto& [text, value] : cases) {
    const auto tree = tree_of(text);
    ASSERT_TRUE(std::holds_alternative<Number>(tree->value)) << text;
    EXPECT_EQ(std::get<Number>(tree->value).value, value) << text;
  }
}

TEST(Numbers, have_their_value) {
  expect_values({{"0", 0.0},
                 {"007", 7.0},
                 {"0.2", 0.2},
                 {".5", 0.5},
                 {"5.", 5.0},
                 {"1e3", 1000.0},
                 {"1E+3", 1000.0},
                 {"2.5e-3", 2.5e-3},
                 {"1.e2", 100.0},
                 {"5e-324", 5e-324},
                 {"1.7976931348623157e308", 1.7976931348623157e308},
                 {"0.1000000000000000055511151231257827", 0.1}});
}

TEST(Parser, marks_what_was_parenthesised) {
  const auto tree = tree_of("((a+b))*c");
  const auto& product = std::get<Binary>(tree->value);
  EXPECT_FALSE(tree->parenthesised);
  EXPECT_TRUE(product.left->parenthesised);
  EXPECT_FALSE(product.right->parenthesised);
  EXPECT_EQ(to_text(*tree), "(a+b)*c");
}

TEST(Parser, positions_are_those_of_the_own_token) {
  const auto tree = parse("a +\n  sin(b)*c", {"model.toml", 7, 12});
  ASSERT_TRUE(tree);
  const auto& sum = std::get<Binary>((*tree)->value);
  const auto& product = std::get<Binary>(sum.right->value);
  EXPECT_EQ((*tree)->location.file, "model.toml");
  EXPECT_EQ((*tree)->location.line, 7);
  EXPECT_EQ((*tree)->location.column, 14);
  EXPECT_EQ(sum.left->location.column, 12);
  EXPECT_EQ(sum.right->location.line, 8);
  EXPECT_EQ(sum.right->location.column, 9);
  EXPECT_EQ(product.left->location.column, 3);
  EXPECT_EQ(std::get<Call>(product.left->value).arguments[0]->location.column, 7);
  EXPECT_EQ(product.right->location.column, 10);
}

TEST(Parser, unknown_start_counts_from_one) {
  const auto tree = parse(" x", {});
  ASSERT_TRUE(tree);
  EXPECT_EQ((*tree)->location.line, 1);
  EXPECT_EQ((*tree)->location.column, 2);
}

TEST(Parser, names_come_once_and_in_order) {
  const auto names = names_in(*tree_of("if(v>0 or b<1, sin(a)*v, -t^pi)"));
  EXPECT_EQ(names, (std::vector<std::string>{"v", "b", "a", "t", "pi"}));
  EXPECT_TRUE(names_in(*tree_of("1+2")).empty());
}

TEST(Parser, every_function_takes_its_arguments) {
  EXPECT_EQ(functions().size(), 25U);
  for (const auto& [name, arguments] : functions()) {
    std::string text = std::string(name) + "(x";
    for (int i = 1; i < arguments; ++i) text += ",x";
    EXPECT_TRUE(parse(text + ")", {})) << text;
    EXPECT_FALSE(parse(text + ",x)", {})) << text;
    EXPECT_FALSE(parse(std::string(name) + "()", {})) << text;
    EXPECT_FALSE(parse(std::string(name), {})) << text;
    EXPECT_TRUE(is_reserved(name));
    EXPECT_TRUE(is_identifier(name));
  }
}

TEST(Parser, reserved_words_and_identifiers) {
  for (const auto* name : {"t", "pi", "and", "or", "not", "otherwise", "step"}) EXPECT_TRUE(is_reserved(name)) << name;
  for (const auto* name : {"", "T", "tt", "e", "x1", "Sin"}) EXPECT_FALSE(is_reserved(name)) << name;
  for (const auto* name : {"x", "_", "x_1", "Mu2"}) EXPECT_TRUE(is_identifier(name)) << name;
  for (const auto* name : {"", "1x", "a-b", "a b", "\xCE\xBC", "a."}) EXPECT_FALSE(is_identifier(name)) << name;
}

}  // namespace
}  // namespace saltus::expression
