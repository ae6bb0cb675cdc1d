// Systems stated in C++.
#include "saltus/model/builder.hpp"

#include <ctime>

#include "built_system.hpp"
#include "model_text.hpp"

namespace saltus::model {
namespace {

using casadi::SX;

TEST(BuilderTest, StickSlip) {
  Builder model("stick-slip");
  const SX mu = model.parameter("mu", 0.8);
  const SX q = model.state("q", {0.04}), v = model.state("v", {-0.01});
  const SX u = model.control("u", {.initial = 0.5, .lower = -5, .upper = 5});
  const SX slip = model.switching("slip", v - 0.2);
  model.dynamics("q", v);
  model.dynamics("v", -q + u - mu * model.sign(slip));
  model.output("power", mu * model.sign(5 * slip) * v);
  model.event(q, {.name = "returns", .direction = Direction::up});
  model.event(greater(q, SX(1)) && !less_equal(v, SX(0)), {.action = AtEvent::stop});
  const System system = finished(model);
  EXPECT_EQ(columns(system), Names{"slip"});
  EXPECT_EQ(values(system, system.f, {1.0, 2.0}, {1.0}), (std::vector<double>{2.0, -1.0 + 0.5 - 0.8}));
  EXPECT_EQ(system.events[1].name, "event2");
  EXPECT_EQ(system.events[1].guards.numel(), 2);
  EXPECT_TRUE(system.warnings.empty());
}

TEST(BuilderTest, UnnamedFunctionsAreNamedByTheirExpression) {
  Builder model("names");
  const SX x = model.state("x", {1.0}), y = model.state("y", {2.0});
  const SX step = model.step(x - y);
  model.dynamics("x", step + model.if_(less(x, SX(3), "limit"), SX(1), SX(2)));
  model.dynamics("y", model.max(x, y) + model.min(x, 2 * y) + model.abs(y));
  const System system = finished(model);
  EXPECT_EQ(columns(system), (Names{"(x-y)", "limit"}));
}

TEST(BuilderTest, RemediesAreThoseOfAProgram) {
  Builder model("still");
  model.state("x", {1.0});
  const auto built = model.build();
  ASSERT_FALSE(built);
  EXPECT_EQ(built.error().remedy, "call dynamics(\"x\", …), or name it in a mode; a constant state gets 0");
}

TEST(BuilderTest, NonsmoothCasadiOperationsAreRefused) {
  const std::vector<std::pair<std::string, SX (*)(const SX&)>> cases{
      {"builder's sign", [](const SX& x) { return SX(sign(x)); }},
      {"builder's abs", [](const SX& x) { return SX(fabs(x)); }},
      {"builder's max", [](const SX& x) { return SX(fmax(x, 0)); }},
      {"builder's min", [](const SX& x) { return SX(fmin(x, 0)); }},
      {"if_", [](const SX& x) { return SX(if_else(x > 0, x, 0)); }},
      {"if_", [](const SX& x) { return SX(x < 1); }},
      {"floor and mod", [](const SX& x) { return SX(floor(x)); }},
  };
  for (const auto& [remedy, make] : cases) {
    Builder model("raw");
    const SX x = model.state("x", {1.0});
    model.dynamics("x", 1 + make(x));
    const auto system = model.build();
    ASSERT_FALSE(system.has_value()) << remedy;
    EXPECT_NE(system.error().remedy.find(remedy), std::string::npos) << to_text(system.error());
  }
}

TEST(BuilderTest, MistakesAreKeptAndReturned) {
  Builder foreign("foreign");
  foreign.state("x", {1.0});
  foreign.dynamics("x", foreign.sign(SX::sym("z")));
  EXPECT_NE(foreign.build().error().message.find("'z'"), std::string::npos);

  Builder shape("shape");
  const SX x = shape.state("x", {1.0});
  shape.dynamics("x", vertcat(x, x));
  EXPECT_NE(shape.build().error().message.find("2 x 1"), std::string::npos);

  Builder twice("twice");
  twice.state("x", {1.0});
  twice.parameter("x", 2.0);
  EXPECT_NE(twice.build().error().message.find("'x' is already a state"), std::string::npos);

  Builder missing("missing");
  missing.state("speed", {1.0});
  missing.dynamics("sped", SX(1));
  EXPECT_NE(missing.build().error().remedy.find("'speed'"), std::string::npos);
}

TEST(BuilderTest, FiveHundredThresholdsTakeWellUnderASecond) {
  const std::clock_t start = std::clock();  // of this process: others do not count
  Builder model("network");
  constexpr int size = 500;
  std::vector<SX> x;
  for (int i = 0; i < size; ++i) x.push_back(model.state("x" + std::to_string(i), {0.01 * i}));
  for (std::size_t i = 0; i < size; ++i) {
    const SX& left = x[(i + 1) % size];
    const SX& right = x[(i + 7) % size];
    model.dynamics("x" + std::to_string(i),
                   -x[i] + 2 * model.step(left - 0.5 - 1e-3 * static_cast<double>((i + 1) % size)) *
                               (1 - model.step(right - 0.5 - 1e-3 * static_cast<double>((i + 7) % size))));
  }
  const System system = finished(model);
  const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  EXPECT_EQ(system.columns.size(), static_cast<std::size_t>(size));
  // Some 0.1 s in a release build; the allowance is for sanitizers.
  EXPECT_LT(seconds, 5.0);
  RecordProperty("milliseconds", static_cast<int>(1e3 * seconds));
}

}  // namespace
}  // namespace saltus::model
