// Random damage to expressions, always the same: the fuzzer of tests/fuzz in small, run every time.
#include <array>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "tree_tools.hpp"

namespace saltus::expression {
namespace {

constexpr std::array seeds{
    "-q + u - mu*sign(v - 0.2)",
    "if(v>0 and not (w<=1 or x!=2), 4, 1)*sign(v)^2",
    "min(max(x,-1),1) + 2^-1e-3 * road(t)",
    "step(c1)*(1-step(c2)) >= atan2(y, x) / hypot(3., .5)",
    "a == b and (b < c) or otherwise",
    "mod(t, 2*pi) - floor(log10(1e300 + exp(-t)))",
};

constexpr std::array fragments{"(",    ")",        "+",   "-",     "*",     "/",   "^",  "<",  "<=", ">",
                               "==",   "=",        "!=",  "and",   "or",    "not", ",",  " ",  "\n", "1.5",
                               "2e",   "1e9",      "0x1", "x",     "sin",   "if(", "**", "&&", "..", "\xE2\x88\x92",
                               "\xC3", "\xF0\x9F", "e-3", "-not ", "road(", "\t"};

std::string damaged(std::string text, std::mt19937_64& random) {
  const auto pick = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };
  for (auto rounds = 1 + pick(4); rounds > 0; --rounds) {
    const auto place = pick(text.size() + 1);
    switch (pick(5)) {
      case 0:
        text.insert(place, fragments[pick(fragments.size())]);
        break;
      case 1:
        text.erase(place, 1 + pick(3));
        break;
      case 2:
        if (place < text.size()) text[place] = static_cast<char>(pick(256));
        break;
      case 3:
        text.insert(place, text.substr(pick(text.size() + 1), pick(12)));
        break;
      default:
        text.insert(place, seeds[pick(seeds.size())]);
    }
  }
  return text;
}

TEST(Mutations, give_a_tree_or_an_error_with_its_place) {
  std::mt19937_64 random(7);
  int trees = 0;
  for (std::size_t i = 0; i < 20000; ++i) {
    const auto text = damaged(seeds[i % seeds.size()], random);
    ASSERT_EQ(broken_promise(text), "") << text;
    if (parse(text, {}, {"road"})) ++trees;
  }
  // Neither all nor none: the damage must reach both outcomes to mean anything.
  EXPECT_GT(trees, 1000);
  EXPECT_LT(trees, 19000);
}

}  // namespace
}  // namespace saltus::expression
