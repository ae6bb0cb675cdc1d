#include "saltus/pipeline/options/option_fields.hpp"

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "saltus/pipeline/options/optimize_fields.hpp"

namespace saltus::pipeline {
namespace {

SimulateOptions uncommon_options() {
  SimulateOptions options;
  options.until = 3.0;
  options.from = -1.0;
  options.begun = -2.5;
  options.rtol = 1e-3;
  options.atol = 0.0;
  options.native = Native::off;
  options.max_steps = 7;
  options.max_events = 8;
  options.initial_mode = {{"a", -1}, {"v-0.2", 0}};
  options.event.integrator = Integrator::dop853;
  options.event.max_step = 0.25;
  options.event.scaling = {{"a", 2.0}};
  options.smoothed.epsilon = 1e-3;
  return options;
}

TEST(OptionFields, WhatIsRecordedSetsTheSameOptionsAgain) {
  const std::vector<OutputGrid> grids{Automatic{}, EveryStep{}, EveryInterval{0.5}, NumberOfPoints{11},
                                      AtTimes{{0.0, 1.0}}};
  for (const auto& grid : grids) {
    auto original = uncommon_options();
    original.output = grid;
    original.event_rows = false;
    const auto record = option_record(original);
    SimulateOptions copy;
    for (const auto& [name, value] : record) {
      ASSERT_TRUE(name.starts_with("simulate.")) << name;
      auto changed = with_value(copy, name.substr(9), value);
      ASSERT_TRUE(changed) << name << ": " << changed.error().message;
      copy = *changed;
    }
    EXPECT_EQ(option_record(copy), record);
    EXPECT_EQ(copy.until, original.until);
    EXPECT_EQ(copy.initial_mode, original.initial_mode);
    EXPECT_EQ(copy.output.index(), original.output.index());
    EXPECT_EQ(copy.event_rows, false);
  }
}

TEST(OptionFields, WhatIsInForceIsOfTheKindOfItsOption) {
  const auto check_all = [](const auto& fields, const auto& options) {
    for (const auto& field : fields) {
      result::OptionRecord record;
      field.record(options, field.key, record);
      for (const auto& [name, value] : record) EXPECT_TRUE(check(field.kind, value)) << name;
    }
  };
  check_all(simulate_fields(), SimulateOptions{});
  check_all(simulate_fields(), uncommon_options());
  check_all(optimize_fields(), OptimizeOptions{});
}

TEST(OptionFields, WhatIsSaidOfAKindIsWhatItTakes) {
  constexpr std::array<std::string_view, 2> words{"auto", "off"};
  const OptionKind kind{.words = words, .number = Numbers{.whole = true, .from = 2.0}, .list = ListOf::the_same};
  EXPECT_EQ(expects(kind), "auto, off, or a whole number >= 2, or a list of them");
  using List = std::vector<double>;
  for (const result::OptionValue& value :
       {result::OptionValue(std::string("off")), {std::int64_t{2}}, {1e3}, {List{2.0, 3.0}}}) {
    EXPECT_TRUE(check(kind, value)) << to_text(value);
  }
  for (const result::OptionValue& value : {result::OptionValue(std::string("on")),
                                           {std::int64_t{1}},
                                           {2.5},
                                           {true},
                                           {List{2.0, 1.0}},
                                           {List{}},
                                           {std::vector<std::string>{"off"}}}) {
    const auto fits = check(kind, value);
    ASSERT_FALSE(fits) << to_text(value);
    EXPECT_EQ(fits.error().message,
              "expected \"auto\", \"off\", a whole number >= 2 or a list of them, found " + to_text(value));
  }
  EXPECT_EQ(expects({.number = Numbers{.above = 0.0, .up_to = 1.0}}), "a number > 0 and <= 1");
  EXPECT_EQ(expects({.number = Numbers{.above_option = "from"}}), "a finite number > `from`");
  EXPECT_EQ(expects({.truth = true}), "true, false");
}

TEST(OptionFields, EveryOptionIsOnThePage) {
  const auto page = options_page();
  const auto help = options_help();
  for (const auto& field : simulate_fields()) {
    EXPECT_NE(page.find("| `" + std::string(field.key) + "` |"), std::string::npos) << field.key;
    EXPECT_NE(help.find(field.key), std::string::npos) << field.key;
  }
  EXPECT_NE(page.find("| `rtol` | a finite number > 0 | `1e-08` |"), std::string::npos);
}

TEST(OptionFields, ProblemsBetweenOptionsAreFound) {
  SimulateOptions options;
  ASSERT_TRUE(find_problem(options));
  EXPECT_EQ(find_problem(options)->key, "until");
  options.until = 1.0;
  EXPECT_FALSE(find_problem(options));
  options.from = 1.0;
  EXPECT_EQ(find_problem(options)->key, "until");
  options.from = 0.0;
  options.rtol = options.atol = 0.0;
  EXPECT_EQ(find_problem(options)->key, "atol");
  options.rtol = -1.0;
  options.atol = 2.0;
  ASSERT_TRUE(find_problem(options));
  EXPECT_EQ(find_problem(options)->key, "rtol");
  EXPECT_EQ(find_problem(options)->error.message, "rtol: expected a finite number > 0, found -1");
  options.rtol = 1e-8;
  options.max_steps = 0;
  EXPECT_EQ(find_problem(options)->key, "max_steps");
  options.max_steps = 100;
  options.output = AtTimes{{0.0, 1.0}};
  EXPECT_FALSE(find_problem(options));
  options.output = AtTimes{{0.0, 1.0 + 1e-15}};
  EXPECT_EQ(find_problem(options)->key, "output.times");
  options.output = EveryStep{};
  options.method = Method::smoothed;
  EXPECT_FALSE(find_problem(options));
  options.initial_mode = {{"a", 1}};
  EXPECT_EQ(find_problem(options)->key, "method");
}

}  // namespace
}  // namespace saltus::pipeline
