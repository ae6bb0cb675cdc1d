#include "saltus/base/error.hpp"

#include <gtest/gtest.h>

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

TEST(Suggest, wording) {
  EXPECT_EQ(suggest("mu", {"mue", "nu"}), "did you mean 'mue' or 'nu'?");
  EXPECT_EQ(suggest("foo", {"x", "velocity"}), "known: x, velocity");
  EXPECT_EQ(suggest("foo", {}), "");
}

}  // namespace
}  // namespace saltus
