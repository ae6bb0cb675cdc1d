#include <string>

#include <gtest/gtest.h>

#include "saltus/io/text_stream_internal.hpp"

namespace saltus::io {
namespace {

TEST(TextStream, PassesOnAllInItsOrderAndLittleAtOnce) {
  std::string written, expected;
  int pieces = 0;
  const auto sink = [&](std::string_view piece) {
    written += piece;
    ++pieces;
    return true;
  };
  TextStream stream(sink);
  for (int line = 0; line < 100'000; ++line) {
    const auto text = std::to_string(line) + "\n";
    stream.text() += text;
    expected += text;
    EXPECT_TRUE(stream.pass());
  }
  EXPECT_LT(pieces, 5);
  EXPECT_TRUE(stream.flush());
  EXPECT_EQ(written, expected);
  EXPECT_TRUE(stream.flush());  // nothing more
  EXPECT_EQ(written, expected);
}

TEST(TextStream, AsksASinkThatRefusedNothingMore) {
  int asked = 0;
  const auto sink = [&](std::string_view) {
    ++asked;
    return false;
  };
  TextStream stream(sink);
  EXPECT_TRUE(stream.flush());  // nothing to write
  for (int k = 0; k < 3; ++k) {
    stream.text() += "line\n";
    EXPECT_FALSE(stream.flush());
    EXPECT_FALSE(stream.pass());
  }
  EXPECT_EQ(asked, 1);
}

}  // namespace
}  // namespace saltus::io
