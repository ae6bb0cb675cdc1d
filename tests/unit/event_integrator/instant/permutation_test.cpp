// The order of surfaces and jumps in a model changes nothing but rounding.
#include <algorithm>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "../run_model.hpp"

namespace saltus::event_integrator::testing::permutation {
namespace {

using casadi::SX;

/// Numbers of one model, whatever order it is stated in.
struct Numbers {
  explicit Numbers(std::uint32_t seed)
      : states(2 + static_cast<int>(seed % 3)), surfaces(2 + static_cast<int>(seed / 3 % 3)), random_(seed) {
    for (int k = 0; k < 200; ++k) values_.push_back(2.0 * static_cast<double>(random_()) / 4294967295.0 - 1.0);
  }
  [[nodiscard]] double at(int kind, int i, int j = 0) const {
    return values_[static_cast<std::size_t>((37 * kind + 11 * i + 5 * j) % 200)];
  }
  int states, surfaces;

 private:
  std::mt19937 random_;
  std::vector<double> values_;
};

/// x' = A x + b + sum_j c_j sgn(n_j . x - d_j), with jumps that throw x_i back where it leaves a ball; surfaces and
/// jumps in the order that is given.
Integration run(const Numbers& numbers, const std::vector<int>& order) {
  model::Builder model("permuted");
  std::vector<SX> x;
  for (int i = 0; i < numbers.states; ++i) x.push_back(model.state("x" + std::to_string(i), {numbers.at(0, i)}));
  std::map<int, SX> sign;
  for (const int j : order) {
    SX psi = 0.3 * numbers.at(1, j);
    for (int i = 0; i < numbers.states; ++i) psi += numbers.at(2, i, j) * x[static_cast<std::size_t>(i)];
    sign[j] = model.sign(model.switching("s" + std::to_string(j), psi));
  }
  for (int i = 0; i < numbers.states; ++i) {
    SX rate = 0.3 * numbers.at(3, i) - 0.2 * x[static_cast<std::size_t>(i)];
    for (int k = 0; k < numbers.states; ++k) {
      if (k != i) rate += 2.0 * numbers.at(4, i, k) * x[static_cast<std::size_t>(k)];
    }
    for (int j = 0; j < numbers.surfaces; ++j) rate += numbers.at(5, i, j) * sign[j];
    model.dynamics("x" + std::to_string(i), rate);
  }
  for (const int j : order) {
    if (j >= numbers.states) continue;
    const std::string name = "x" + std::to_string(j);
    const SX& state = x[static_cast<std::size_t>(j)];
    model.jump(state - 1.5, model::Direction::up, {{name, 0.25 * state}}, {.name = "back" + name});
  }
  return run_model(model, 6.0, {1e-9, 1e-11});
}

TEST(Permutations, OfSurfacesAndJumpsChangeNothing) {
  int compared = 0, with_jumps = 0;
  for (std::uint32_t seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE(seed);
    const Numbers numbers(seed);
    std::vector<int> order;
    for (int j = 0; j < numbers.surfaces; ++j) order.push_back(j);
    const auto one = run(numbers, order);
    std::reverse(order.begin(), order.end());
    const auto other = run(numbers, order);
    const auto open = [](const Integration& run) {
      return std::any_of(run.events.begin(), run.events.end(), [](const auto& event) { return event.unique != true; });
    };
    EXPECT_EQ(one.status.termination, other.status.termination) << one.status.message << other.status.message;
    if (open(one) || open(other)) continue;  // which of several motions is followed may depend on the order
    ASSERT_EQ(one.events.size(), other.events.size());
    for (std::size_t k = 0; k < one.events.size(); ++k) {
      EXPECT_NEAR(one.events[k].t, other.events[k].t, 1e-6);
      EXPECT_EQ(one.events[k].kind, other.events[k].kind);
      with_jumps += one.events[k].kind == result::EventKind::jump ? 1 : 0;
    }
    for (std::size_t i = 0; i < one.final.x.size(); ++i) EXPECT_NEAR(one.final.x[i], other.final.x[i], 1e-5);
    ++compared;
  }
  EXPECT_GT(compared, 130);
  EXPECT_GT(with_jumps, 15);
}

}  // namespace
}  // namespace saltus::event_integrator::testing::permutation
