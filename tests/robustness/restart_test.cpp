// Restarts on and near events: no event is found twice, none is lost.
#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "problems/references.hpp"
#include "problems/simulator.hpp"

namespace saltus::problems {
namespace {

using result::Event;
using result::Result;

/// A flip back: a component of the mode returns within `instant` to the value it just had. The fields of these models
/// are of order one to a thousand: a real return takes longer than that.
constexpr double instant = 1e-9;

bool shares_a_surface(const Event& a, const Event& b) {
  return std::any_of(a.surfaces.begin(), a.surfaces.end(), [&](const std::string& surface) {
    return std::find(b.surfaces.begin(), b.surfaces.end(), surface) != b.surfaces.end();
  });
}

/// Empty if the list is consistent; otherwise what is wrong with it.
std::string complaint(const Result& result) {
  if (result.status.termination != result::Termination::completed) return result.status.message;
  const std::vector<Event>& events = result.events;
  for (std::size_t i = 0; i + 1 < events.size(); ++i) {
    const Event &a = events[i], &b = events[i + 1];
    const std::string where = "events " + std::to_string(i + 1) + " and " + std::to_string(i + 2);
    if (!a.mode_after || !b.mode_before) return where + ": a mode is missing";
    if (*a.mode_after != *b.mode_before) return where + ": the mode changes between events";
    if (b.t < a.t) return where + ": not in order of time";
    if (b.t == a.t && shares_a_surface(a, b)) return where + ": the same surface twice at one time";
    if (a.mode_before && b.t - a.t < instant && *a.mode_before == *b.mode_after) return where + ": there and back";
  }
  return "";
}

struct Restart {
  double t = 0.0;
  std::vector<double> x;
};

std::vector<Restart> restart_points(const Result& result) {
  std::vector<Restart> points;
  for (const Event& event : result.events) points.push_back({event.t, event.x_after});
  return points;
}

const char* const models[] = {"crossing",
                              "two-lines",
                              "rotating-oscillator",
                              "dry-friction-oscillator",
                              "stick-slip",
                              "relay-feedback",
                              "relay-oscillator",
                              "friction-blocks",
                              "half-plane",
                              "sweeping-disc",
                              "circle",
                              "stick-slip-from-outside",
                              "sliding",
                              "leaving-sliding",
                              "irma"};

class Restarts : public testing::TestWithParam<const char*> {};

TEST_P(Restarts, FromTheStateBehindAnEventTheNextEventsFollow) {
  const ReferenceProblem& problem = reference(GetParam());
  Simulator model = Simulator::from_reference(problem);
  const pipeline::SimulateOptions options = with(model.options(), fine);
  const Result whole = model.run(options);
  for (std::size_t i = 0; i < whole.events.size(); ++i) {
    SCOPED_TRACE("restart from event " + std::to_string(i + 1));
    pipeline::SimulateOptions rest = options;
    rest.from = whole.events[i].t;
    model.set_initial_state(whole.events[i].x_after);
    const Result result = model.run(rest);
    EXPECT_EQ(complaint(result), "");
    // x_after is on the surface up to rounding: what happens within an instant belongs to the start
    std::vector<Event> found = switches_of(result);
    std::erase_if(found, [&](const Event& event) { return event.t - rest.from < instant; });
    ASSERT_EQ(found.size(), whole.events.size() - i - 1);
    for (std::size_t k = 0; k < found.size(); ++k) {
      EXPECT_EQ(found[k].kind, whole.events[i + 1 + k].kind);
      EXPECT_EQ(found[k].mode_after, whole.events[i + 1 + k].mode_after);
      EXPECT_NEAR(found[k].t, whole.events[i + 1 + k].t, 1e-8 * std::max(1.0, rest.from));
    }
    EXPECT_EQ(result.final.mode, whole.final.mode);
  }
}

/// Moves a restart point off its event: by nothing, or by a random vector of length 1e-17 … 1e-2.
void disturb(Restart& restart, std::mt19937_64& random) {
  std::uniform_real_distribution<double> exponent(-17.0, -2.0), direction(-1.0, 1.0);
  if (random() % 4 == 0) return;
  const double size = std::pow(10.0, exponent(random));
  for (double& component : restart.x) {
    if (random() % 2 == 0) component += size * direction(random);
  }
}

TEST_P(Restarts, SlowRandomRestartsNearEventsFindNoEventTwice) {
  const ReferenceProblem& problem = reference(GetParam());
  Simulator model = Simulator::from_reference(problem);
  const std::vector<Restart> points = restart_points(model.run(model.options()));
  ASSERT_FALSE(points.empty());
  std::mt19937_64 random(20240229);
  const int restarts = 100000 / static_cast<int>(std::size(models)) + 1;  // 10^5 over all models
  for (int i = 0; i < restarts; ++i) {
    Restart restart = points[random() % points.size()];
    disturb(restart, random);
    model.set_initial_state(restart.x);
    const Accuracy accuracies[] = {standard, fine, {pipeline::Integrator::dopri5, 1e-4, 1e-6}};
    pipeline::SimulateOptions options = with(model.options(), accuracies[random() % 3]);
    options.from = restart.t;
    options.until = restart.t + 0.02 * problem.until;
    options.output = pipeline::NumberOfPoints{2};
    const Result result = model.run(options);
    ASSERT_EQ(complaint(result), "") << "restart " << i << " from t = " << restart.t << ", x[0] = " << restart.x[0];
  }
}

INSTANTIATE_TEST_SUITE_P(Models, Restarts, testing::ValuesIn(models), [](const auto& instance) {
  std::string name = instance.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

}  // namespace
}  // namespace saltus::problems
