#include "saltus/base/enum_names.hpp"

#include <gtest/gtest.h>

namespace saltus {
namespace {

enum class Side { left, right, top };
constexpr EnumNames<Side::top> sides("left", "right", "at the top");

TEST(EnumNames, AreThoseOfTheValuesInTheirOrder) {
  EXPECT_EQ(sides(Side::left), "left");
  EXPECT_EQ(sides(Side::top), "at the top");
}

TEST(EnumNames, LeadBackToTheValue) {
  for (const Side side : {Side::left, Side::right, Side::top}) EXPECT_EQ(sides.named(sides(side)), side);
  EXPECT_EQ(sides.named("top"), std::nullopt);
  EXPECT_EQ(sides.named(""), std::nullopt);
}

}  // namespace
}  // namespace saltus
