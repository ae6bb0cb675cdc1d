#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <limits>
#include <random>
#include <string_view>

#include <gtest/gtest.h>

#include "saltus/expression/parser.hpp"
#include "tree_tools.hpp"

namespace saltus::expression {
namespace {

struct TextCase {
  std::string text, written;
};

void expect_texts(std::initializer_list<TextCase> cases) {
  for (const auto& [text, written] : cases) {
    const auto tree = parse(text, {}, {"road"});
    ASSERT_TRUE(tree) << to_text(tree.error());
    EXPECT_EQ(to_text(**tree), written);
  }
}

TEST(ToText, leaves_out_spaces) {
  expect_texts({{"  v - 0.20 ", "v-0.20"},
                {"a -\n\t( b + c )", "a-(b+c)"},
                {"((a)) * (b*c)", "(a)*(b*c)"},
                {"max( a , b+1 )", "max(a,b+1)"},
                {"a>0  and  not(b<1)", "a>0 and not (b<1)"},
                {"x - 1e-9", "x-1e-9"},
                {"x - 1e6 - 0.50", "x-1e6-0.50"},
                {"1E5 + 100000", "1E5+100000"},
                {"6.02e+23", "6.02e+23"},
                {"- x ^ - 2", "-x^-2"},
                {"road ( x )", "road(x)"},
                {"1.5e-300 + 1e300 + .5 + 5.", "1.5e-300+1e300+.5+5."}});
}

TEST(ToText, encloses_what_needs_it) {
  const auto name = [](const char* text) { return std::make_shared<const Node>(Node{Name{text}, {}, false}); };
  const auto binary = [](BinaryOperator op, NodePtr left, NodePtr right) {
    return std::make_shared<const Node>(Node{Binary{op, std::move(left), std::move(right)}, {}, false});
  };
  const auto sum = binary(BinaryOperator::add, name("b"), name("c"));
  EXPECT_EQ(to_text(*binary(BinaryOperator::subtract, name("a"), sum)), "a-(b+c)");
  EXPECT_EQ(to_text(*binary(BinaryOperator::subtract, sum, name("a"))), "b+c-a");
  const auto square = binary(BinaryOperator::power, number(-2.0, {}), number(2.0, {}));
  EXPECT_EQ(to_text(*square), "(-2)^2");
  EXPECT_EQ(to_text(*binary(BinaryOperator::power, square, number(-0.5, {}))), "((-2)^2)^-0.5");
  EXPECT_EQ(to_text(*number(-0.04, {})), "-0.04");
}

TEST(ToText, numbers_read_back_the_same) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 20000; ++i) {
    const std::uint64_t bits = random() >> 1U;  // no sign
    double value = 0.0;
    std::memcpy(&value, &bits, sizeof value);
    if (!std::isfinite(value)) continue;
    const auto text = to_text(*number(value, {}));
    const auto tree = parse(text, {});
    ASSERT_TRUE(tree) << text;
    EXPECT_EQ(std::get<Number>((*tree)->value).value, value) << text;
  }
}

/// Random trees, also ones that need parentheses nobody wrote.
class Generator {
 public:
  NodePtr tree(int height) {
    const bool parenthesised = pick(6) == 0;
    const auto kind = height <= 1 ? pick(2) : pick(6);
    const auto below = [&] { return tree(height - 1); };
    if (kind == 0)
      return make(Number{std::ldexp(static_cast<double>(pick(1000)), static_cast<int>(pick(80)) - 40)}, parenthesised);
    if (kind == 1) return make(Name{std::array{"x", "v", "mu_1", "t", "pi"}[pick(5)]}, parenthesised);
    if (kind == 2) return make(Unary{static_cast<UnaryOperator>(pick(3)), below()}, parenthesised);
    if (kind == 3) {
      const auto& [name, arguments] = functions()[pick(functions().size())];
      Call call{std::string(name), {}};
      for (int i = 0; i < arguments; ++i) call.arguments.push_back(below());
      return make(std::move(call), parenthesised);
    }
    auto left = below();
    return make(Binary{static_cast<BinaryOperator>(pick(13)), std::move(left), below()}, parenthesised);
  }

 private:
  std::size_t pick(std::size_t n) { return static_cast<std::size_t>(random_() % n); }

  template <class Value>
  static NodePtr make(Value value, bool parenthesised) {
    return std::make_shared<const Node>(Node{std::move(value), {}, parenthesised});
  }

  std::mt19937_64 random_{20240601};
};

TEST(ToText, a_difference_to_what_has_a_minus_sign_is_a_sum) {
  const auto text_of = [](std::string_view a, std::string_view b) {
    return difference_text(parse(a, {}).value(), parse(b, {}).value());
  };
  EXPECT_EQ(text_of("x", "y"), "x-y");
  EXPECT_EQ(text_of("x", "y+z"), "x-(y+z)");
  EXPECT_EQ(text_of("u", "-umax"), "u+umax");
  EXPECT_EQ(text_of("x", "-1"), "x+1");
  EXPECT_EQ(text_of("x", "-(y+z)"), "x+(y+z)");
}

TEST(ToText, parsing_gives_the_tree_back) {
  Generator generator;
  for (int i = 0; i < 5000; ++i) {
    const auto tree = generator.tree(1 + i % 6);
    const auto text = to_text(*tree);
    const auto parsed = parse(text, {});
    ASSERT_TRUE(parsed) << text << ": " << to_text(parsed.error());
    ASSERT_TRUE(same_tree(*tree, **parsed, Parentheses::ignored)) << text << " is read as " << shape(**parsed);
    ASSERT_EQ(to_text(**parsed), text);
    ASSERT_EQ(broken_promise(text), "");
  }
}

}  // namespace
}  // namespace saltus::expression
