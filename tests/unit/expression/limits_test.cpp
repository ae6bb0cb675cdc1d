#include <string>

#include <gtest/gtest.h>

#include "saltus/expression/parser.hpp"
#include "tree_tools.hpp"

namespace saltus::expression {
namespace {

std::string repeated(std::string_view text, int times) {
  std::string all;
  for (int i = 0; i < times; ++i) all += text;
  return all;
}

/// n levels of something: `before` n times, `core`, `after` n times.
struct Tower {
  std::string before, core, after;
  int highest;
  [[nodiscard]] std::string text(int levels) const { return repeated(before, levels) + core + repeated(after, levels); }
};

// The last one passes through every level of precedence on its way down: the deepest stack there is. Five nodes a
// level.
const Tower towers[] = {
    {"(", "x", ")", 200}, {"-", "x", "", 200},     {"+-", "x", "", 100},       {"not ", "x", "", 200},
    {"2^", "2", "", 200}, {"sin(", "x", ")", 200}, {"if(a,", "b", ",c)", 200}, {"a or b and c<d+e*(", "x", ")", 199}};

TEST(Limits, towers_of_up_to_200_levels) {
  for (const auto& tower : towers) {
    SCOPED_TRACE(tower.before);
    EXPECT_EQ(broken_promise(tower.text(tower.highest)), "");
    const auto allowed = parse(tower.text(tower.highest), {});
    EXPECT_TRUE(allowed) << to_text(allowed.error());
    for (const int levels : {201, 3000}) {
      const auto refused = parse(tower.text(levels), {});
      ASSERT_FALSE(refused) << levels;
      EXPECT_NE(refused.error().message.find("nested deeper than 200"), std::string::npos) << refused.error().message;
    }
  }
}

TEST(Limits, long_chains) {
  for (const auto* link : {"+a", "*a", "-a", " and a"}) {
    EXPECT_EQ(broken_promise("a" + repeated(link, 999)), "") << link;
    EXPECT_TRUE(parse("a" + repeated(link, 999), {})) << link;
    for (const int links : {1000, 8000}) {
      const auto refused = parse("a" + repeated(link, links), {});
      ASSERT_FALSE(refused) << link << links;
      EXPECT_NE(refused.error().message.find("chain of more than 1000"), std::string::npos) << refused.error().message;
    }
  }
  EXPECT_FALSE(parse("a" + repeated("+a", 32767), {}));
}

TEST(Limits, grouping_is_the_remedy_for_a_long_sum) {
  const auto group = "+(a" + repeated("+a", 900) + ")";
  EXPECT_TRUE(parse("0" + repeated(group, 30), {}));
}

TEST(Limits, text_size) {
  const std::string name(65536, 'x');
  EXPECT_TRUE(parse(name, {}));
  const auto refused = parse(name + "x", {"model.toml", 4, 2});
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("65537 bytes"), std::string::npos);
  EXPECT_EQ(refused.error().location.line, 4);
  EXPECT_EQ(refused.error().location.column, 2);
}

TEST(Limits, many_arguments_are_an_error_like_others) {
  EXPECT_FALSE(parse("max(a" + repeated(",a", 30000) + ")", {}));
}

}  // namespace
}  // namespace saltus::expression
