// Optima of the catalogue's models, as they are shipped, against the numbers in their first lines.
#include <algorithm>
#include <filesystem>
#include <ostream>
#include <string>
#include <tuple>

#include <gtest/gtest.h>

#include "ocp_models.hpp"
#include "source_folder.hpp"

namespace saltus::ocp_tests {
namespace {

struct Shipped {
  std::string model;
  double optimum;
  double tolerance;  ///< relative above 1: half a unit of the last digit of the reference
};

void PrintTo(const Shipped& shipped, std::ostream* out) { *out << shipped.model; }

result::Result optimum_of(const std::string& model) {
  const auto file = tests::source_folder("models") / (model + ".toml");
  auto read = io::read_model(file);
  EXPECT_TRUE(read) << (read ? "" : to_text(read.error()));
  auto ocp = model::build_ocp(read->description);
  EXPECT_TRUE(ocp) << (ocp ? "" : to_text(ocp.error()));
  return optimized({std::move(*ocp), *read->optimize});
}

class OcpCatalogue : public testing::TestWithParam<Shipped> {};

TEST_P(OcpCatalogue, HasItsOptimum) {
  const auto result = optimum_of(GetParam().model);
  ASSERT_EQ(result.status.termination, result::Termination::completed) << result.status.message;
  EXPECT_NEAR(result.optimization->objective, GetParam().optimum,
              GetParam().tolerance * std::max(1.0, GetParam().optimum));
}

INSTANTIATE_TEST_SUITE_P(Models, OcpCatalogue,
                         testing::Values(Shipped{"stewart-anitescu", 1.523772775374957, 1e-9},
                                         Shipped{"turbo-car", 40.0 / 3.0, 1e-9}, Shipped{"estimator", 0.0, 1e-15},
                                         Shipped{"slide-and-hide", 5.3930543536, 1e-10},
                                         Shipped{"slide-and-hide-rates", 5.5921833, 1e-8}),
                         [](const auto& shipped) {
                           std::string name = shipped.param.model;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

/// Problems with many optima: no worse than what others report, and as true as they are shipped.
struct Bounded {
  std::string model;
  double largest;
};

void PrintTo(const Bounded& bounded, std::ostream* out) { *out << bounded.model; }

class OcpCatalogueBound : public testing::TestWithParam<Bounded> {};

TEST_P(OcpCatalogueBound, IsReachedAndTrue) {
  const auto result = optimum_of(GetParam().model);
  ASSERT_EQ(result.status.termination, result::Termination::completed) << result.status.message;
  EXPECT_LE(result.optimization->objective, GetParam().largest * (1.0 + 1e-6));
  ASSERT_TRUE(result.optimization->verification);
  EXPECT_LE(result.optimization->verification->interval_defect, 1e-6);
}

INSTANTIATE_TEST_SUITE_P(Models, OcpCatalogueBound,
                         testing::Values(Bounded{"cart-pole", 71.6794895}, Bounded{"voice-coil-time", 0.0764043593}),
                         [](const auto& bounded) {
                           std::string name = bounded.param.model;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

/// The turbo goes on at v = 15, after 3 s of full thrust, and off at v = 10, 2 s before the end. Both take no time.
TEST(OcpFrozenTime, HysteresisCar) {
  const auto result = optimum_of("hysteresis-car");
  ASSERT_EQ(result.status.termination, result::Termination::completed) << result.status.message;
  EXPECT_NEAR(result.optimization->objective, 10.2292578, 1e-5);
  ASSERT_EQ(result.events.size(), 3U);
  for (const auto& [number, t, v, w] : {std::tuple{1U, 3.0, 15.0, 0.0}, {2U, result.final.t - 2.0, 10.0, 1.0}}) {
    const auto& event = result.events[number];
    EXPECT_NEAR(event.t, t, 1e-7);
    EXPECT_EQ(event.kind, result::EventKind::change_sliding);
    EXPECT_NEAR(event.x[1], v, 1e-7);
    EXPECT_NEAR(event.x[2], w, 1e-7);
    EXPECT_NEAR(event.x_after[2], 1.0 - w, 1e-7);
    EXPECT_EQ(std::count(result.trajectory.t.begin(), result.trajectory.t.end(), event.t), 2);
  }
}

/// Sliding begins and ends inside intervals here.
TEST(OcpDefect, FallsWithTheOrderOfTheScheme) {
  const auto file = tests::source_folder("models/slide-and-hide-rates.toml");
  auto read = io::read_model(file);
  ASSERT_TRUE(read);
  auto ocp = model::build_ocp(read->description);
  ASSERT_TRUE(ocp);
  Stated problem{std::move(*ocp), *read->optimize};
  problem.options.elements = {3};
  double before = 1e-5;
  for (const int stages : {2, 3, 4}) {
    problem.options.element.stages = stages;
    const auto result = optimized(problem);
    ASSERT_EQ(result.status.termination, result::Termination::completed) << result.status.message;
    const double defect = result.optimization->verification->interval_defect;
    EXPECT_LT(defect, before) << stages;
    before = std::max(defect / 100.0, 1e-14);
  }
}

TEST(OcpEstimator, FindsTheSpeedsOfItsData) {
  const auto result = optimum_of("estimator");
  ASSERT_EQ(result.optimization->parameters.size(), 2U);
  EXPECT_NEAR(result.optimization->parameters[0].second, 1.0, 1e-9);
  EXPECT_NEAR(result.optimization->parameters[1].second, 0.4, 1e-9);
}

}  // namespace
}  // namespace saltus::ocp_tests
