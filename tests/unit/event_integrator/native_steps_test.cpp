// Steps whose stages are native code against those that call one function after the other: no bit differs.
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <unistd.h>

#include <gtest/gtest.h>

#include "run_model.hpp"
#include "saltus/event_integrator/integrate.hpp"
#include "saltus/model/builder.hpp"

namespace saltus::event_integrator {
namespace {

using casadi::SX;
using evaluation::NativeCode;
using model::Builder;
namespace fs = std::filesystem;

/// A cache folder of its own, gone afterwards.
class NativeStepsTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("saltus-native-steps-test-" + std::to_string(getpid()));
    fs::remove_all(folder_);
    setenv("SALTUS_CACHE", folder_.c_str(), 1);
  }
  void TearDown() override {
    unsetenv("SALTUS_CACHE");
    fs::remove_all(folder_);
  }
  fs::path folder_;
};

bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0);
}

Integration run(const model::System& system, NativeCode native, const IntegrationOptions& options) {
  auto kernel = evaluation::ModelKernel::compile(system, native);
  EXPECT_TRUE(kernel.has_value()) << (kernel ? "" : kernel.error().message);
  evaluation::FieldConstants constants;
  const std::vector<double> alpha(system.switching.size(), 0.0);
  kernel->prepare_field(alpha.data(), constants);
  EXPECT_EQ(constants.has_steps(), native == NativeCode::on);
  return integrate(*kernel, options);
}

/// Runs with both explicit methods; returns how many events there were.
std::size_t expect_same_bits(Builder& builder, double until, const ode::Tolerances& tolerances = {1e-8, 1e-10}) {
  const auto system = builder.build();
  EXPECT_TRUE(system.has_value()) << (system ? "" : system.error().message);
  std::size_t events = 0;
  for (const auto method : {ode::Method::dopri5, ode::Method::dop853, ode::Method::taylor}) {
    IntegrationOptions options;
    options.method = method;
    options.tolerances = tolerances;
    options.until = until;
    options.output.times = {0.1 * until, 0.55 * until};
    const auto one = run(*system, NativeCode::off, options);
    const auto other = run(*system, NativeCode::on, options);
    EXPECT_EQ(one.status.termination, other.status.termination);
    EXPECT_EQ(one.status.message, other.status.message);
    EXPECT_EQ(one.statistics.steps, other.statistics.steps);
    EXPECT_EQ(one.statistics.rejected, other.statistics.rejected);
    EXPECT_EQ(one.statistics.rhs_evaluations, other.statistics.rhs_evaluations);
    EXPECT_TRUE(same_bits(one.final.x, other.final.x));
    EXPECT_TRUE(same_bits(one.final.alpha, other.final.alpha));
    EXPECT_TRUE(same_bits(one.trajectory.t, other.trajectory.t));
    EXPECT_EQ(one.trajectory.x.size(), other.trajectory.x.size());
    for (std::size_t k = 0; k < std::min(one.trajectory.x.size(), other.trajectory.x.size()); ++k) {
      EXPECT_TRUE(same_bits(one.trajectory.x[k], other.trajectory.x[k])) << "row " << k;
      EXPECT_TRUE(same_bits(one.trajectory.alpha[k], other.trajectory.alpha[k])) << "row " << k;
    }
    EXPECT_EQ(one.events.size(), other.events.size());
    for (std::size_t k = 0; k < std::min(one.events.size(), other.events.size()); ++k) {
      EXPECT_EQ(one.events[k].t, other.events[k].t) << "event " << k;
      EXPECT_EQ(one.events[k].kind, other.events[k].kind) << "event " << k;
    }
    events = one.events.size();
  }
  return events;
}

TEST_F(NativeStepsTest, AlongASurfaceThatIsACoordinate) {
  // Stick and slip: sliding on v = 0.2 with the nonlinear friction of both sides.
  Builder b("stick-slip");
  const SX x = b.state("x", {1});
  const SX v = b.state("v", {0});
  b.dynamics("x", v);
  b.dynamics("v", -x - b.sign(v - 0.2) / (1 + 3 * (v - 0.2) * (v - 0.2)));
  EXPECT_GE(expect_same_bits(b, 30), 4U);
}

TEST_F(NativeStepsTest, AlongASurfaceThatIsNot) {
  Builder b("relay");
  const SX x = b.state("x", {0.3});
  const SX y = b.state("y", {-0.5});
  const SX z = b.state("z", {0.7});
  const SX u = b.sign(x + 0.5 * y - 0.25 * z);
  b.dynamics("x", y - u);
  b.dynamics("y", z - 2 * u);
  b.dynamics("z", -x - 2 * y - 3 * z - 0.5 * u);
  EXPECT_GE(expect_same_bits(b, 20), 1U);
}

TEST_F(NativeStepsTest, AlongSurfacesThatMove) {
  Builder b("moving");
  const SX t = b.time();
  const SX x = b.state("x", {1});
  const SX y = b.state("y", {0.5});
  b.dynamics("x", -2 * b.sign(x - 0.1 * t) + 0.3 * y);
  b.dynamics("y", sin(3 * t) - b.sign(y + 0.3 * x + 0.2 * t) + 0.1 * y * y);
  EXPECT_GE(expect_same_bits(b, 8), 2U);
}

TEST_F(NativeStepsTest, WhereStagesAreUndefined) {
  // Stages of too long steps lie where the root, or the logarithm, is none.
  Builder b("root");
  const SX x = b.state("x", {1});
  const SX y = b.state("y", {1});
  b.dynamics("x", -2 * sqrt(x) * b.step(x - 1e-6));
  b.dynamics("y", -y * log(y + 1e-3));
  EXPECT_GE(expect_same_bits(b, 3, {1e-3, 1e-3}), 1U);
}

TEST_F(NativeStepsTest, OfTenStatesBesideSurfacesAndAlongOne) {
  // Along a surface so many states have no steps of their own.
  Builder b("ten");
  std::vector<SX> x;
  for (int i = 0; i < 10; ++i) x.push_back(b.state("x" + std::to_string(i), {0.1 * i - 0.45}));
  b.dynamics("x0", 0.3 * x[9] - b.sign(x[0]));
  for (std::size_t i = 1; i < 10; ++i) b.dynamics("x" + std::to_string(i), 2 * b.step(x[i - 1]) - x[i]);
  EXPECT_GE(expect_same_bits(b, 8), 2U);
}

TEST_F(NativeStepsTest, ALargeFieldGoesWithoutThem) {
  Builder b("large");
  std::vector<SX> x;
  for (int i = 0; i < 13; ++i) x.push_back(b.state("x" + std::to_string(i), {0.1 * i}));
  for (int i = 0; i < 13; ++i) b.dynamics("x" + std::to_string(i), -x[static_cast<std::size_t>(i)]);
  const auto system = b.build();
  ASSERT_TRUE(system.has_value());
  auto kernel = evaluation::ModelKernel::compile(*system, NativeCode::on);
  ASSERT_TRUE(kernel.has_value()) << kernel.error().message;
  evaluation::FieldConstants constants;
  kernel->prepare_field(nullptr, constants);
  EXPECT_NE(constants.direct, nullptr);
  EXPECT_FALSE(constants.has_steps());
}

}  // namespace
}  // namespace saltus::event_integrator
