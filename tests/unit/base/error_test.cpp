#include "saltus/base/error.hpp"

#include <gtest/gtest.h>

#include "saltus/base/other_words.hpp"
#include "saltus/base/told_together.hpp"

namespace saltus {
namespace {

using Names = std::vector<std::string>;

TEST(ErrorText, place_message_trail_and_remedy) {
  Error error{ErrorCode::parse_failure, "missing ')'", "close it", {"model.toml", 12, 5}, {}};
  error = with_context(with_context(std::move(error), "in dynamics of 'v'"), "in table [dynamics]");
  EXPECT_EQ(to_text(error),
            "model.toml:12:5: error: missing ')'\n  in dynamics of 'v'\n  in table [dynamics]\n  close it");
}

TEST(ErrorText, leaves_out_what_is_unknown) {
  EXPECT_EQ(to_text(Error{ErrorCode::io_failure, "no such file", "", {"a.toml", 0, 0}, {}}),
            "a.toml: error: no such file");
  EXPECT_EQ(to_text(Error{ErrorCode::io_failure, "bad", "", {"a.toml", 3, 0}, {}}), "a.toml:3: error: bad");
  EXPECT_EQ(to_text(Error{ErrorCode::invalid_option, "rtol = -1", "need rtol > 0", {}, {}}),
            "error: rtol = -1\n  need rtol > 0");
}

TEST(ErrorText, is_fit_for_a_terminal) {
  const Error colours{ErrorCode::unknown_name, "unknown key 'a\x1b[31m\n'", "", {"m.toml", 1, 1}, {}};
  EXPECT_EQ(to_text(colours), "m.toml:1:1: error: unknown key 'a\\x1b[31m\\x0a'");
  std::string long_name;
  for (int i = 0; i < 100000; ++i) long_name += "ü";
  const Error endless{ErrorCode::unknown_name, "x" + long_name + "z", "", {}, {}};
  const auto text = to_text(endless);
  EXPECT_LT(text.size(), 2000U);
  EXPECT_TRUE(text.starts_with("error: xüü")) << text.substr(0, 20);
  EXPECT_TRUE(text.ends_with("üz"));
  EXPECT_NE(text.find("ü … ü"), std::string::npos);  // no half of a character
}

TEST(NearestNames, names_of_any_length_are_compared_at_once) {
  EXPECT_TRUE(nearest_names(std::string(std::size_t{1} << 24U, 'x'), {"x", "xxxx", "parameters"}).empty());
}

TEST(NearestNames, slips_are_near) {
  EXPECT_EQ(nearest_names("mu", {"x0", "mue", "g"}), Names{"mue"});
  EXPECT_EQ(nearest_names("tolernace", {"tolerance", "until"}), Names{"tolerance"});
  EXPECT_EQ(nearest_names("Spring", {"spring", "string"}), (Names{"spring", "string"}));
  EXPECT_EQ(nearest_names("X", {"x"}), Names{"x"});
  EXPECT_EQ(nearest_names("raod", {"road"}), Names{"road"});  // neighbours swapped: one slip, not two
}

TEST(NearestNames, a_part_of_a_word_is_near_where_no_slip_is) {
  EXPECT_EQ(nearest_names("--output", {"--out", "--until"}), Names{"--out"});
  EXPECT_EQ(nearest_names("stick", {"sliding", "stick-slip"}), Names{"stick-slip"});
  EXPECT_EQ(nearest_names("step", {"steps", "steplength"}), Names{"steps"});
  EXPECT_TRUE(nearest_names("sti", {"stick-slip"}).empty());
}

TEST(NearestNames, others_are_not) {
  EXPECT_TRUE(nearest_names("x", {"t", "mu"}).empty());
  EXPECT_TRUE(nearest_names("position", {"velocity"}).empty());
  EXPECT_TRUE(nearest_names("", {"a", "ab"}).empty());
  EXPECT_TRUE(nearest_names("x", {}).empty());
}

TEST(NearestNames, at_most_three_best_first_ties_in_given_order) {
  EXPECT_EQ(nearest_names("state1", {"stage1", "state2", "state1", "state3", "state4"}),
            (Names{"state1", "stage1", "state2"}));
}

TEST(NearestNames, words_of_other_programs_stand_for_words_of_ours_only) {
  EXPECT_EQ(nearest_names("Upper", {"on", "upper"}), Names{"upper"});
  EXPECT_TRUE(nearest_names("upper", {"on", "off"}).empty());
  EXPECT_EQ(nearest_words("upper", {"on", "off"}), Names{"on"});
  EXPECT_EQ(nearest_words("Upper", {"on", "upper"}), Names{"upper"});
  EXPECT_EQ(nearest_words("tolernace", {"tolerance", "until"}), Names{"tolerance"});
  EXPECT_EQ(suggest_word("RK45", {"radau5", "dopri5"}), "did you mean 'dopri5'?");
}

TEST(ToldTogether, texts_that_differ_in_one_name_only) {
  const auto unused = [](const std::string& line, const std::string& name) {
    return "m.toml:" + line + ": parameter '" + name + "' is never used";
  };
  EXPECT_EQ(told_together({unused("4", "a"), unused("5", "b"), unused("16", "c"), unused("7", "d"), unused("8", "e")}),
            Names{unused("4", "a") + " (and 4 more like it: 'b', 'c', 'd', …)"});
  const Names never{
      "3: event 'a' never happens: its 'when' is constant", "4: event 'b' never happens: its 'when' is constant",
      "5: event 'c' never happens: its 'when' is constant", "6: event 'd' never happens: its 'when' is constant"};
  EXPECT_EQ(told_together(never), Names{never.front() + " (and 3 more like it: 'b', 'c', 'd')"});
}

TEST(ToldTogether, texts_with_more_facts_stay_apart) {
  const Names values{"'a' is 1, not 2", "'b' is 2, not 2", "'c' is 3, not 2", "'d' is 4, not 2"};
  EXPECT_EQ(told_together(values), values);
  const Names pairs{"'a' is 'b'", "'c' is 'd'", "'e' is 'f'", "'g' is 'h'"};
  EXPECT_EQ(told_together(pairs), pairs);
  const Names plain{"the same", "the same", "the same", "the same"};
  EXPECT_EQ(told_together(plain), plain);
}

TEST(Suggest, wording) {
  EXPECT_EQ(suggest("mu", {"mue", "nu"}), "did you mean 'mue' or 'nu'?");
  EXPECT_EQ(suggest("foo", {"x", "velocity"}), "known: x, velocity");
  EXPECT_EQ(suggest("foo", {}), "");
}

}  // namespace
}  // namespace saltus
