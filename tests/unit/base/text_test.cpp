#include "saltus/base/text.hpp"

#include <cmath>
#include <cstddef>

#include <gtest/gtest.h>

namespace saltus {
namespace {

TEST(Text, IsTrimmedOfTheseBlanksOnly) {
  EXPECT_EQ(trimmed("  a b "), "a b");
  EXPECT_EQ(trimmed("\ta "), "\ta");
  EXPECT_EQ(trimmed("\ta \r", " \t\r"), "a");
  EXPECT_EQ(trimmed("   "), "");
  EXPECT_EQ(trimmed(""), "");
}

TEST(Text, HasOnePieceMoreThanSeparators) {
  EXPECT_EQ(split("a,,b,", ','), (std::vector<std::string_view>{"a", "", "b", ""}));
  EXPECT_EQ(split("", ','), (std::vector<std::string_view>{""}));
}

TEST(Text, IsANumberAsAWholeOrNone) {
  EXPECT_EQ(whole_text_as<double>("-2.5e-3"), -2.5e-3);
  EXPECT_TRUE(std::isnan(whole_text_as<double>("nan").value_or(0.0)));
  EXPECT_EQ(whole_text_as<long>("-7"), -7);
  for (const auto* none : {"", " 1", "1 ", "1e", "+1", "1e999", "one"}) {
    EXPECT_FALSE(whole_text_as<double>(none)) << none;
  }
  EXPECT_FALSE(whole_text_as<std::size_t>("-1"));
  EXPECT_FALSE(whole_text_as<long>("1.5"));
  EXPECT_EQ(whole_text_as<double>(without_plus("+1")), 1.0);
  EXPECT_FALSE(whole_text_as<double>(without_plus("++1")));
}

}  // namespace
}  // namespace saltus
