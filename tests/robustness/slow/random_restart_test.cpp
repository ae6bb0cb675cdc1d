// A hundred thousand restarts, a tenth of them in `make test`, on and near events find no event twice.
#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "campaign.hpp"
#include "problems/consistency.hpp"
#include "problems/references.hpp"
#include "problems/simulator.hpp"

namespace saltus::problems {
namespace {

using result::Event;
using result::Result;

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

class RandomRestarts : public testing::TestWithParam<const char*> {};

/// Moves a restart point off its event: by nothing, or by a random vector of length 1e-17 … 1e-2.
void disturb(Restart& restart, std::mt19937_64& random) {
  std::uniform_real_distribution<double> exponent(-17.0, -2.0), direction(-1.0, 1.0);
  if (random() % 4 == 0) return;
  const double size = std::pow(10.0, exponent(random));
  for (double& component : restart.x) {
    if (random() % 2 == 0) component += size * direction(random);
  }
}

TEST_P(RandomRestarts, NearEventsFindNoEventTwice) {
  const ReferenceProblem& problem = reference(GetParam());
  Simulator model = Simulator::from_reference(problem);
  const std::vector<Restart> points = restart_points(model.run(model.options()));
  ASSERT_FALSE(points.empty());
  std::mt19937_64 random(20240229);
  const int restarts = of_campaign(100000) / static_cast<int>(std::size(models)) + 1;  // 10^5 over all models
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

INSTANTIATE_TEST_SUITE_P(Models, RandomRestarts, testing::ValuesIn(models), [](const auto& instance) {
  std::string name = instance.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

}  // namespace
}  // namespace saltus::problems
