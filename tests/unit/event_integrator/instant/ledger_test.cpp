// What is at zero at one time, and signs that outlive it.
#include "saltus/event_integrator/point/ledger.hpp"

#include <vector>

#include "instants.hpp"

namespace saltus::event_integrator::testing::ledgers {
namespace {

using casadi::SX;
using model::Builder;
using Functions = std::vector<int>;

/// Function 0 is a surface, 1 and 2 are expressions of [[events]].
Builder slipping() {
  Builder model("slipping");
  const SX v = model.state("v", {1.0});
  model.dynamics("v", -model.sign(v));
  model.event(v - 0.5, {.name = "half"});
  model.event(v - 0.25, {.name = "quarter"});
  return model;
}

TEST(Ledger, ZerosEndWithTheirTimeAndSignsGoOn) {
  Builder model = slipping();
  const auto kernel = *evaluation::ModelKernel::compile(*model.build());
  Ledger ledger(kernel);
  ledger.begin(1.0);
  ledger.put(2, -1, 2);
  ledger.add(0);
  ledger.begin(1.0);
  EXPECT_EQ(ledger.zeros(), (Functions{2, 0}));
  EXPECT_EQ(ledger.order(2), 2);
  ledger.begin(1.5);
  EXPECT_TRUE(ledger.zeros().empty());
  EXPECT_EQ(ledger.order(2), 0);
  EXPECT_EQ(ledger.signs(), (std::vector<int>{0, -1}));
}

TEST(Ledger, AFunctionIsInItOnceWithItsLastOrder) {
  Builder model = slipping();
  const auto kernel = *evaluation::ModelKernel::compile(*model.build());
  Ledger ledger(kernel);
  ledger.begin(0.0);
  ledger.add(1);
  ledger.put(1, 1, 2);
  EXPECT_EQ(ledger.zeros(), Functions{1});
  EXPECT_EQ(ledger.order(1), 2);
  EXPECT_EQ(ledger.sign(1), 1);
}

TEST(Ledger, SurfacesAndUserFunctionsLeaveApart) {
  Builder model = slipping();
  const auto kernel = *evaluation::ModelKernel::compile(*model.build());
  Ledger ledger(kernel);
  ledger.begin(0.0);
  for (const int function : {0, 1, 2}) ledger.add(function);
  ledger.forget_surfaces();
  EXPECT_EQ(ledger.zeros(), (Functions{1, 2}));
  ledger.drop([](int function) { return function == 1; });
  EXPECT_FALSE(ledger.has(1));
  ledger.forget_users();
  EXPECT_TRUE(ledger.zeros().empty());
}

}  // namespace
}  // namespace saltus::event_integrator::testing::ledgers
