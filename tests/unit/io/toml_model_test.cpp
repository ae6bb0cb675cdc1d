#include "saltus/io/toml/toml_model.hpp"

#include <algorithm>
#include <random>

#include <gtest/gtest.h>

#include "saltus/expression/parser.hpp"

namespace saltus::io {
namespace {

constexpr std::string_view whole = R"toml([model]
name = "sample"
description = "one of everything"
inclusion = "aizerman_pyatnitskii"

[parameters]
mu = 0.8
nu = "2*mu"
k = { initial = "mu + 1", lower = 0, upper = inf, free = false }

[states]
z = 1
a = { initial = "-mu", lower = -10, upper = "2*mu" }

[controls]
w = 3
u = { lower = -5, upper = 5, initial = 0.5 }

[definitions]
spring = "-z"

[switching]
slip = "a - 0.2"

[dynamics]
z = "a"
a = "spring + u - mu*sign(slip)"

[outputs]
power = "mu*a"
one = 1

[[events]]
name = "returns"
when = "z"
direction = "up"

[[events]]
when = "a > 1"
stop = true

[simulate]
until = 40
from = -1.5
method = "event"
rtol = 1e-9
atol = 0
output = { times = [0, 1.5, 40] }
inputs = { u = "sin(t)" }
native = "off"
max_steps = 1e5
initial_mode = { slip = 0 }
[simulate.event]
integrator = "dop853"
max_step = 0.5
branches = "report"
)toml";

ModelFile parsed_file(std::string_view text) {
  auto model = parse_model(text, "m.toml");
  EXPECT_TRUE(model) << to_text(model.error());
  return model.value_or(ModelFile{});
}

template <class Item>
std::vector<std::string> names(const std::vector<Item>& items) {
  std::vector<std::string> list;
  for (const auto& item : items) list.push_back(item.name);
  return list;
}

TEST(TomlModel, ReadsEveryTableInTheOrderOfTheFile) {
  const auto description = parsed_file(whole).description;
  using Names = std::vector<std::string>;
  EXPECT_EQ(description.name, "sample");
  EXPECT_EQ(description.description, "one of everything");
  EXPECT_EQ(description.inclusion, model::Inclusion::aizerman_pyatnitskii);
  EXPECT_EQ(names(description.parameters), (Names{"mu", "nu", "k"}));
  EXPECT_EQ(names(description.states), (Names{"z", "a"}));
  EXPECT_EQ(names(description.controls), (Names{"w", "u"}));
  EXPECT_EQ(names(description.outputs), (Names{"power", "one"}));
  EXPECT_EQ(names(description.definitions), Names{"spring"});
  EXPECT_EQ(names(description.switching), Names{"slip"});
  EXPECT_EQ(names(description.dynamics), (Names{"z", "a"}));
  EXPECT_EQ(names(description.inputs), Names{"u"});
  EXPECT_EQ(expression::to_text(*description.parameters[2].expression), "mu+1");
  EXPECT_EQ(expression::to_text(*description.states[1].upper), "2*mu");
  EXPECT_EQ(description.states[0].lower, nullptr);
  EXPECT_EQ(expression::to_text(*description.controls[1].initial), "0.5");
}

TEST(TomlModel, ReadsEvents) {
  const auto events = parsed_file(whole).description.events;
  ASSERT_EQ(events.size(), 2U);
  EXPECT_EQ(events[0].name, "returns");
  EXPECT_EQ(events[0].direction, model::Direction::up);
  EXPECT_EQ(events[0].action, model::AtEvent::record);
  EXPECT_EQ(events[1].name, std::nullopt);
  EXPECT_EQ(events[1].direction, model::Direction::both);
  EXPECT_EQ(events[1].action, model::AtEvent::stop);
  EXPECT_EQ(expression::to_text(*events[1].when), "a>1");
}

TEST(TomlModel, ReadsOptions) {
  const auto options = parsed_file(whole).simulate;
  EXPECT_EQ(options.until, 40.0);
  EXPECT_EQ(options.from, -1.5);
  EXPECT_EQ(options.rtol, 1e-9);
  EXPECT_EQ(options.atol, 0.0);
  EXPECT_EQ(options.max_steps, 100000);
  EXPECT_EQ(options.native, pipeline::Native::off);
  EXPECT_EQ(options.event.integrator, pipeline::Integrator::dop853);
  EXPECT_EQ(options.event.max_step, 0.5);
  ASSERT_EQ(options.initial_mode.size(), 1U);
  EXPECT_EQ(options.initial_mode[0], (std::pair<std::string, int>("slip", 0)));
  const auto* times = std::get_if<pipeline::AtTimes>(&options.output);
  ASSERT_NE(times, nullptr);
  EXPECT_EQ(times->times, (std::vector<double>{0, 1.5, 40}));
  EXPECT_TRUE(check_options(parsed_file(whole)));
}

TEST(TomlModel, ReadsEveryFormOfOutput) {
  const std::string head = "[model]\nname='m'\n[simulate]\noutput = ";
  EXPECT_TRUE(std::holds_alternative<pipeline::EveryStep>(parsed_file(head + "'steps'").simulate.output));
  EXPECT_TRUE(std::holds_alternative<pipeline::Automatic>(parsed_file(head + "'auto'").simulate.output));
  EXPECT_TRUE(std::holds_alternative<pipeline::Automatic>(parsed_file("[model]\nname='m'\n").simulate.output));
  EXPECT_EQ(parsed_file(head + "{ every = 0.25, events = false }").simulate.event_rows, false);
  EXPECT_TRUE(has_event_rows(parsed_file(head + "{ every = 0.25 }").simulate));
  EXPECT_EQ(std::get<pipeline::EveryInterval>(parsed_file(head + "{ every = 0.25 }").simulate.output).interval, 0.25);
  EXPECT_EQ(std::get<pipeline::NumberOfPoints>(parsed_file(head + "{ points = 7 }").simulate.output).points, 7);
}

TEST(TomlModel, TheFingerprintIsThatOfTheBytes) {
  EXPECT_EQ(parsed_file("[model]\nname = \"m\"\n").sha256,
            "9244c2122fabbe47a6c96373cf73373dea8dd270ab685bac1f0e09bd5b179a5b");
}

// Expressions carry the positions of the file, whichever quotes they stand in.
struct Placed {
  const char* value;
  int line, column;  ///< of the name `b`
};

class ExpressionPosition : public testing::TestWithParam<Placed> {};

TEST_P(ExpressionPosition, IsThatOfTheFile) {
  const auto model = parsed_file(std::string("[model]\nname = 'm'\n[dynamics]\nx = ") + GetParam().value + "\n");
  ASSERT_EQ(model.description.dynamics.size(), 1U);
  const auto* sum = std::get_if<expression::Binary>(&model.description.dynamics[0].expression->value);
  ASSERT_NE(sum, nullptr);
  EXPECT_EQ(sum->right->location.file, "m.toml");
  EXPECT_EQ(sum->right->location.line, GetParam().line);
  EXPECT_EQ(sum->right->location.column, GetParam().column);
}

INSTANTIATE_TEST_SUITE_P(Quotes, ExpressionPosition,
                         testing::Values(Placed{"\"a + b\"", 4, 10}, Placed{"'a + b'", 4, 10},
                                         Placed{"\"\"\"a + b\"\"\"", 4, 12}, Placed{"'''a +\n  b'''", 5, 3},
                                         Placed{"\"\"\"\na +\n  b\"\"\"", 6, 3}, Placed{"'''\na + b'''", 5, 5},
                                         Placed{"'''\r\na + b'''", 5, 5}));
// Behind escapes, too: the value is shorter than what stands in the file.
INSTANTIATE_TEST_SUITE_P(Escapes, ExpressionPosition,
                         testing::Values(Placed{R"("\u0061 + b")", 4, 15}, Placed{R"("a\t\u002b \U00000062")", 4, 16},
                                         Placed{"\"\"\"a \\\n   + b\"\"\"", 5, 6},
                                         Placed{"\"\"\"\r\na\\t +\r\n b\"\"\"", 6, 2}));

TEST(TomlModel, ErrorsBehindAnEscapeNameTheirColumn) {
  const auto model = parse_model("[model]\nname = 'm'\n[dynamics]\nx = \"\\u0061 + )\"\n", "m.toml");
  ASSERT_FALSE(model);
  EXPECT_EQ(model.error().location.line, 4);
  EXPECT_EQ(model.error().location.column, 15);
}

TEST(TomlModel, AByteOrderMarkIsNoPartOfTheText) {
  const std::string plain = "[model]\nname = 'm'\n";
  const auto marked = parsed_file("\xEF\xBB\xBF" + plain);
  EXPECT_EQ(marked.description.name, "m");
  EXPECT_NE(marked.sha256, parsed_file(plain).sha256);  // the fingerprint is that of the bytes
  const auto refused = parse_model("\xEF\xBB\xBFnam = 1\n", "m.toml");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().location.column, 1);
  EXPECT_FALSE(parse_model("\xEF\xBB\xBF", "m.toml"));
}

TEST(TomlModel, NamesAndTablesCarryTheirPositions) {
  const auto model = parsed_file(whole);
  EXPECT_EQ(model.description.states[1].location.line, 13);
  EXPECT_EQ(model.description.states[1].location.column, 1);
  EXPECT_EQ(model.description.states[1].initial->location.line, 13);
  EXPECT_EQ(model.description.events[1].location.line, 38);
}

TEST(TomlModel, TooManyRowsAreToldAtTheirOption) {
  const auto checked =
      check_options(parsed_file("[model]\nname='m'\n[simulate]\nuntil = 1\noutput = { every = 1e-9 }\n"));
  ASSERT_FALSE(checked);
  EXPECT_EQ(checked.error().location.line, 5);
  EXPECT_NE(checked.error().message.find("1e+09 rows"), std::string::npos) << checked.error().message;
}

TEST(TomlModel, ProblemsBetweenOptionsNameTheirPlace) {
  const auto model = parsed_file("[model]\nname='m'\n[simulate]\nuntil = 1\noutput = { times = [0.5, 2] }\n");
  const auto checked = check_options(model);
  ASSERT_FALSE(checked);
  EXPECT_EQ(checked.error().location.line, 5);
  EXPECT_NE(checked.error().message.find("output time 2"), std::string::npos);
  const auto without_end = check_options(parsed_file("[model]\nname='m'\n[states]\nx=0\n[dynamics]\nx=1\n"));
  ASSERT_FALSE(without_end);
  EXPECT_NE(without_end.error().message.find("no end time"), std::string::npos);
}

// Whatever a text has become, the answer is a model or an error with a message and a place within the text.
TEST(TomlModel, DamagedTextsAreReadOrRefusedNeverWorse) {
  std::mt19937 random(20240701);
  const auto below = [&](std::size_t end) { return std::uniform_int_distribution<std::size_t>(0, end - 1)(random); };
  constexpr std::string_view alphabet = "\"'=[]{}.,#-+*/()\n xt1e";
  const auto lines = static_cast<int>(std::count(whole.begin(), whole.end(), '\n'));
  int refused = 0;
  for (int round = 0; round < 3000; ++round) {
    std::string text(whole);
    for (std::size_t changes = 1 + below(3); changes > 0; --changes) {
      const auto place = below(text.size());
      const std::string piece(1 + below(2), alphabet[below(alphabet.size())]);
      below(2) == 0 ? text.replace(place, below(20), piece) : text.insert(place, piece);
    }
    const auto model = parse_model(text, "m.toml");
    if (model) continue;
    ++refused;
    EXPECT_FALSE(model.error().message.empty());
    EXPECT_GE(model.error().location.line, 0);
    EXPECT_LE(model.error().location.line, lines + 7);
  }
  EXPECT_GT(refused, 1000);
}

TEST(TomlModel, AHundredLevelsOfEverythingAreReadOrRefused) {
  std::string keys = "a";
  for (int i = 0; i < 30; ++i) keys += ".a";
  std::string text = "[model]\nname = 'm'\n[states]\n";
  for (int level = 0; level < 250; ++level) text += keys + " = { ";
  text += keys + " = 1" + std::string(250, '}');
  EXPECT_FALSE(parse_model(text, "m.toml"));
}

TEST(Settings, ReachOptionsInputsAndExpressions) {
  auto model = parsed_file(whole);
  const std::vector<std::pair<std::string, std::string>> settings{{"simulate.rtol", "1e-6"},
                                                                  {"simulate.until", "2*pi"},
                                                                  {"simulate.event.integrator", "\"dopri5\""},
                                                                  {"simulate.output.every", "1/4"},
                                                                  {"simulate.initial_mode.slip", "-1"},
                                                                  {"simulate.event.max_step", "none"},
                                                                  {"simulate.inputs.w", "t^2"},
                                                                  {"simulate.inputs.u", "cos(t)"},
                                                                  {"states.a.lower", "-3"},
                                                                  {"dynamics.z", "'2*a'"},
                                                                  {"parameters.mu", "0.5"},
                                                                  {"model.inclusion", "filippov"}};
  for (const auto& [key, value] : settings) {
    auto changed = with_setting(model, key, value);
    ASSERT_TRUE(changed) << key << "\n" << to_text(changed.error());
    model = std::move(*changed);
  }
  EXPECT_EQ(model.simulate.rtol, 1e-6);
  EXPECT_EQ(model.simulate.until, 2 * 3.14159265358979323846);
  EXPECT_EQ(model.simulate.event.integrator, pipeline::Integrator::dopri5);
  EXPECT_EQ(std::get<pipeline::EveryInterval>(model.simulate.output).interval, 0.25);
  EXPECT_EQ(model.simulate.initial_mode[0].second, -1);
  EXPECT_EQ(model.simulate.event.max_step, std::nullopt);
  EXPECT_EQ(names(model.description.inputs), (std::vector<std::string>{"u", "w"}));
  EXPECT_EQ(expression::to_text(*model.description.inputs[0].expression), "cos(t)");
  EXPECT_EQ(expression::to_text(*model.description.states[1].lower), "-3");
  EXPECT_EQ(expression::to_text(*model.description.dynamics[0].expression), "2*a");
  EXPECT_EQ(expression::to_text(*model.description.parameters[0].expression), "0.5");
  EXPECT_EQ(model.description.inclusion, model::Inclusion::filippov);
}

TEST(Settings, ReachHowTimeStandsStillWhetherTheFileSaysItOrNot) {
  auto model = with_setting(parsed_file(whole), "time_freezing.a_n", "5*mu");
  ASSERT_TRUE(model) << to_text(model.error());
  model = with_setting(std::move(*model), "time_freezing.stabilisation", "{ initial = 10, final = 2 }");
  model = with_setting(std::move(*model), "time_freezing.penetration", "infinity");
  ASSERT_TRUE(model) << to_text(model.error());
  EXPECT_EQ(expression::to_text(*model->description.clock->a_n), "5*mu");
  EXPECT_EQ(expression::to_text(*model->description.clock->stabilisation_initial), "10");
  model = with_setting(std::move(*model), "time_freezing.stabilisation", "3");
  ASSERT_TRUE(model) << to_text(model.error());
  EXPECT_EQ(model->description.clock->stabilisation_initial, nullptr);
  EXPECT_EQ(expression::to_text(*model->description.clock->stabilisation), "3");
  EXPECT_EQ(expression::to_text(*model->description.clock->a_n), "5*mu");
}

TEST(Settings, ReachListsAndNamesWithDots) {
  const auto options = with_option({}, "simulate.output.times", "[0, 1/2, 1]");
  ASSERT_TRUE(options);
  EXPECT_EQ(std::get<pipeline::AtTimes>(options->output).times, (std::vector<double>{0, 0.5, 1}));
  const auto mode = with_option({}, "simulate.initial_mode.v-0.2", "1");
  ASSERT_TRUE(mode);
  EXPECT_EQ(mode->initial_mode[0].first, "v-0.2");
}

struct Refused {
  const char* key;
  const char* value;
  const char* expected;
};

class RefusedSetting : public testing::TestWithParam<Refused> {};

TEST_P(RefusedSetting, SaysWhyAndWhichKey) {
  const auto changed = with_setting(parsed_file(whole), GetParam().key, GetParam().value);
  ASSERT_FALSE(changed);
  const auto text = to_text(changed.error());
  EXPECT_NE(text.find(GetParam().expected), std::string::npos) << text;
  EXPECT_NE(text.find(std::string("--set ") + GetParam().key), std::string::npos) << text;
}

INSTANTIATE_TEST_SUITE_P(Cases, RefusedSetting,
                         testing::Values(Refused{"simulate.rtoll", "1", "did you mean 'simulate.rtol'"},
                                         Refused{"simulate.integrator", "dopri5",
                                                 "did you mean 'simulate.event.integrator'"},
                                         Refused{"simulate.rtol", "0", "expected a finite number > 0, found 0"},
                                         Refused{"simulate.rtol", "tight", "found \"tight\""},
                                         Refused{"simulate.rtol", "nan", "expected a finite number > 0"},
                                         Refused{"simulate.method", "fesdd", "did you mean 'fesd'"},
                                         Refused{"simulate.event.integrator", "dopri6", "did you mean 'dopri5'"},
                                         Refused{"simulate.event.branches", "0", "a whole number >= 1"},
                                         Refused{"simulate.inputs.u", "sin(", "simulate.inputs.u"},
                                         Refused{"states.y", "1", "the model has no 'y'"},
                                         Refused{"states.z.lowr", "1", "'lowr' is no part of 'z'"},
                                         Refused{"dynamics.z.lower", "1", "other names have none"},
                                         Refused{"modes.0.when", "x > 0", "nothing in 'modes' can be set"},
                                         Refused{"events.returns.when", "z", "write a parameter there"},
                                         Refused{"jumps.dose.delay", "1", "nothing in 'jumps' can be set"},
                                         Refused{"spam.z", "1", "'spam' is no table of a model file"},
                                         Refused{"simulate.fesd.lifting", "1", "from 2 to 64"},
                                         Refused{"time_freezing.a_n", "-1", "it is a positive number"},
                                         Refused{"time_freezing.stifness", "1", "did you mean 'stiffness'"},
                                         Refused{"statess.z", "1", "did you mean 'states'"},
                                         Refused{"dynamics.a", "1 +", "--set dynamics.a:1:"},
                                         Refused{"model.inclusion", "filipov", "did you mean 'filippov'"}));

}  // namespace
}  // namespace saltus::io
