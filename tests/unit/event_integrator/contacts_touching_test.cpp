// Gaps that close or open with no velocity and no acceleration, at limits of bounces, too.
#include <cmath>
#include <numbers>

#include "run_model.hpp"

namespace saltus::event_integrator::testing {
namespace {

using casadi::SX;
using result::ContactMode;
using result::EventKind;

Integration run_by(model::Builder& model, ode::Method method, const ode::Tolerances& tolerances = {}) {
  IntegrationOptions options;
  options.tolerances = tolerances;
  options.method = method;
  options.until = 2.0;
  return run_model(model, options);
}

constexpr auto methods = {ode::Method::dopri5, ode::Method::dop853, ode::Method::radau5};

/// The height (1 - t)^n comes to 0 so flatly that its rounding leaves the time open, and the speed there with it: up to
/// 1e-9 for n = 3, which is within these tolerances.
TEST(ContactsThatTouch, AFlatApproachIsOneTouchWithoutAnImpact) {
  for (const int n : {3, 5}) {
    for (const double restitution : {0.0, 0.5}) {
      for (const auto method : methods) {
        SCOPED_TRACE(::testing::Message() << n << " " << restitution << " " << static_cast<int>(method));
        model::Builder model("body");
        const SX z = model.state("z", {1.0});
        static_cast<void>(model.state("v", {-static_cast<double>(n)}));
        const SX left = 1.0 - model.time();
        model.mechanics(
            {.positions = {"z"}, .velocities = {"v"}, .force = {{"v", n * (n - 1.0) * pow(left, n - 2.0)}}});
        model.contact("ground", z, {.restitution = restitution});
        const auto run = run_by(model, method, {1e-9, 1e-9});
        ASSERT_EQ(run.status.termination, result::Termination::completed) << run.status.message;
        ASSERT_EQ(run.events.size(), 1U);
        EXPECT_EQ(run.events[0].kind, EventKind::contact);
        EXPECT_NEAR(run.events[0].t, 1.0, 5e-3);
        EXPECT_EQ(run.final.contact_modes, std::vector<ContactMode>{ContactMode::closed});
        EXPECT_EQ(run.final.x[0], 0.0);
        EXPECT_EQ(run.final.x[1], 0.0);
      }
    }
  }
}

/// A force that ends with its first two derivatives 0 lifts off once.
TEST(ContactsThatTouch, AForceThatEndsFlatlyLiftsOffOnce) {
  for (const auto method : methods) {
    SCOPED_TRACE(static_cast<int>(method));
    model::Builder model("body");
    const SX z = model.state("z", {0.0});
    static_cast<void>(model.state("v", {0.0}));
    const SX s = model.time() - 1.0;
    model.mechanics({.positions = {"z"}, .velocities = {"v"}, .force = {{"v", s * s * s}}});
    model.contact("ground", z);
    const auto run = run_by(model, method);
    ASSERT_EQ(run.status.termination, result::Termination::completed) << run.status.message;
    ASSERT_EQ(run.events.size(), 1U);
    EXPECT_EQ(run.events[0].kind, EventKind::lift_off);
    EXPECT_NEAR(run.events[0].t, 1.0, 1e-5);
    EXPECT_NEAR(run.final.x[0], 0.05, 1e-9);
  }
}

/// Friction alone holds the block when the force of the wall has ended: its slip begins without an acceleration.
void expect_slip_from_wall(model::Builder& model, ode::Method method, double force_ends, double slip_begins,
                           std::size_t velocity, double speed) {
  const auto run = run_by(model, method);
  ASSERT_EQ(run.status.termination, result::Termination::completed) << run.status.message;
  ASSERT_EQ(run.events.size(), 2U);
  EXPECT_EQ(run.events[0].kind, EventKind::lift_off);
  EXPECT_EQ(run.events[0].surfaces, std::vector<std::string>{"wall"});
  EXPECT_NEAR(run.events[0].t, force_ends, 1e-8);
  EXPECT_EQ(run.events[1].kind, EventKind::slip);
  EXPECT_EQ(run.events[1].surfaces, std::vector<std::string>{"ground"});
  EXPECT_NEAR(run.events[1].t, slip_begins, 1e-8);
  EXPECT_NEAR(run.final.x[velocity], speed, 1e-6);
  EXPECT_EQ(run.final.contact_modes, (std::vector<ContactMode>{ContactMode::slip, ContactMode::open}));
}

TEST(ContactsThatTouch, AStickingBlockSlipsAwayFromAWall) {
  for (const auto method : every_method) {
    for (const double friction : {0.1, 0.2, 0.3, 0.5}) {
      SCOPED_TRACE(::testing::Message() << friction << " " << static_cast<int>(method));
      model::Builder model("block");
      const SX x = model.state("x", {0.0}), y = model.state("y", {0.0});
      static_cast<void>(model.state("vx", {0.0}));
      static_cast<void>(model.state("vy", {0.0}));
      model.mechanics({.positions = {"x", "y"},
                       .velocities = {"vx", "vy"},
                       .force = {{"vx", 5.0 - 8.0 * model.time()}, {"vy", -8.0}}});
      model.contact("ground", y, {.tangent = {{"x", 1.0}}, .friction = friction});
      model.contact("wall", -x);
      const double begins = 0.625 + friction, left = 2.0 - begins;
      expect_slip_from_wall(model, method, 0.625, begins, 2, -4.0 * left * left);
    }
  }
}

/// In a plane: slips begin under forces that are stiff, and DOPRI5 would take very small steps.
constexpr auto methods_in_plane = {ode::Method::dop853, ode::Method::radau5};

/// A block on the ground, beside a wall along the diagonal of the plane.
model::Builder block_in_a_plane(double friction, const SX& push_x, const SX& push_y, model::Builder model) {
  const SX x = model.state("x", {0.0}), y = model.state("y", {0.0}), z = model.state("z", {0.0});
  for (const char* velocity : {"vx", "vy", "vz"}) static_cast<void>(model.state(velocity, {0.0}));
  model.mechanics({.positions = {"x", "y", "z"},
                   .velocities = {"vx", "vy", "vz"},
                   .force = {{"vx", push_x}, {"vy", push_y}, {"vz", -8.0}}});
  model.contact("ground", z, {.tangent = {{"x", 1.0}}, .friction = friction, .second_tangent = {{"y", 1.0}}});
  model.contact("wall", -0.6 * x - 0.8 * y);
  return model;
}

TEST(ContactsThatTouch, ABlockSlipsAwayFromAWallInThePlane) {
  for (const auto method : methods_in_plane) {
    for (const double friction : {0.1, 0.3}) {
      SCOPED_TRACE(::testing::Message() << friction << " " << static_cast<int>(method));
      model::Builder empty("block");
      const SX push = 5.0 - 8.0 * empty.time();
      auto model = block_in_a_plane(friction, 0.6 * push, 0.8 * push, std::move(empty));
      const double begins = 0.625 + friction, left = 2.0 - begins;
      expect_slip_from_wall(model, method, 0.625, begins, 3, -0.6 * 4.0 * left * left);
    }
  }
}

/// The wall takes three fifths of the force 5 t, the ground holds the rest, 4 t, up to the friction 2.4.
TEST(ContactsThatTouch, ABlockSlipsAlongAWallInThePlane) {
  for (const auto method : methods_in_plane) {
    SCOPED_TRACE(static_cast<int>(method));
    model::Builder empty("block");
    const SX push = 5.0 * empty.time();
    auto model = block_in_a_plane(0.3, push, 0.0, std::move(empty));
    const auto run = run_by(model, method);
    ASSERT_EQ(run.status.termination, result::Termination::completed) << run.status.message;
    ASSERT_EQ(run.events.size(), 1U);
    EXPECT_EQ(run.events[0].kind, EventKind::slip);
    EXPECT_NEAR(run.events[0].t, 0.6, 1e-7);
    const double left = 2.0 - 0.6, speed = 2.0 * left * left;
    EXPECT_NEAR(run.final.x[3], 0.8 * speed, 1e-5);
    EXPECT_NEAR(run.final.x[4], -0.6 * speed, 1e-5);
    EXPECT_EQ(run.final.contact_modes, (std::vector<ContactMode>{ContactMode::slip, ContactMode::closed}));
  }
}

/// Two blocks of mass 1 that touch, one of them pushed by 12 sin t: both slip once it is twice their friction, 3.
TEST(ContactsThatTouch, BlocksThatTouchSlipTogether) {
  for (const auto method : every_method) {
    for (const double until : {2.0, 3.0, 6.0}) {
      SCOPED_TRACE(::testing::Message() << until << " " << static_cast<int>(method));
      model::Builder model("blocks");
      const SX a = model.state("a", {0.0}), b = model.state("b", {0.1});
      const SX ya = model.state("ya", {0.0}), yb = model.state("yb", {0.0});
      for (const char* velocity : {"va", "vb", "vya", "vyb"}) static_cast<void>(model.state(velocity, {0.0}));
      model.mechanics({.positions = {"a", "b", "ya", "yb"},
                       .velocities = {"va", "vb", "vya", "vyb"},
                       .force = {{"va", 12.0 * sin(model.time())}, {"vya", -10.0}, {"vyb", -10.0}}});
      model.contact("ga", ya, {.tangent = {{"a", 1.0}}, .friction = 0.3});
      model.contact("gb", yb, {.tangent = {{"b", 1.0}}, .friction = 0.3});
      model.contact("ab", b - a - 0.1);
      IntegrationOptions options;
      options.method = method;
      options.until = until;
      const auto run = run_model(model, options);
      ASSERT_EQ(run.status.termination, result::Termination::completed) << run.status.message;
      ASSERT_FALSE(run.events.empty());
      const double begins = std::numbers::pi / 6.0;
      EXPECT_EQ(run.events[0].kind, EventKind::slip);
      EXPECT_EQ(run.events[0].surfaces, (std::vector<std::string>{"ga", "gb"}));
      EXPECT_NEAR(run.events[0].t, begins, 1e-8);
      const auto speed = [&](double t) { return 6.0 * (std::cos(begins) - std::cos(t)) - 3.0 * (t - begins); };
      if (until < 3.1) {
        EXPECT_EQ(run.events.size(), 1U);
        EXPECT_NEAR(run.final.x[4], speed(until), 1e-6);
        EXPECT_NEAR(run.final.x[5], speed(until), 1e-6);
      } else {
        // They part at pi, when nothing pushes any more, and the second one slides to its stop.
        ASSERT_EQ(run.events.size(), 4U);
        EXPECT_NEAR(run.events[1].t, std::numbers::pi, 1e-6);
        EXPECT_NEAR(run.events[3].t, std::numbers::pi + speed(std::numbers::pi) / 3.0, 1e-6);
        EXPECT_EQ(run.final.x[5], 0.0);
      }
    }
  }
}

constexpr double bounce_gravity = 9.81, bounce_friction = 0.1;

/// Falls from rest at the height 1.
double end_of_bounces(double restitution, double pull) {
  return std::sqrt(2.0 / pull) * (1.0 + restitution) / (1.0 - restitution);
}

/// Returns the only accumulation.
result::Event accumulation_of(const Integration& run) {
  std::vector<result::Event> found;
  for (const auto& event : run.events) {
    if (event.kind == EventKind::accumulation) found.push_back(event);
  }
  EXPECT_EQ(found.size(), 1U);
  return found.empty() ? result::Event{} : found.front();
}

/// Where a ball is that each impact slows by friction (1 + restitution) |vz|.
double way_through_bounces(double speed, double restitution, double end) {
  double x = 0.0, t = std::sqrt(2.0 / bounce_gravity), normal = std::sqrt(2.0 * bounce_gravity), duration = t;
  for (int n = 0; n < 400 && t < end; ++n) {
    x += speed * duration;
    speed -= std::copysign(bounce_friction, speed) * (1.0 + restitution) * normal;
    normal *= restitution;
    duration = 2.0 * normal / bounce_gravity;
    t += duration;
  }
  return x;
}

/// All normal impulses together are those of the weight, so v = speed - friction g t behind the bounces.
TEST(ContactBounces, ABallSlidesOnBehindTheLastOne) {
  for (const auto method : every_method) {
    for (const double restitution : {0.1, 0.5, 0.8}) {
      for (const double speed : {6.0, -7.0}) {
        SCOPED_TRACE(::testing::Message() << static_cast<int>(method) << " " << restitution << " " << speed);
        model::Builder model("ball");
        static_cast<void>(model.state("x", {0.0}));
        const SX z = model.state("z", {1.0});
        static_cast<void>(model.state("vx", {speed}));
        static_cast<void>(model.state("vz", {0.0}));
        model.mechanics({.positions = {"x", "z"}, .velocities = {"vx", "vz"}, .potential = bounce_gravity * z});
        model.contact("ground", z, {.tangent = {{"x", 1.0}}, .friction = bounce_friction, .restitution = restitution});
        IntegrationOptions options;
        options.method = method;
        options.tolerances = {1e-10, 1e-12};
        options.until = 8.0;
        const auto run = run_model(model, options);
        ASSERT_EQ(run.status.termination, result::Termination::completed) << run.status.message;
        const double end = end_of_bounces(restitution, bounce_gravity), sign = std::copysign(1.0, speed);
        const double left = std::abs(speed) - bounce_friction * bounce_gravity * end;
        const auto event = accumulation_of(run);
        ASSERT_EQ(event.x_after.size(), run.final.x.size());
        EXPECT_NEAR(event.t, end, 1e-7);
        EXPECT_NEAR(event.x_after[2], sign * left, 1e-6);
        EXPECT_NEAR(event.x[2], sign * left, 1e-6);
        EXPECT_EQ(event.contact_modes_after, std::vector<ContactMode>{ContactMode::slip});
        EXPECT_EQ(run.final.contact_modes, std::vector<ContactMode>{ContactMode::stick});
        EXPECT_EQ(run.events.back().kind, EventKind::stick);
        EXPECT_NEAR(run.events.back().t, std::abs(speed) / (bounce_friction * bounce_gravity), 1e-6);
        EXPECT_NEAR(run.final.x[0],
                    way_through_bounces(speed, restitution, end) +
                        sign * 0.5 * left * left / (bounce_friction * bounce_gravity),
                    1e-5);
      }
    }
  }
}

/// A ram that moves away is reached in bounces that accumulate; behind them the block slides on over a rough floor.
TEST(ContactBounces, BesideARamThatMovesABlockSlidesOn) {
  constexpr double load = 9.81, friction = 0.2, ram = -0.4;
  for (const auto method : every_method) {
    SCOPED_TRACE(static_cast<int>(method));
    model::Builder model("block");
    const SX x = model.state("x", {0.001}), z = model.state("z", {0.0}), t = model.time();
    static_cast<void>(model.state("vx", {ram}));
    static_cast<void>(model.state("vz", {0.0}));
    model.mechanics(
        {.positions = {"x", "z"}, .velocities = {"vx", "vz"}, .force = {{"vx", -3.0 + 0.5 * t}, {"vz", -load}}});
    model.contact("ram", x - ram * t, {.restitution = 0.4});
    model.contact("ground", z, {.tangent = {{"x", 1.0}}, .friction = friction});
    IntegrationOptions options;
    options.method = method;
    options.until = 3.0;
    const auto run = run_model(model, options);
    ASSERT_EQ(run.status.termination, result::Termination::completed) << run.status.message;
    EXPECT_EQ(accumulation_of(run).contact_modes_after, (std::vector{ContactMode::closed, ContactMode::slip}));
    EXPECT_EQ(run.events.back().kind, EventKind::lift_off);
    EXPECT_NEAR(run.events.back().t, (3.0 - friction * load) / 0.5, 1e-9);
    // Then v' = (t - lift_off) / 2.
    const double since = 3.0 - run.events.back().t;
    EXPECT_NEAR(run.final.x[2], ram + 0.25 * since * since, 1e-8);
  }
}

/// Under a force along its way v changes by (force - friction weight) t, in the direction in which it was.
TEST(ContactBounces, InSpaceASlideKeepsItsDirection) {
  for (const double restitution : {0.2, 0.6}) {
    for (const double angle : {0.0, 0.7, -2.0}) {
      SCOPED_TRACE(::testing::Message() << restitution << " " << angle);
      const double c = std::cos(angle), s = std::sin(angle), speed = 5.0;
      model::Builder model("ball");
      static_cast<void>(model.state("x", {0.0}));
      static_cast<void>(model.state("y", {0.0}));
      const SX z = model.state("z", {1.0});
      static_cast<void>(model.state("vx", {speed * c}));
      static_cast<void>(model.state("vy", {speed * s}));
      static_cast<void>(model.state("vz", {0.0}));
      model.mechanics({.positions = {"x", "y", "z"},
                       .velocities = {"vx", "vy", "vz"},
                       .force = {{"vx", 2.0 * c}, {"vy", 2.0 * s}, {"vz", -8.0}}});
      model.contact(
          "ground", z,
          {.tangent = {{"x", 1.0}}, .friction = 0.5, .restitution = restitution, .second_tangent = {{"y", 1.0}}});
      const double end = end_of_bounces(restitution, 8.0);
      const auto run = run_tightly(model, end + 0.3);
      ASSERT_EQ(run.status.termination, result::Termination::completed) << run.status.message;
      const auto event = accumulation_of(run);
      ASSERT_EQ(event.x_after.size(), run.final.x.size());
      EXPECT_NEAR(event.t, end, 1e-7);
      EXPECT_NEAR(event.x_after[3], c * (speed + (2.0 - 0.5 * 8.0) * end), 1e-6);
      EXPECT_NEAR(event.x_after[4], s * (speed + (2.0 - 0.5 * 8.0) * end), 1e-6);
      EXPECT_EQ(event.contact_modes_after, std::vector<ContactMode>{ContactMode::slip});
      EXPECT_NEAR(run.final.x[3], c * (speed - 2.0 * (end + 0.3)), 1e-6);
      EXPECT_NEAR(run.final.x[4], s * (speed - 2.0 * (end + 0.3)), 1e-6);
    }
  }
}

/// A block of half the width a and half the height b, released at rest at a small angle: it rocks from corner to corner
/// (Housner 1963). Corners that stick have a velocity of 0 behind an impact, not a slip of its rounding.
model::Builder rocking_block(double a, double angle) {
  constexpr double b = 0.5, block_weight = 9.81, inertia = 1.0 / 3.0;
  model::Builder model("block");
  static_cast<void>(model.state("x", {0.0}));
  const SX z = model.state("z", {a * std::sin(angle) + b * std::cos(angle)});
  const SX th = model.state("th", {angle});
  for (const char* name : {"vx", "vz", "w"}) static_cast<void>(model.state(name, {0.0}));
  model.mechanics({.positions = {"x", "z", "th"},
                   .velocities = {"vx", "vz", "w"},
                   .mass = SX::diag(SX::vertcat({1.0, 1.0, inertia * (a * a + b * b)})),
                   .potential = block_weight * z});
  const SX across = a * sin(th), along = b * cos(th);
  model.contact("right", z + across - along, {.tangent = {{"x", 1.0}, {"th", along - across}}, .friction = 0.7});
  model.contact("left", z - across - along, {.tangent = {{"x", 1.0}, {"th", across + along}}, .friction = 0.7});
  return model;
}

TEST(ContactsThatTouch, ARockingBlockStopsRockingAndNeverSlips) {
  for (const auto method : {ode::Method::dopri5, ode::Method::dop853, ode::Method::radau5, ode::Method::taylor}) {
    for (const double a : {0.1, 0.25}) {
      SCOPED_TRACE(::testing::Message() << static_cast<int>(method) << " " << a);
      auto model = rocking_block(a, 0.15);
      const auto run = run_by(model, method);
      ASSERT_EQ(run.status.termination, result::Termination::completed) << run.status.message;
      // Behind each impact the block turns with the share 1 - 3/2 sin^2(atan(a/b)) of its speed.
      const double share = 1.0 - 1.5 * a * a / (a * a + 0.25);
      double before = 0.0;
      for (const auto& event : run.events) {
        if (event.kind != EventKind::impact || std::abs(event.x[5]) < 1e-4) continue;
        EXPECT_NEAR(event.x_after[5], share * event.x[5], 1e-9);
        EXPECT_TRUE(before == 0.0 || std::abs(event.x[5]) < before + 1e-6);
        before = std::abs(event.x_after[5]);
      }
      EXPECT_GT(before, 0.0);
      for (const auto& event : run.events) {
        EXPECT_NE(event.kind, EventKind::slip);
        EXPECT_NE(event.kind, EventKind::stick);
      }
    }
  }
}

/// The way travelled, |v| integrated: v is held at 0 while the body rests, and leaves it with no acceleration.
TEST(ContactsThatTouch, AKinkAtAVelocityThatIsHeldMakesNoEvents) {
  for (const auto method : {ode::Method::dopri5, ode::Method::dop853, ode::Method::radau5, ode::Method::taylor}) {
    SCOPED_TRACE(static_cast<int>(method));
    model::Builder model("body");
    const SX z = model.state("z", {0.0});
    const SX v = model.state("v", {0.0});
    static_cast<void>(model.state("way", {0.0}));
    model.dynamics("way", model.abs(v));
    model.mechanics({.positions = {"z"}, .velocities = {"v"}, .force = {{"v", 12.0 * sin(6.0 * model.time()) - 9.81}}});
    model.contact("ground", z);
    const auto run = run_by(model, method);
    ASSERT_EQ(run.status.termination, result::Termination::completed) << run.status.message;
    const std::vector kinds{EventKind::lift_off, EventKind::impact, EventKind::lift_off, EventKind::impact};
    ASSERT_EQ(run.events.size(), kinds.size());
    for (std::size_t k = 0; k < kinds.size(); ++k) EXPECT_EQ(run.events[k].kind, kinds[k]);
    EXPECT_NEAR(run.final.x[2], 0.20767574538, 1e-8);
  }
}

/// A body thrown, or let go, where the gap has no gradient: nothing says where to push it.
TEST(ContactsThatTouch, AGapWithoutGradientHasNoNormal) {
  for (const auto method : every_method) {
    for (const double start : {0.5, 0.0}) {
      SCOPED_TRACE(::testing::Message() << static_cast<int>(method) << " " << start);
      model::Builder model("body");
      const SX x = model.state("x", {start});
      static_cast<void>(model.state("v", {start > 0.0 ? -1.0 : 0.0}));
      model.mechanics({.positions = {"x"}, .velocities = {"v"}, .potential = 10.0 * x});
      model.contact("ground", x * x * x, {});
      IntegrationOptions options;
      options.method = method;
      options.until = 1.0;
      const auto run = run_model(model, options);
      EXPECT_EQ(run.status.termination, result::Termination::outside_class);
      EXPECT_NE(run.status.message.find("the gap of 'ground' has no normal"), std::string::npos) << run.status.message;
      EXPECT_NEAR(run.final.x[0], 0.0, 1e-4);
    }
  }
}

/// A gap that jumps in time: the table drops, and the body on it falls freely; into a table that rises nothing follows.
TEST(ContactsThatTouch, ATableThatDropsLeavesTheBodyInTheAir) {
  for (const auto method : {ode::Method::dopri5, ode::Method::dop853, ode::Method::radau5, ode::Method::taylor}) {
    for (const double drop : {2.0, -2.0}) {
      SCOPED_TRACE(::testing::Message() << static_cast<int>(method) << " " << drop);
      model::Builder model("body");
      const SX z = model.state("z", {0.0});
      static_cast<void>(model.state("v", {0.0}));
      model.mechanics({.positions = {"z"}, .velocities = {"v"}, .force = {{"v", -9.81}}});
      model.contact("table", z + drop * model.floor(model.time() / 1.5));
      const auto run = run_by(model, method);
      const bool drops = drop > 0.0;
      EXPECT_EQ(run.status.termination, drops ? result::Termination::completed : result::Termination::outside_class);
      EXPECT_NEAR(run.final.x[0], drops ? -0.5 * 9.81 * 0.25 : 0.0, 1e-9);
    }
  }
}

/// Small masses make forces of contacts large entries of the Jacobian, on which Radau's methods pivot.
TEST(ContactsThatTouch, SmallBodiesFarFromAnythingMoveFreely) {
  for (const auto method : {ode::Method::radau5, ode::Method::radau9, ode::Method::radau13}) {
    SCOPED_TRACE(static_cast<int>(method));
    constexpr double mass = 1e-7;
    model::Builder model("bodies");
    static_cast<void>(model.state("y", {0.0}));
    const SX p = model.state("p", {0.0}), s = model.state("s", {-0.1});
    static_cast<void>(model.state("vy", {-0.3}));
    static_cast<void>(model.state("vp", {0.1}));
    static_cast<void>(model.state("vs", {0.0}));
    model.mechanics({.positions = {"y", "p", "s"},
                     .velocities = {"vy", "vp", "vs"},
                     .mass = mass * SX::eye(3),
                     .potential = 0.5 * mass * (p - s) * (p - s)});
    const model::ContactOptions rough{.tangent = {{"y", 1.0}}, .friction = 0.3};
    model.contact("a", 5.0 - s, rough);
    model.contact("b", 1.0 + p, rough);
    model.contact("c", 1.0 - p, rough);
    const auto run = run_by(model, method);
    ASSERT_EQ(run.status.termination, result::Termination::completed) << run.status.message;
    EXPECT_TRUE(run.events.empty());
    const double rate = std::numbers::sqrt2, phase = 2.0 * rate;
    const double sum = -0.1 + 0.1 * 2.0, difference = 0.1 * std::cos(phase) + 0.1 / rate * std::sin(phase);
    EXPECT_NEAR(run.final.x[1], 0.5 * (sum + difference), 1e-7);
    EXPECT_NEAR(run.final.x[2], 0.5 * (sum - difference), 1e-7);
  }
}

}  // namespace
}  // namespace saltus::event_integrator::testing
