#include <fmt/format.h>
#include <gtest/gtest.h>

#include "saltus/io/json/json_document_internal.hpp"

namespace saltus::io {
namespace {

Json document_of(const std::string& text) {
  auto document = parse_document(text, "r.json");
  EXPECT_TRUE(document) << text.substr(0, 80);
  return document.value_or(Json());
}

/// The whole list as a tree.
Json tree_of_list(const Json& list) {
  Json tree = Json::array();
  for_each_piece(list, [&](const Json& piece) {
    for (const auto& entry : piece) tree.push_back(entry.is_binary() ? tree_of_list(entry) : entry);
    return true;
  });
  return tree;
}

std::string numbers(int count) {
  std::string text = "[";
  for (int i = 0; i < count; ++i) text += fmt::format("{}{}.5", i > 0 ? " ,\n" : "", i);
  return text + " ]";
}

TEST(JsonDocument, ShortListsAreInTheTree) {
  const auto document = document_of(R"({"a": [1, [2, "]"]], "b": {"c": [null]}})");
  EXPECT_EQ(document.dump(), R"({"a":[1,[2,"]"]],"b":{"c":[null]}})");
}

TEST(JsonDocument, ALongListStaysTextAndComesInPieces) {
  const std::string text = fmt::format(R"({{"a": {{"b": {0} , "c\"]": 7}}, "d": "e"}} )", numbers(20000));
  const auto document = document_of(text);
  EXPECT_EQ(document["d"], "e");
  EXPECT_EQ(document["a"]["c\"]"], 7);
  const auto& list = document["a"]["b"];
  ASSERT_TRUE(list.is_binary());
  std::size_t pieces = 0;
  double next = 0.5;
  for_each_piece(list, [&](const Json& piece) {
    ++pieces;
    EXPECT_LE(piece.dump().size(), bytes_at_once);
    for (const auto& entry : piece) EXPECT_EQ(entry.get<double>(), next++);
    return true;
  });
  EXPECT_EQ(next, 20000.5);
  EXPECT_GT(pieces, 2U);
}

TEST(JsonDocument, NoMorePiecesThanAreWanted) {
  const std::string text = numbers(20000);
  std::size_t pieces = 0;
  for_each_piece(document_of(text), [&](const Json&) { return ++pieces < 2; });
  EXPECT_EQ(pieces, 2U);
}

TEST(JsonDocument, LongEntriesAreReadByThemselves) {
  const std::string list = numbers(20000);
  const std::string text = fmt::format(R"([1,2,{{"x": {0}}}, [ 3 , "[,\\\",", {{}}], {0} ,4, {{"y": [{0}]}}])", list);
  std::vector<std::string> pieces;
  for_each_piece(document_of(text), [&](const Json& piece) {
    pieces.push_back(piece.front().is_binary()   ? "list"
                     : piece.front().is_object() ? piece.front().begin().key()
                                                 : piece.dump());
    return true;
  });
  EXPECT_EQ(pieces, (std::vector<std::string>{"[1,2]", "x", R"([[3,"[,\\\",",{}]])", "list", "[4]", "y"}));
  EXPECT_EQ(tree_of_list(document_of(text))[4], Json::parse(list));
}

TEST(JsonDocument, WhiteSpaceMakesNoEntries) {
  const std::string space(100000, ' ');
  EXPECT_EQ(tree_of_list(document_of("[" + space + "]")), Json::array());
  EXPECT_EQ(tree_of_list(document_of("[" + space + "1" + space + "," + space + "2" + space + "]")), Json({1, 2}));
  EXPECT_EQ(document_of(space + "{" + space + "}" + space), Json::object());
  EXPECT_EQ(document_of("{" + space + "\"a\"" + space + ":" + space + "1" + space + "}"), Json({{"a", 1}}));
  EXPECT_EQ(document_of(space + "1" + space), 1);
  EXPECT_EQ(document_of("\xEF\xBB\xBF[" + space + "1]"), Json({1})) << "a byte order mark";
}

TEST(JsonDocument, OfTwoMembersOfANameTheLastOneCounts) {
  const std::string text = fmt::format(R"({{"a": {0}, "b": 1, "a": 2}})", numbers(20000));
  EXPECT_EQ(document_of(text).dump(), R"({"a":2,"b":1})");
}

TEST(JsonDocument, WrongSyntaxIsFoundInLongListsToo) {
  const std::string before = "{\n\"a\": " + numbers(20000);
  for (const char* damage : {", \"b\" 1}", ",}", "", "]", "} 1", ", \"b\": 1e999}"}) {
    EXPECT_FALSE(parse_document(before + damage, "r.json")) << damage;
  }
  std::string comma = numbers(20000);
  comma.replace(comma.find("3.5"), 3, "   ");
  const auto refused = parse_document(comma, "r.json");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().location.line, 4);
}

// Neither the depth of the stack nor the time may grow with the square of such a text.
TEST(JsonDocument, ManyObjectsInObjectsAreRead) {
  std::string text;
  for (int i = 0; i < 300000; ++i) text += "{\"a\":";
  text += "1" + std::string(300000, '}');
  EXPECT_TRUE(parse_document(text, "r.json"));
}

}  // namespace
}  // namespace saltus::io
