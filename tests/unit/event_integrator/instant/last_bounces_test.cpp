// The last bounce before an accumulation, which ends at rest at once.
#include <cmath>

#include "../run_model.hpp"

namespace saltus::event_integrator::testing {
namespace {

using casadi::SX;

/// Coupled masses: the momentum 3 vx + vz knows the force 2 only, whatever the ground at height o does. Where the last
/// bounce is no more than the rounding of o it ends at rest; the limit of the others, extrapolated with it, had lost
/// 2e-7 of that momentum.
TEST(LastBounces, KeepTheMomentumAlongTheGround) {
  for (const auto& [restitution, height] :
       {std::pair{0.359, 3.218}, std::pair{0.311, -4.69}, std::pair{0.195, -2.83}}) {
    SCOPED_TRACE(::testing::Message() << restitution << " " << height);
    model::Builder model("coupled");
    static_cast<void>(model.state("x", {0.0}));
    const SX z = model.state("z", {1.0 + height});
    static_cast<void>(model.state("vx", {1.0}));
    static_cast<void>(model.state("vz", {0.0}));
    SX mass = SX::eye(2);
    mass(0, 0) = 3.0;
    mass(0, 1) = mass(1, 0) = 1.0;
    model.mechanics(
        {.positions = {"x", "z"}, .velocities = {"vx", "vz"}, .mass = mass, .force = {{"vx", 2.0}, {"vz", -10.0}}});
    model.contact("ground", z - height, {.restitution = restitution});
    const auto run = run_model(model, 3.0, {.rtol = 1e-12, .atol = 1e-14});
    ASSERT_EQ(run.status.termination, result::Termination::completed) << run.status.message;
    EXPECT_NEAR(3.0 * run.final.x[2] + run.final.x[3], 9.0, 5e-9);
    EXPECT_EQ(run.final.x[3], 0.0);
    EXPECT_EQ(run.events.back().kind, result::EventKind::accumulation);
  }
}

}  // namespace
}  // namespace saltus::event_integrator::testing
