// Steps of time in what is slid on, what a jump reads at the time of a step, and quantities while a surface slides.
#include <cmath>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "problems/simulator.hpp"

namespace saltus::problems {
namespace {

using result::Result;
using result::Termination;

Result run(const std::string& text) {
  const Simulator model = Simulator::from_text(text);
  return model.run(model.options());
}

/// A relay that stands still on its reference, of second order, until the reference steps or ramps.
std::string stepped_loop(const std::string& reference, const std::string& field) {
  return fmt::format(R"toml([model]
name = "stepped-loop"
[states]
y = 0
v = 0
[definitions]
r = "{}"
e = "r - y"
[dynamics]
y = "v"
v = "{}"
[simulate]
until = 5
)toml",
                     reference, field);
}

// From t = 1 on v' = 1 - v until y = 1, at 1 + s with s + exp(-s) = 2.
TEST(StepsOfTime, EndSlidingOfSecondOrder) {
  const Result result = run(stepped_loop("if(t < 1, 0, 1)", "sign(e) - v"));
  ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
  double since = 2.0;
  for (int pass = 0; pass < 60; ++pass) since = 2.0 - std::exp(-since);
  ASSERT_GE(result.events.size(), 3u);
  EXPECT_EQ(result.events[1].t, 1.0);
  EXPECT_EQ(result.events[1].mode_after, std::vector<int>{1});
  EXPECT_NEAR(result.events[2].t, 1.0 + since, 1e-8);
}

// A step is a step, however it is written: before, after, as a steep ramp, beside friction.
TEST(StepsOfTime, AreTheSameHoweverTheyAreWritten) {
  const std::string field = "4*e + 0.5*sign(e) - v - 0.2*sign(v)";
  const Result wanted = run(stepped_loop("if(t < 1, 0, 1)", field));
  ASSERT_EQ(wanted.status.termination, Termination::completed) << wanted.status.message;
  for (const auto& [reference, tolerance] : {std::pair{"step(t - 1)", 1e-8}, std::pair{"0.5 + 0.5*sign(t - 1)", 1e-8},
                                             std::pair{"max(0, min(1, 1e6*(t - 1)))", 1e-5}}) {
    const Result result = run(stepped_loop(reference, field));
    ASSERT_EQ(result.status.termination, Termination::completed) << reference << ": " << result.status.message;
    for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(result.final.x[i], wanted.final.x[i], tolerance) << reference;
  }
}

// A sample at the time of a step reads what holds from there on.
TEST(StepsOfTime, AreSeenByASampleAtTheirTime) {
  const auto text = [](const std::string& controls, const std::string& value, const std::string& inputs) {
    return "[model]\nname = \"sampled\"\n" + controls +
           "[states]\nheld = 0\n[dynamics]\nheld = 0\n[[jumps]]\nevery = 0.1\n" + "set = { held = \"" + value +
           "\" }\n[simulate]\nuntil = 1.05\n" + inputs;
  };
  const std::string controls = "[controls]\nr = 0\n";
  for (const auto& model :
       {text("", "if(t < 1, 0, 1)", ""), text(controls, "r", "inputs = { r = { times = [0, 1], values = [0, 1] } }\n"),
        text(controls, "r", "inputs = { r = \"if(t < 1, 0, 1)\" }\n"), text("", "floor(t)", "")}) {
    const Result result = run(model);
    ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
    EXPECT_EQ(result.final.x[0], 1.0) << model;
  }
}

// A relay of 24 volts that is on for half of the time: its power is the mean of both, for whoever reads it.
TEST(Quantities, AreTheMixtureWhileASurfaceSlides) {
  const std::string text = R"toml([model]
name = "power"
[states]
i = 2
E = 0
[definitions]
u = "24*step(1 - i)"
power = "u^2/100"
[dynamics]
i = "u - 12"
E = "power"
[outputs]
record = ["u", "power"]
[[events]]
name = "high"
when = "power > 2"
[simulate]
until = 2
)toml";
  for (const auto method : {pipeline::Method::event, pipeline::Method::fesd, pipeline::Method::smoothed}) {
    const Simulator model = Simulator::from_text(text);
    auto options = model.options();
    options.method = method;
    const Result result = model.run(options);
    ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
    EXPECT_NEAR(result.final.outputs[0], 12.0, 1e-6);
    EXPECT_NEAR(result.final.outputs[1], 2.88, 1e-6);
  }
}

}  // namespace
}  // namespace saltus::problems
