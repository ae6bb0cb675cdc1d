#include <bit>
#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>

#include "saltus/report/packed_rows_internal.hpp"
#include "saltus/report/packing_internal.hpp"

namespace saltus::report {
namespace {

using nlohmann::json;

json ascending(int from, int until) {
  json list = json::array();
  for (int i = from; i < until; ++i) list.push_back(i);
  return list;
}

TEST(Packing, LongArraysOfNumbersLeaveTheJson) {
  json values = ascending(0, 30);
  values[3] = nullptr;
  const Packed packed = pack({{"t", values}, {"short", {1, 2}}, {"names", json::array({"a"})}});
  EXPECT_EQ(packed.skeleton["t"], (json{{"$n", {0, 30}}}));
  EXPECT_EQ(packed.skeleton["short"], (json{1, 2}));
  EXPECT_EQ(packed.skeleton["names"], json::array({"a"}));
  ASSERT_EQ(packed.numbers.size(), 30U);
  EXPECT_TRUE(std::isnan(packed.numbers[3]));
  EXPECT_EQ(packed.numbers[29], 29.0);
}

TEST(Packing, ManyObjectsBecomeColumns) {
  json events = json::array();
  for (int i = 0; i < 5000; ++i) {
    events.push_back(
        {{"t", i}, {"kind", i % 2 == 0 ? "jump" : "start"}, {"x", {i, -i}}, {"reason", std::to_string(i)}});
  }
  const Packed packed = pack({{"events", events}});
  const json& rows = packed.skeleton["events"];
  EXPECT_EQ(rows["$rows"], 5000);
  EXPECT_EQ(rows["columns"]["t"]["$n"][1], 5000);
  EXPECT_EQ(rows["columns"]["kind"]["of"], (json::array({"jump", "start"})));
  EXPECT_EQ(rows["columns"]["x"]["$table"], 2);
  EXPECT_EQ(rows["columns"]["reason"][4999], "4999");
  const std::size_t first = rows["columns"]["x"]["of"]["$n"][0];
  EXPECT_EQ(packed.numbers[first + 7], -3.0);
}

TEST(Packing, RowsAreKeptAsTheyAreWhereNoShorterFormFitsAllOfThem) {
  json list = json::array();
  for (int i = 0; i < 3000; ++i) {
    // Numbers, then a text; arrays of one length, then a longer one; more texts than there are codes.
    list.push_back({{"a", i < 2000 ? json(i) : json("late")},
                    {"b", i < 2500 ? json({i, 2 * i}) : json({i, i, i})},
                    {"c", std::to_string(i)},
                    {"d", i % 3 == 0 ? json(nullptr) : json(0.5 * i)}});
  }
  PackedRows rows;
  for (const json& row : list) rows.add(row);
  json taken = rows.take();
  const auto columns = taken["columns"];
  EXPECT_EQ(columns["a"][1999], 1999);
  EXPECT_EQ(columns["a"][2999], "late");
  EXPECT_EQ(columns["b"][7], json({7, 14}));
  EXPECT_EQ(columns["b"][2999].size(), 3U);
  EXPECT_EQ(columns["c"][2999], "2999");
  const Packed packed = pack({{"rows", list}}), again = pack({{"rows", std::move(taken)}});
  EXPECT_EQ(packed.skeleton, again.skeleton);
  EXPECT_EQ(packed.numbers.size(), 3000U);
  EXPECT_TRUE(std::isnan(packed.numbers[3]));
  EXPECT_EQ(packed.numbers[4], 2.0);
}

TEST(Packing, ObjectsThatDifferInTheirKeysStay) {
  json list = json::array();
  for (int i = 0; i < 40; ++i) list.push_back(i == 20 ? json{{"b", 1}} : json{{"a", 1}});
  EXPECT_EQ(pack(list).skeleton, list);
}

TEST(Packing, BytesOfOnePlaceStandTogether) {
  const std::string bytes = shuffled_bytes({1.0, -2.0});
  ASSERT_EQ(bytes.size(), 16U);
  // 1.0 is 3FF0…, -2.0 is C000…; the highest byte stands last.
  EXPECT_EQ(static_cast<unsigned char>(bytes[14]), 0x3FU);
  EXPECT_EQ(static_cast<unsigned char>(bytes[15]), 0xC0U);
  EXPECT_EQ(static_cast<unsigned char>(bytes[12]), 0xF0U);
}

TEST(Packing, Base64HasItsPadding) {
  // Deflate of nothing is one empty fixed block: 03 00.
  EXPECT_EQ(deflated_base64(""), "AwA=");
  for (const std::size_t size : {1U, 2U, 3U, 100U, 100000U}) {
    const std::string text = deflated_base64(std::string(size, 'x'));
    EXPECT_EQ(text.size() % 4, 0U);
    EXPECT_LT(text.size(), 200U + size / 100);
  }
}

}  // namespace
}  // namespace saltus::report
