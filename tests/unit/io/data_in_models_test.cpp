// Data that stand in a model file itself: samples of inputs, rows of references; and which rows a result has.
#include <string>

#include <gtest/gtest.h>

#include "saltus/io/toml/toml_model.hpp"

namespace saltus::io {
namespace {

const std::string head = "[model]\nname='m'\n[states]\nx=0\n[controls]\nu=0\n[dynamics]\nx='u'\n";

Expected<ModelFile> parsed(const std::string& tail) { return parse_model(head + tail, "m.toml"); }

TEST(DataInModels, SamplesOfAnInputStandInTheFileOrBehindASetting) {
  const auto file = parsed("[simulate]\nuntil = 3\ninputs = { u = { times = [0, 1.5], values = [2, -1] } }\n");
  ASSERT_TRUE(file) << file.error().message;
  ASSERT_EQ(file->description.sampled_inputs.size(), 1U);
  EXPECT_EQ(file->description.sampled_inputs[0].times, (std::vector<double>{0, 1.5}));
  EXPECT_EQ(file->description.sampled_inputs[0].values, (std::vector<double>{2, -1}));
  const auto changed = with_setting(*file, "simulate.inputs.u", "{ times = [0], values = [7] }");
  ASSERT_TRUE(changed) << changed.error().message;
  ASSERT_EQ(changed->description.sampled_inputs.size(), 1U);
  EXPECT_EQ(changed->description.sampled_inputs[0].values, (std::vector<double>{7}));
}

TEST(DataInModels, WhatIsWrongWithSamplesHasItsPlace) {
  const auto refused = [](const std::string& samples) {
    const auto file = parsed("[simulate]\ninputs = { u = { " + samples + " } }\n");
    return file ? std::string() : file.error().message + " | " + file.error().remedy;
  };
  EXPECT_NE(refused("times = [0, 1]").find("has no values"), std::string::npos);
  EXPECT_NE(refused("values = [0, 1]").find("has no times"), std::string::npos);
  EXPECT_NE(refused("times = [0, 1], values = [1]"), "");
  EXPECT_NE(refused("times = [1, 0], values = [1, 2]"), "");
  EXPECT_NE(refused("times = [0, 1], values = [1, 2], kind = 'linear'").find("kind"), std::string::npos);
  const auto file = parsed("[simulate]\ninputs = { u = { times = [1, 0], values = [1, 2] } }\n");
  ASSERT_FALSE(file);
  EXPECT_EQ(file.error().location.line, 10);
}

TEST(DataInModels, RowsOfAReferenceStandInTheFile) {
  const std::string problem =
      "[optimize]\nhorizon = 2\ncontrol_intervals = 2\n[[optimize.least_squares]]\nof = ['x']\n";
  const auto file = parsed(problem + "reference = { rows = [[0.5, 1], [1.5, 2]] }\nat = 'times'\n");
  ASSERT_TRUE(file) << file.error().message;
  const auto& part = file->description.optimize->least_squares[0];
  EXPECT_EQ(part.times, (std::vector<double>{0.5, 1.5}));
  EXPECT_EQ(part.samples, (std::vector<std::vector<double>>{{1}, {2}}));
  const auto per_interval = parsed(problem + "reference = { rows = [[1], [2]] }\n");
  ASSERT_TRUE(per_interval) << per_interval.error().message;
  EXPECT_EQ(per_interval->description.optimize->least_squares[0].samples.size(), 2U);
  for (const auto* wrong :
       {"reference = { rows = [[1, 2], [3]] }\n", "reference = { rows = [1, 2] }\n", "reference = { rows = [['a']] }\n",
        "reference = { rows = [[1]], file = 'a.csv' }\n", "reference = { }\n", "at = 'times'\n"}) {
    EXPECT_FALSE(parsed(problem + wrong)) << wrong;
  }
}

TEST(DataInModels, RowsAtGivenTimesHaveNoneAtEventsUnlessTheyAreStated) {
  const auto rows = [](const std::string& output) {
    const auto file = parsed("[simulate]\nuntil = 3\noutput = " + output + "\n");
    EXPECT_TRUE(file) << output;
    return pipeline::has_event_rows(file->simulate);
  };
  EXPECT_FALSE(rows("{ times = [1, 2] }"));
  EXPECT_TRUE(rows("{ times = [1, 2], events = true }"));
  EXPECT_TRUE(rows("{ events = true, times = [1, 2] }"));
  EXPECT_TRUE(rows("{ points = 4 }"));
  EXPECT_FALSE(rows("{ points = 4, events = false }"));
  EXPECT_TRUE(rows("'steps'"));
}

TEST(DataInModels, WithoutStatesNoEndIsMissedFirst) {
  const auto empty = parse_model("[model]\nname='m'\n", "m.toml");
  ASSERT_TRUE(empty);
  EXPECT_TRUE(check_options(*empty));
  EXPECT_FALSE(check_options(*parsed("")));
}

}  // namespace
}  // namespace saltus::io
