// What is wrong with a file: each mistake has its own message with the line, what was expected and what was found.
#include <set>
#include <string>
#include <vector>

#include "nl_text.hpp"

namespace saltus::foreign {
namespace {

/// 0 <= x0 _|_ x0 + 2 x1 - 1 >= 0 and 1 <= x0 x1 <= 2; the lines are counted in the cases below.
const std::vector<std::string>& good_lines() {
  static const std::vector<std::string> lines{
      "g3 1 1 0\t# problem good",  // 1
      " 2 2 1 1 0",                // 2
      " 1 1 1 0",                  // 3
      " 0 0",                      // 4
      " 2 2 2",                    // 5
      " 0 0 0 1",                  // 6
      " 0 0 0 0 0",                // 7
      " 4 2",                      // 8
      " 0 0",                      // 9
      " 0 0 0 0 0",                // 10
      "V2 1 0",                    // 11
      "0 1",                       // 12
      "n0.5",                      // 13
      "C0",
      "n-1",  // 14 15
      "C1",
      "o2",
      "v0",
      "v1",  // 16 17 18 19
      "O0 0",
      "o54",
      "3",  // 20 21 22
      "v2",
      "n1",
      "v1",  // 23 24 25
      "x1",
      "0 0.5",  // 26 27
      "r",
      "5 1 1",
      "0 1 2",  // 28 29 30
      "b",
      "2 0",
      "3",  // 31 32 33
      "k1",
      "2",  // 34 35
      "J0 2",
      "0 1",
      "1 2",  // 36 37 38
      "J1 2",
      "0 0",
      "1 0",  // 39 40 41
      "G0 2",
      "0 0",
      "1 1",  // 42 43 44
  };
  return lines;
}

std::string joined(const std::vector<std::string>& lines) {
  std::string text;
  for (const auto& line : lines) text += line + "\n";
  return text;
}

struct Malformed {
  int line;             ///< that is replaced
  const char* text;     ///< by this; empty: taken away
  int place;            ///< line of the message
  const char* message;  ///< a part of it
};

const std::vector<Malformed>& malformed() {
  static const std::vector<Malformed> cases{
      {1, "h3 1 1 0", 1, "neither an AMPL .nl text"},
      {1, "b3 1 1 0", 1, "this .nl file is binary"},
      {1, "g99 1", 1, "expected the number of options from 0 to 9, found 99"},
      {1, "gx", 1, "expected the number of options, a whole number, found 'x'"},
      {2, "2 2", 2, "expected the number of objectives, a whole number, found nothing"},
      {2, "two 2 1", 2, "expected the number of variables, a whole number, found 'two'"},
      {2, "-2 2 1", 2, "expected the number of variables from 1"},
      {2, "0 2 1", 2, "found 0"},
      {2, "2.5 2 1", 2, "found '2.5'"},
      {2, "1000000000 2 1", 2, "promises 1000000000 variables"},
      {2, "2 2 1 0 0 3", 2, "logical constraints are not available"},
      {2, "99999999999999999999 2 1", 2, "found '99999999999999999999'"},
      {5, "2 x 2", 5, "expected a number in line 5 of the header"},
      {7, "1 0 0 0 0", 7, "1 of the variables are binary or integer"},
      {7, "0 0 0 2 1", 7, "3 of the variables are binary or integer"},
      {11, "V1 1 0", 11, "a common expression, behind those of variables"},
      {11, "V2 99 0", 11, "expected the number of linear terms from 0 to"},
      {12, "7 1", 12, "expected a coefficient, an index from 0 to 1, found 7"},
      {12, "0 inf", 12, "an infinite coefficient"},
      {12, "0", 12, "expected a coefficient, a number, found nothing"},
      {13, "n", 13, "expected a constant, a number, found nothing"},
      {13, "nabc", 13, "expected a constant, a number, found 'abc'"},
      {13, "nnan", 13, "expected a constant, a number, found 'nan'"},
      {13, "ninf", 13, "an infinite constant"},
      {14, "C5", 14, "expected the number of a row from 0 to 1, found 5"},
      {14, "C", 14, "expected the number of a row, a whole number, found nothing"},
      {14, "L0", 14, "logical constraints are not available"},
      {14, "Q0", 14, "expected a segment"},
      {16, "C0", 16, "a second segment C0"},
      {17, "o999", 17, "there is no operator o999"},
      {17, "o", 17, "expected the code of an operator"},
      {17, "o2x", 17, "found '2x'"},
      {17, "o61", 17, "operator o61 works on texts"},
      {17, "f0 2", 17, "'f0' calls a function of a library"},
      {17, "h3:abc", 17, "a text in an expression"},
      {17, "?", 17, "expected an expression (o, n, v and a number), found '?'"},
      {17, "o64", 18, "expected the number of slopes of a piecewise linear term"},
      {18, "v7", 18, "v7 is neither one of the 2 variables nor defined"},
      {18, "v-1", 18, "expected the number of a variable from 0"},
      {19, "", 19, "expected an expression (o, n, v and a number), found 'O0'"},
      {20, "O0 2", 20, "the sense of an objective (0 minimise, 1 maximise) from 0 to 1, found 2"},
      {20, "O1 0", 20, "expected the number of a row from 0 to 0, found 1"},
      {22, "0", 22, "expected the number of operands of o54 from 1"},
      {22, "500", 22, "found 500"},
      {26, "x9999", 26, "expected the number of values of the start from 0 to"},
      {27, "5 1", 27, "expected a value of the start, an index from 0 to 1, found 5"},
      {27, "0 -inf", 27, "an infinite value of the start"},
      {29, "5 1 3", 29, "expected the variable of a complementarity from 1 to 2, found 3"},
      {29, "5 4 1", 29, "expected the kind of a complementarity from 0 to 3, found 4"},
      {29, "5 1 2", 29, "complements the lower bound of variable 2, which has none"},
      {29, "5 2 1", 29, "complements the upper bound of variable 1, which has none"},
      {29, "6 1 1", 29, "expected the type of a constraint from 0 to 5, found 6"},
      {30, "0 2 1", 30, "the lower bound 2 is above the upper bound 1"},
      {30, "2 inf", 30, "a lower bound of +infinity"},
      {30, "0 1", 30, "expected an upper bound, a number, found nothing"},
      {30, "", 30, "expected the type of a constraint, a whole number, found 'b'"},
      {32, "5 0", 32, "expected the type of a bound from 0 to 4, found 5"},
      {32, "2 nan", 32, "expected a lower bound, a number, found 'nan'"},
      {35, "-3", 35, "expected the number of entries of a column from 0"},
      {36, "J0 x", 36, "expected the number of linear terms, a whole number, found 'x'"},
      {37, "0 1e999", 37, "found '1e999'"},
      {39, "J0 2", 39, "a second segment J0"},
  };
  return cases;
}

std::string text_with(const Malformed& one) {
  auto lines = good_lines();
  if (*one.text == '\0') {
    lines.erase(lines.begin() + one.line - 1);
  } else {
    lines[static_cast<std::size_t>(one.line - 1)] = one.text;
  }
  return joined(lines);
}

TEST(Malformed, TheGoodOneIsGood) {
  const auto problem = parsed(joined(good_lines()));
  ASSERT_NE(problem, nullptr);
  EXPECT_EQ(problem->objective(point({2.0, 3.0})), 2.0 + 0.5 + 1.0 + 3.0 + 3.0);
  EXPECT_EQ(problem->pairs(), 1);
  EXPECT_EQ(problem->constraints(), 1);
}

TEST(Malformed, EveryMistakeIsToldWithItsLine) {
  std::set<std::string> messages;
  for (const auto& one : malformed()) {
    const auto problem = parse(text_with(one), "wrong.nl");
    ASSERT_FALSE(problem) << one.line << ": " << one.text;
    const auto& error = problem.error();
    EXPECT_NE(error.message.find(one.message), std::string::npos) << to_text(error);
    EXPECT_EQ(error.location.file, "wrong.nl");
    EXPECT_EQ(error.location.line, one.place) << to_text(error);
    messages.insert(to_text(error));
  }
  EXPECT_GE(messages.size(), 50U);
}

TEST(Malformed, SegmentsThatAreMissing) {
  const auto without = [](std::size_t first, std::size_t last) {
    auto lines = good_lines();
    lines.erase(lines.begin() + static_cast<long>(first) - 1, lines.begin() + static_cast<long>(last));
    return joined(lines);
  };
  struct {
    std::size_t first, last;
    const char* message;
  } const cases[] = {{14, 15, "without a segment C0"},
                     {20, 25, "without a segment O0"},
                     {28, 30, "without a segment r"},
                     {31, 33, "without a segment b"},
                     {36, 38, "without 2 of the 4 nonzeros of the Jacobian"},
                     {42, 44, "without 2 of the 2 nonzeros of gradients"},
                     {2, 44, "where line 2 of the header"},
                     {9, 44, "where line 9 of the header"}};
  for (const auto& one : cases) {
    const auto problem = parse(without(one.first, one.last), "wrong.nl");
    ASSERT_FALSE(problem) << one.message;
    EXPECT_NE(problem.error().message.find(one.message), std::string::npos) << to_text(problem.error());
    EXPECT_NE(problem.error().remedy.find("not complete"), std::string::npos);
  }
}

TEST(Malformed, SpecialOrderedSetsAreRefused) {
  auto text = joined(good_lines());
  text += "S0 1 sosno\n0 1\n";
  const auto problem = parse(text, "wrong.nl");
  ASSERT_FALSE(problem);
  EXPECT_EQ(problem.error().code, ErrorCode::not_available);
}

/// A file that was cut: an error, or the whole problem with a note that the last line has no end.
TEST(Malformed, CutAtEveryByte) {
  const auto whole = joined(good_lines());
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const auto problem = parse(whole.substr(0, size), "cut.nl");
    if (!problem) {
      EXPECT_FALSE(problem.error().message.empty());
      continue;
    }
    EXPECT_GE(size, whole.size() - 2) << "taken for a whole file";
    EXPECT_EQ((*problem)->notes().size(), 1U);
  }
}

TEST(Malformed, EveryByteChanged) {
  const auto whole = joined(good_lines());
  for (const char other : {'9', '-', 'o', '\n', '\0', '\xff', ' '}) {
    for (std::size_t i = 0; i < whole.size(); ++i) {
      auto text = whole;
      text[i] = other;
      const auto problem = parse(text, "changed.nl");  // an error or a problem; never anything else
      if (!problem) {
        EXPECT_FALSE(problem.error().message.empty());
      }
    }
  }
}

TEST(Malformed, OtherFiles) {
  for (const char* text :
       {"", " \n \n", "[model]\nname = 'x'\n", "\xff\xfe", "PK\x03\x04", "<html>", "0", "null", "\"g\""}) {
    const auto problem = parse(text, "other");
    ASSERT_FALSE(problem) << text;
    EXPECT_NE(to_text(problem.error()).find("other"), std::string::npos);
  }
}

}  // namespace
}  // namespace saltus::foreign
