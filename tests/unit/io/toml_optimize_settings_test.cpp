// What is free, options of [optimize] against each other, and --set.
#include <gtest/gtest.h>

#include "optimize_model.hpp"
#include "saltus/expression/parser.hpp"
#include "saltus/io/toml/toml_model.hpp"
#include "saltus/pipeline/options/optimize_fields.hpp"

namespace saltus::io {
namespace {

TEST(TomlOptimizeSettings, WhatIsFreeNeedsBounds) {
  const std::string head = "[model]\nname = 'm'\n[states]\nx = 0\n[dynamics]\nx = 1\n[parameters]\n";
  const auto message = [&](const std::string& quantity) {
    const auto model = parse_model(head + quantity, "m.toml");
    return model ? std::string("accepted") : model.error().message;
  };
  EXPECT_EQ(message("k = { initial = 1, free = true }\n"), "'k' is free and has no lower and no upper bound");
  EXPECT_EQ(message("k = { initial = 1, lower = 0, free = true }\n"), "'k' is free and has no upper bound");
  EXPECT_EQ(message("k = { initial = 1, lower = 3, upper = 2, free = true }\n"), "'k': lower (3) is above upper (2)");
  EXPECT_EQ(message("k = { initial = 1, lower = 2, upper = 3, free = true }\n"), "'k': initial (1) is below lower (2)");
  EXPECT_EQ(message("k = { initial = 1, lower = 2, upper = 3 }\n"), "accepted");
  EXPECT_EQ(message("k = { initial = 1, unit = 3 }\n").substr(0, 22), "expected a text in quo");
}

TEST(TomlOptimizeSettings, OptionsThatDoNotFitTogetherAreFoundAfterAllSettings) {
  const auto file = written("two.csv", "1\n2\n");
  const auto message = [](const std::string& text) {
    const auto model = parsed(text);
    EXPECT_TRUE(model.has_value()) << (model ? "" : to_text(model.error()));
    const auto fits = model ? check_optimize_options(*model) : Expected<void>{};
    return fits ? std::string("fits") : fits.error().message;
  };
  EXPECT_EQ(message(smallest), "fits");
  EXPECT_EQ(message("[optimize]\nhorizon = 1\n"), "no number of control intervals");
  EXPECT_EQ(message("[optimize]\ncontrol_intervals = 1\n"), "no horizon");
  EXPECT_EQ(message(smallest + "elements = [1, 2]\n"), "elements has 2 entries, control_intervals is 4");
  EXPECT_EQ(message(smallest + "[optimize.mpcc]\nsigma_initial = 1e-12\n"),
            "sigma_final (1e-10) is above sigma_initial (1e-12)");
  EXPECT_EQ(message(smallest + "[[optimize.least_squares]]\nof = ['q']\nreference = { file = '" + file + "' }\n"),
            file + " has 2 rows, control_intervals is 4");
}

TEST(TomlOptimizeSettings, SettingsReachEveryKey) {
  auto model = parsed(smallest);
  ASSERT_TRUE(model.has_value());
  for (const auto& [key, value] :
       std::vector<std::pair<std::string, std::string>>{{"optimize.elements", "[1,2]"},
                                                        {"optimize.control_intervals", "2"},
                                                        {"optimize.mpcc.sigma_final", "1e-8"},
                                                        {"optimize.scheme", "gauss_legendre"},
                                                        {"optimize.horizon", "2*k"},
                                                        {"optimize.minimize_time", "true"},
                                                        {"optimize.running_cost", "u^2"},
                                                        {"optimize.initial_guess.result", "r.json"},
                                                        {"parameters.k.lower", "0.5"},
                                                        {"parameters.k.initial", "2"},
                                                        {"states.q.free", "false"}}) {
    auto changed = with_setting(*model, key, value);
    ASSERT_TRUE(changed.has_value()) << key << to_text(changed.error());
    model = std::move(changed);
  }
  const auto& problem = *model->description.optimize;
  EXPECT_EQ(model->optimize->elements, (std::vector<long>{1, 2}));
  EXPECT_EQ(model->optimize->mpcc.schedule.sigma_final, 1e-8);
  EXPECT_EQ(model->optimize->element.scheme, pipeline::Scheme::gauss_legendre);
  EXPECT_EQ(expression::to_text(*problem.horizon.value), "2*k");
  EXPECT_EQ(expression::to_text(*problem.time_weight), "1");
  EXPECT_EQ(expression::to_text(*problem.running_cost), "u^2");
  EXPECT_EQ(model->optimize->start_result, "r.json");
  EXPECT_EQ(expression::to_text(*model->description.free_parameters[0].lower), "0.5");
  EXPECT_EQ(expression::to_text(*model->description.parameters[0].expression), "2");
  EXPECT_FALSE(model->description.states[0].free);
}

TEST(TomlOptimizeSettings, ConstraintsAreReplaced) {
  const auto model = parsed(smallest);
  ASSERT_TRUE(model.has_value());
  const auto one = with_setting(*model, "optimize.path_constraints", "v <= 1");
  ASSERT_TRUE(one.has_value()) << one.error().message;
  EXPECT_EQ(one->description.optimize->path_constraints.size(), 1U);
  const auto two = with_setting(*one, "optimize.path_constraints", "[\"v <= 2\", \"v >= -2\"]");
  ASSERT_TRUE(two.has_value()) << two.error().message;
  EXPECT_EQ(two->description.optimize->path_constraints.size(), 2U);
  const auto none = with_setting(*two, "optimize.terminal_constraints", "[]");
  ASSERT_TRUE(none.has_value()) << none.error().message;
  EXPECT_TRUE(none->description.optimize->terminal_constraints.empty());
  const auto at_stages = with_setting(*two, "optimize.path_constraints_at", "stages");
  ASSERT_TRUE(at_stages.has_value()) << at_stages.error().message;
  EXPECT_EQ(at_stages->description.optimize->path_constraints_at, model::ConstraintPoints::stages);
}

TEST(TomlOptimizeSettings, SettingsThatAreWrongAreRefused) {
  const auto model = parsed(smallest);
  ASSERT_TRUE(model.has_value());
  const auto message = [&](const std::string& key, const std::string& value) {
    const auto changed = with_setting(*model, key, value);
    return changed ? std::string("accepted") : changed.error().message;
  };
  EXPECT_EQ(message("optimize.elements", "0").substr(0, 35), "expected a whole number >= 1 or a l");
  EXPECT_EQ(message("optimize.elemens", "1"), "unknown option optimize.elemens");
  EXPECT_EQ(message("optimize.horizon", "0"), "horizon: expected a length of time > 0, found 0");
  EXPECT_EQ(message("optimize.path_constraints_at", "nodes").substr(0, 8), "expected");
  EXPECT_EQ(message("optimize.path_complementarities", "q"),
            "'path_complementarities' cannot be set on the command line");
  EXPECT_EQ(message("states.v.free", "true"), "'v' has no two bounds");
  const auto without = parse_model("[model]\nname = 'm'\n[states]\nx = 0\n[dynamics]\nx = 1\n", "m.toml");
  ASSERT_TRUE(without.has_value());
  const auto changed = with_setting(*without, "optimize.elements", "2");
  ASSERT_FALSE(changed.has_value());
  EXPECT_EQ(changed.error().message, "the model has no table [optimize]");
}

}  // namespace
}  // namespace saltus::io
