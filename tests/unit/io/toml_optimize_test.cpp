// [optimize], free quantities and [time_freezing] in model files.
#include <gtest/gtest.h>

#include "optimize_model.hpp"
#include "saltus/expression/parser.hpp"
#include "saltus/io/toml/toml_model.hpp"
#include "saltus/pipeline/options/optimize_fields.hpp"

namespace saltus::io {
namespace {

using expression::to_text;

TEST(TomlOptimize, TheProblemIsRead) {
  const auto model = parsed(
      "[optimize]\nfrom = 0.5\nhorizon = { free = true, initial = 10, lower = 1, upper = 'k*100' }\n"
      "running_cost = 'u^2'\nterminal_cost = '100*v^2'\nminimize_time = 2\n"
      "path_constraints = ['q <= 3', '-1 <= v + q <= 2', 'if(q > 0, 1, 2) >= v']\npath_constraints_at = 'stages'\n"
      "terminal_constraints = ['q == 200', { constraint = 'v == 0', penalty = 1e3, norm = 'linf' }]\n"
      "path_complementarities = [['q', 'u']]\ninitial_guess = { q = '200*t/10', k = 2 }\ncontrol_intervals = 4\n");
  ASSERT_TRUE(model.has_value()) << to_text(model.error());
  ASSERT_TRUE(model->optimize && model->description.optimize);
  const auto& problem = *model->description.optimize;
  EXPECT_EQ(problem.location.line, head_lines + 1);
  EXPECT_EQ(to_text(*problem.from), "0.5");
  EXPECT_TRUE(problem.horizon.free);
  EXPECT_EQ(to_text(*problem.horizon.value), "10");
  EXPECT_EQ(to_text(*problem.horizon.lower), "1");
  EXPECT_EQ(to_text(*problem.horizon.upper), "k*100");
  EXPECT_EQ(to_text(*problem.running_cost), "u^2");
  EXPECT_EQ(to_text(*problem.terminal_cost), "100*v^2");
  EXPECT_EQ(to_text(*problem.time_weight), "2");
  EXPECT_EQ(problem.path_constraints_at, model::ConstraintPoints::stages);
  ASSERT_EQ(problem.path_complementarities.size(), 1U);
  EXPECT_EQ(to_text(*problem.path_complementarities[0].second), "u");
  ASSERT_EQ(problem.guess.size(), 2U);
  EXPECT_EQ(problem.guess[0].name, "q");
  EXPECT_EQ(to_text(*problem.guess[1].expression), "2");
  EXPECT_FALSE(model->optimize->start_result.has_value());
}

TEST(TomlOptimize, ConstraintsAreSplitAtTheirComparisons) {
  const auto model = parsed(smallest +
                            "path_constraints = ['q <= 3', ' -1 <= v + q <= 2', 'if(q > 0, 1, 2) >= v',\n"
                            "  \"1 >=\\tv >= -1\"]\n"
                            "terminal_constraints = [{ constraint = 'v == 0', penalty = 'k', norm = 'l2' }]\n");
  ASSERT_TRUE(model.has_value()) << to_text(model.error());
  const auto& list = model->description.optimize->path_constraints;
  ASSERT_EQ(list.size(), 4U);
  EXPECT_EQ(list[0].text, "q <= 3");
  EXPECT_EQ(list[0].norm, model::ConstraintNorm::hard);
  EXPECT_EQ(list[0].penalty, nullptr);
  ASSERT_EQ(list[0].sides.size(), 2U);
  EXPECT_EQ(list[0].relations, std::vector{model::Relation::less_equal});
  EXPECT_EQ(list[0].sides[1]->location.line, head_lines + 4);
  EXPECT_EQ(list[0].sides[1]->location.column, 27);  // path_constraints = ['q <= 3
  EXPECT_EQ(list[1].text, "-1 <= v + q <= 2");
  ASSERT_EQ(list[1].sides.size(), 3U);
  EXPECT_EQ(to_text(*list[1].sides[0]), "-1");
  EXPECT_EQ(to_text(*list[1].sides[1]), "v+q");
  EXPECT_EQ(to_text(*list[1].sides[2]), "2");
  EXPECT_EQ(list[2].relations, std::vector{model::Relation::greater_equal});
  EXPECT_EQ(list[3].relations, (std::vector{model::Relation::greater_equal, model::Relation::greater_equal}));
  EXPECT_EQ(list[3].sides[1]->location.line, head_lines + 5);
  EXPECT_EQ(list[3].sides[1]->location.column, 10);  // the tab is written with two characters
  const auto& soft = model->description.optimize->terminal_constraints.at(0);
  EXPECT_EQ(soft.norm, model::ConstraintNorm::l2);
  EXPECT_EQ(to_text(*soft.penalty), "k");
  EXPECT_EQ(soft.relations, std::vector{model::Relation::equal});
}

TEST(TomlOptimize, OptionsAreRead) {
  const auto model = parsed(
      "[optimize]\nhorizon = 5\ncontrol_intervals = 2\nelements = [3, 4]\nscheme = 'gauss_legendre'\nstages = 3\n"
      "switch_detection = false\nrepresentation = 'differential'\nreformulation = 'stewart'\nlifting = 'off'\n"
      "cross_complementarity = 'stage_stage'\nstep_equilibration = 'none'\nstep_bounds = 0.5\nrho = 2\n"
      "equilibration_scale = 3\nnative = 'off'\nstart = 'simulated'\nverification_tolerance = 1e-4\ntime_limit = 60\n"
      "[optimize.mpcc]\nsolver = 'ipopt'\nmethod = 'kadrani'\nsteering = 'linf'\nsigma_initial = 0.1\nsigma_factor = "
      "0.2\n"
      "sigma_final = 1e-9\nwarm_start = 'primal_dual'\ncrossover = false\ntolerance = 1e-7\niteration_limit = 500\n");
  ASSERT_TRUE(model.has_value()) << to_text(model.error());
  const auto& options = *model->optimize;
  EXPECT_EQ(options.control_intervals, 2);
  EXPECT_EQ(options.elements, (std::vector<long>{3, 4}));
  EXPECT_EQ(options.element.scheme, pipeline::Scheme::gauss_legendre);
  EXPECT_EQ(options.element.stages, 3);
  EXPECT_FALSE(options.switch_detection);
  EXPECT_EQ(options.element.representation, pipeline::Representation::differential);
  EXPECT_EQ(options.element.reformulation, pipeline::Reformulation::stewart);
  EXPECT_FALSE(options.element.lifting.has_value());
  EXPECT_EQ(options.element.cross_complementarity, pipeline::CrossComplementarity::stage_stage);
  EXPECT_EQ(options.element.step_equilibration, pipeline::StepEquilibration::none);
  EXPECT_EQ(options.element.step_bounds, 0.5);
  EXPECT_EQ(options.element.rho, 2.0);
  EXPECT_EQ(options.element.equilibration_scale, 3.0);
  EXPECT_EQ(options.native, pipeline::Native::off);
  EXPECT_EQ(options.start, pipeline::StartValues::simulated);
  EXPECT_EQ(options.verification_tolerance, 1e-4);
  EXPECT_EQ(options.mpcc.time_limit, 60.0);
  EXPECT_EQ(options.mpcc.relaxation, solver::homotopy::Relaxation::kadrani);
  EXPECT_EQ(options.mpcc.steering, solver::homotopy::Steering::linf);
  EXPECT_EQ(options.mpcc.sigma_initial, 0.1);
  EXPECT_EQ(options.mpcc.schedule.sigma_factor, 0.2);
  EXPECT_EQ(options.mpcc.schedule.sigma_final, 1e-9);
  EXPECT_EQ(options.mpcc.warm_start, solver::homotopy::WarmStart::primal_dual);
  EXPECT_FALSE(options.mpcc.crossover);
  EXPECT_EQ(options.mpcc.tolerance, 1e-7);
  EXPECT_EQ(options.mpcc.iteration_limit, 500);
  EXPECT_TRUE(check_optimize_options(*model).has_value());
}

TEST(TomlOptimize, DefaultsAreThoseOfThePage) {
  const auto record = pipeline::option_record(pipeline::OptimizeOptions{});
  const auto value = [&](std::string_view key) {
    for (const auto& [name, found] : record) {
      if (name == key) return pipeline::to_text(found);
    }
    return std::string("none of that name");
  };
  EXPECT_EQ(value("optimize.elements"), "3");
  EXPECT_EQ(value("optimize.cross_complementarity"), "\"fe_fe\"");
  EXPECT_EQ(value("optimize.step_equilibration"), "\"heuristic_mean\"");
  EXPECT_EQ(value("optimize.mpcc.method"), "\"scholtes\"");
  EXPECT_EQ(value("optimize.mpcc.sigma_final"), "1e-10");
  EXPECT_EQ(value("optimize.time_limit"), "\"none\"");
}

TEST(TomlOptimize, LeastSquaresAreRead) {
  const auto file = written("ref.csv", "q, v\n1, 2\n# a remark\n3, 4\n");
  const auto model = parsed(
      "[optimize]\nhorizon = 1\ncontrol_intervals = 2\n"
      "[[optimize.least_squares]]\nof = ['q', 'v']\nreference = ['sin(t)', 0]\nweight = [10, 1]\n"
      "at = 'stages'\n[[optimize.least_squares]]\nof = ['q', 'v']\nreference = { file = '" +
      file + "' }\nweight = [[2, 1], [1, 'k']]\n[[optimize.least_squares]]\nof = ['u']\n");
  ASSERT_TRUE(model.has_value()) << to_text(model.error());
  const auto& list = model->description.optimize->least_squares;
  ASSERT_EQ(list.size(), 3U);
  EXPECT_EQ(to_text(*list[0].reference[0]), "sin(t)");
  ASSERT_EQ(list[0].weight.size(), 1U);
  EXPECT_EQ(to_text(*list[0].weight[0][0]), "10");
  EXPECT_EQ(list[0].at, model::CostPoints::stages);
  EXPECT_EQ(list[1].samples, (std::vector<std::vector<double>>{{1, 2}, {3, 4}}));
  EXPECT_EQ(to_text(*list[1].weight[1][1]), "k");
  EXPECT_TRUE(list[2].reference.empty() && list[2].samples.empty() && list[2].weight.empty());
  EXPECT_EQ(list[2].at, model::CostPoints::intervals);
  EXPECT_TRUE(check_optimize_options(*model).has_value());
}

TEST(TomlOptimize, FreeQuantitiesAndClocksAreRead) {
  const auto model = parsed("[time_freezing]\nclock = 'tau'\nspeed = { lower = 1, upper = 100 }\n");
  ASSERT_TRUE(model.has_value()) << to_text(model.error());
  const auto& description = model->description;
  ASSERT_EQ(description.free_parameters.size(), 1U);
  EXPECT_EQ(description.free_parameters[0].name, "k");
  EXPECT_EQ(to_text(*description.free_parameters[0].upper), "5");
  EXPECT_TRUE(description.states[0].free);
  EXPECT_FALSE(description.states[1].free);
  ASSERT_TRUE(description.clock);
  EXPECT_EQ(description.clock->clock, "tau");
  EXPECT_EQ(to_text(*description.clock->speed_upper), "100");
  EXPECT_FALSE(model->optimize || description.optimize);
  const auto refused = check_optimize_options(*model);
  ASSERT_FALSE(refused.has_value());
  EXPECT_NE(refused.error().message.find("no table [optimize]"), std::string::npos);
}

struct OptimizeMistake {
  std::string text;
  int line;  ///< below the head
  std::string message;
  std::string remedy;
};

void expect_mistakes(const std::vector<OptimizeMistake>& mistakes) {
  for (const auto& mistake : mistakes) {
    const auto model = parsed(mistake.text);
    ASSERT_FALSE(model.has_value()) << "the file was accepted: " << mistake.text;
    const auto& error = model.error();
    EXPECT_NE(error.message.find(mistake.message), std::string::npos) << mistake.text << error.message;
    EXPECT_NE(error.remedy.find(mistake.remedy), std::string::npos) << mistake.text << error.remedy;
    EXPECT_EQ(error.location.line, head_lines + mistake.line) << mistake.text;
  }
}

TEST(TomlOptimize, MistakesInConstraintsAreFoundWithTheirPlace) {
  std::vector<OptimizeMistake> mistakes{
      {"'q'", 4, "has no comparison", "q <= 3"},
      {"'(q <= 3)'", 4, "no comparison outside of parentheses", "remove the parentheses"},
      {"'q < 3'", 4, "'<' is no relation", "write <="},
      {"'q > 3'", 4, "'>' is no relation", "write >="},
      {"'q = 3'", 4, "'=' is no relation", "write =="},
      {"'q => 3'", 4, "'=>' is no relation", "write >="},
      {"'q != 3'", 4, "'!=' is no relation", "<=, >= or =="},
      {"'q <= 3 and v <= 1'", 4, "without 'and'", "an entry of its own"},
      {"'q <= 3 or v <= 1'", 4, "without 'or'", "path_complementarities"},
      {"'not q <= 3'", 4, "without 'not'", "turn the comparison"},
      {"'0 <= q <= v <= 3'", 4, "expected one comparison or two, found 3", "several"},
      {"'0 <= q >= v'", 4, "do not bound one expression", "two constraints"},
      {"'0 == q == v'", 4, "do not bound one expression", "two constraints"},
      {"'q <='", 4, "nothing stands behind", "both sides"},
      {"'<= q'", 4, "nothing stands before", "both sides"},
      {"''", 4, "has no comparison", ""},
      {"'(q > 0) + 1 <= 3'", 4, "true or false, not a number", "if(condition, a, b)"},
      {"'q <= 3*'", 4, "found the end", ""},
      {"3", 4, "a constraint in quotes", ""},
      {"{ constraint = 'q <= 3' }", 4, "no `penalty`", "norm ="},
      {"{ penalty = 1 }", 4, "no `constraint`", "constraint ="},
      {"{ constraint = 'q <= 3', penalty = 0 }", 4, "expected a number > 0, found 0", "hard"},
      {"{ constraint = 'q <= 3', penalty = 1, norm = 'l3' }", 4, "found the string \"l3\"", ""},
      {"{ constraint = 'q <= 3', penalty = 1, nrom = 'l1' }", 4, "unknown key 'nrom'", "'norm'"},
  };
  for (auto& mistake : mistakes) mistake.text = smallest + "path_constraints = [" + mistake.text + "]\n";
  mistakes.push_back({smallest + "path_constraints = 'q <= 3'\n", 4, "a list of constraints", ""});
  expect_mistakes(mistakes);
}

TEST(TomlOptimize, MistakesInTheProblemAreFoundWithTheirPlace) {
  expect_mistakes({
      {smallest + "runing_cost = 'u'\n", 4, "unknown option optimize.runing_cost", "'optimize.running_cost'"},
      {smallest + "sigma_final = 1\n", 4, "unknown option", "'optimize.mpcc.sigma_final'"},
      {smallest + "[optimize.mpcc]\nsigma_finale = 1\n", 5, "unknown option", "'optimize.mpcc.sigma_final'"},
      {smallest + "[optimize.mpc]\nsigma_final = 1\n", 4, "unknown option optimize.mpc", ""},
      {"[optimise]\nhorizon = 1\n", 1, "unknown table [optimise]", "'optimize'"},
      {"[optimize]\nhorizon = 0\n", 2, "expected a length of time > 0, found 0", ""},
      {"[optimize]\nhorizon = '-2*3'\n", 2, "found -6", ""},
      {"[optimize]\nhorizon = true\n", 2, "an expression in quotes", ""},
      {"[optimize]\nhorizon = { free = true, lower = 1, upper = 2 }\n", 2, "no initial value", "initial = 10"},
      {"[optimize]\nhorizon = { free = true, initial = 1, upper = 2 }\n", 2, "no lower bound", "finite"},
      {"[optimize]\nhorizon = { free = true, initial = 1, lower = 0.5, upper = inf }\n", 2, "no upper bound", ""},
      {"[optimize]\nhorizon = { free = true, initial = 1, lower = 3, upper = 2 }\n", 2, "lower (3) is above upper (2)",
       ""},
      {"[optimize]\nhorizon = { free = true, initial = 4, lower = 1, upper = 2 }\n", 2, "above upper (2)", ""},
      {"[optimize]\nhorizon = { free = true, initial = 1, lower = -1, upper = 2 }\n", 2, "> 0, found -1", ""},
      {"[optimize]\nhorizon = { fre = true, initial = 1 }\n", 2, "unknown key 'fre'", "'free'"},
      {"[optimize]\ncontrol_intervals = 0\n", 2, "expected a whole number >= 1, found 0", ""},
      {"[optimize]\nelements = 0\n", 2, "expected a whole number >= 1", ""},
      {"[optimize]\nelements = [2, 0]\n", 2, "expected a whole number >= 1", ""},
      {"[optimize]\nelements = []\n", 2, "expected a whole number >= 1", ""},
      {"[optimize]\nelements = ['2']\n", 2, "expected a whole number >= 1", ""},
      {"[optimize]\nstages = 0\n", 2, "expected a whole number >= 1", ""},
      {"[optimize]\nscheme = 'radau'\n", 2, "scheme: expected \"radau_iia\"", ""},
      {"[optimize.mpcc]\nsigma_factor = 1\n", 2, "a number > 0 and < 1, found 1", ""},
      {"[optimize.mpcc]\nmethod = 'scholtez'\n", 2, "scholtez", "'scholtes'"},
      {"[optimize.mpcc]\nsolver = 'snopt'\n", 2, "expected \"structured\" or \"ipopt\"", ""},
      {"[optimize]\nmpcc = 3\n", 2, "the table [optimize.mpcc]", ""},
      {"[optimize]\ntime_limit = 0\n", 2, "\"none\" or a finite number > 0", ""},
      {"[optimize]\npath_constraints_at = 'nodes'\n", 2, "found the string \"nodes\"", ""},
      {"[optimize]\npath_complementarities = ['q']\n", 2, "a pair of expressions", ""},
      {"[optimize]\npath_complementarities = [['q', 'u', 'v']]\n", 2, "has two sides, found 3", ""},
      {"[optimize]\ninitial_guess = { result = 'r.json', q = 1 }\n", 2, "a result and other entries", ""},
      {"[time_freezing]\nclock = 'taw'\n", 2, "the clock 'taw' is no state", "'tau'"},
      {"[time_freezing]\nspeed = { lower = 1, upper = 2 }\n", 1, "names no clock", "clock ="},
      {"[time_freezing]\nclock = 'tau'\nspeed = { lower = 3, upper = 2 }\n", 3, "lower (3) is above upper (2)", ""},
      {"[time_freezing]\nclock = 'tau'\nspeed = { lower = 0, upper = 2 }\n", 3, "expected lower > 0", ""},
      {"[time_freezing]\nclock = 'tau'\nspeed = { lower = 1 }\n", 3, "two bounds", ""},
      {"[time_freezing]\nclock = 'tau'\neps_t = 0\n", 3, "eps_t is 0", "positive"},
      {"[time_freezing]\nclock = 'tau'\na_n = 0\n", 3, "a_n is 0", "positive"},
  });
}

TEST(TomlOptimize, MistakesInLeastSquaresAreFoundWithTheirPlace) {
  std::vector<OptimizeMistake> mistakes{
      {"weight = [1]\n", 4, "no `of`", "of = ["},
      {"of = 'q'\n", 5, "a list of expressions", ""},
      {"of = ['q', 'v']\nreference = [1]\n", 6, "`of` has 2 expressions, `reference` 1", "one reference per"},
      {"of = ['q', 'v']\nweight = [1, 2, 3]\n", 6, "`of` has 2 expressions, `weight` 3", "symmetric matrix"},
      {"of = ['q', 'v']\nweight = [[1, 2]]\n", 6, "no matrix of 2 rows", ""},
      {"of = ['q', 'v']\nweight = [[1, 2], [3, 4]]\n", 6, "not symmetric: 3 in row 2, column 1", "the mean"},
      {"of = ['q']\nat = 'nodes'\n", 6, "found the string \"nodes\"", ""},
      {"of = ['q']\nwight = [1]\n", 6, "unknown key 'wight'", "'weight'"},
      {"of = ['q']\nreference = { result = 'r.json' }\n", 6, "unknown key 'result'", "file"},
  };
  for (auto& mistake : mistakes) mistake.text = smallest + "[[optimize.least_squares]]\n" + mistake.text;
  mistakes.push_back({smallest + "[optimize.least_squares]\nof = ['q']\n", 4, "[[optimize.least_squares]]", ""});
  expect_mistakes(mistakes);
}

TEST(TomlOptimize, FilesOfReferencesAreChecked) {
  const auto refused = [](const std::string& text) {
    const auto file = written("bad.csv", text);
    const auto model =
        parsed(smallest + "[[optimize.least_squares]]\nof = ['q', 'v']\nreference = { file = '" + file + "' }\n");
    EXPECT_FALSE(model.has_value()) << text;
    return model ? Error{} : model.error();
  };
  EXPECT_NE(refused("1, 2\n3\n").message.find("expected 2 numbers, found 1"), std::string::npos);
  EXPECT_EQ(refused("1, 2\n3\n").location.line, 2);
  EXPECT_NE(refused("1, 2\n3, x\n").message.find("expected a finite number, found 'x'"), std::string::npos);
  EXPECT_NE(refused("1, nan\n").message.find("expected a finite number"), std::string::npos);
  EXPECT_NE(refused("q, v\n").message.find("no rows"), std::string::npos);
  const auto missing = parsed(smallest + "[[optimize.least_squares]]\nof = ['q']\nreference = { file = 'none.csv' }\n");
  ASSERT_FALSE(missing.has_value());
  EXPECT_EQ(missing.error().code, ErrorCode::io_failure);
}

}  // namespace
}  // namespace saltus::io
