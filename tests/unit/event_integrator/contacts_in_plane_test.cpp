// Contacts with two tangents: friction with a direction in the plane.
#include <array>
#include <cmath>
#include <numbers>

#include "run_model.hpp"
#include "saltus/linalg/factors.hpp"
#include "saltus/linalg/matrix.hpp"

namespace saltus::event_integrator::testing {
namespace {

using casadi::SX;
using linalg::Matrix;
using linalg::Vector;
using result::ContactMode;
using result::EventKind;

constexpr double gravity = 10.0;
const std::vector<std::string> positions{"x", "y", "z"}, velocities{"vx", "vy", "vz"};

std::vector<EventKind> kinds_of(const Integration& run) {
  std::vector<EventKind> result;
  for (const auto& event : run.events) result.push_back(event.kind);
  return result;
}

/// A point over the ground z = 0.
struct PointInSpace {
  model::Builder model{"point"};
  SX x, y, z;

  PointInSpace(const std::array<double, 3>& place, const std::array<double, 3>& speed) {
    x = model.state("x", {place[0]});
    y = model.state("y", {place[1]});
    z = model.state("z", {place[2]});
    for (std::size_t i = 0; i < 3; ++i) static_cast<void>(model.state(velocities[i], {speed[i]}));
  }
  void moves(const std::map<std::string, SX>& force = {}, const SX& mass = SX::eye(3)) {
    model.mechanics(
        {.positions = positions, .velocities = velocities, .mass = mass, .potential = gravity * z, .force = force});
  }
  void touches(double friction, double restitution = 0.0) {
    model.contact(
        "ground", z,
        {.tangent = {{"x", 1.0}}, .friction = friction, .restitution = restitution, .second_tangent = {{"y", 1.0}}});
  }
};

Integration thrown_in_space(double angle, double restitution) {
  PointInSpace ball({0.0, 0.0, 1.0}, {4.0 * std::cos(angle), 4.0 * std::sin(angle), 0.0});
  ball.moves();
  ball.touches(0.3, restitution);
  return run_tightly(ball.model, 3.0);
}

Integration thrown_in_the_plane(double restitution) {
  model::Builder model("ball");
  static_cast<void>(model.state("x", {0.0}));
  const SX z = model.state("z", {1.0});
  static_cast<void>(model.state("vx", {4.0}));
  static_cast<void>(model.state("vz", {0.0}));
  model.mechanics({.positions = {"x", "z"}, .velocities = {"vx", "vz"}, .potential = gravity * z});
  model.contact("ground", z, {.tangent = {{"x", 1.0}}, .friction = 0.3, .restitution = restitution});
  return run_tightly(model, 3.0);
}

/// What happens in a plane happens in the same way in that plane turned around the vertical.
TEST(ContactsInPlane, AThrownBallMovesAsInThePlane) {
  for (const double restitution : {0.0, 0.5}) {
    const auto plane = thrown_in_the_plane(restitution);
    ASSERT_EQ(plane.status.termination, result::Termination::completed);
    for (const double angle : {0.0, 0.3, 1.0, std::numbers::pi / 2.0, 2.5, -1.9}) {
      SCOPED_TRACE(::testing::Message() << angle << " " << restitution);
      const auto space = thrown_in_space(angle, restitution);
      ASSERT_EQ(space.status.termination, result::Termination::completed) << space.status.message;
      ASSERT_EQ(kinds_of(space), kinds_of(plane));
      const double c = std::cos(angle), s = std::sin(angle);
      for (std::size_t k = 0; k < plane.events.size(); ++k) {
        EXPECT_NEAR(space.events[k].t, plane.events[k].t, 1e-9);
        EXPECT_EQ(space.events[k].contact_modes_after, plane.events[k].contact_modes_after);
        EXPECT_NEAR(space.events[k].x_after[3], c * plane.events[k].x_after[2], 1e-9);
        EXPECT_NEAR(space.events[k].x_after[4], s * plane.events[k].x_after[2], 1e-9);
      }
      EXPECT_NEAR(space.final.x[0], c * plane.final.x[0], 1e-9);
      EXPECT_NEAR(space.final.x[1], s * plane.final.x[0], 1e-9);
      EXPECT_EQ(space.final.x[3], 0.0);
      EXPECT_EQ(space.final.x[4], 0.0);
      EXPECT_EQ(space.final.contact_modes, std::vector<ContactMode>{ContactMode::stick});
      const auto impulse = space.events[0].impulse->front();
      ASSERT_EQ(impulse.size(), 3U);
      EXPECT_NEAR(impulse[1], c * plane.events[0].impulse->front()[1], 1e-9);
      EXPECT_NEAR(impulse[2], s * plane.events[0].impulse->front()[1], 1e-9);
    }
  }
}

/// The last speed that is resolved lies anywhere above the tolerance.
TEST(ContactsInPlane, ASlipEndsWhateverItsSpeed) {
  for (const auto method : {ode::Method::dopri5, ode::Method::dop853}) {
    for (int k = 0; k < 16; ++k) {
      SCOPED_TRACE(k);
      const double speed = std::pow(10.0, k / 16.0);
      PointInSpace ball({0.0, 0.0, 0.0}, {speed * std::cos(0.4), speed * std::sin(0.4), 0.0});
      ball.moves();
      ball.touches(0.3);
      IntegrationOptions options;
      options.method = method;
      options.tolerances = {1e-8, 1e-10};
      options.until = speed / 3.0 + 0.5;
      options.max_steps = 2000;
      const auto run = run_model(ball.model, options);
      ASSERT_EQ(run.status.termination, result::Termination::completed) << run.status.message;
      ASSERT_EQ(kinds_of(run), std::vector<EventKind>{EventKind::stick});
      EXPECT_NEAR(run.events[0].t, speed / 3.0, 1e-9);
      EXPECT_EQ(run.final.x[3], 0.0);
    }
  }
}

/// A block on an incline, pushed sideways: with gravity a down the plane and friction k the speed is
/// v = C tan(phi/2)^(k/a) / sin phi over the angle phi to the line of fall, phi' = -a sin phi / v.
struct Incline {
  double a, k, v0, phi0;

  [[nodiscard]] double speed(double phi) const {
    const double q = k / a;
    return v0 * std::sin(phi0) / std::sin(phi) * std::pow(std::tan(0.5 * phi) / std::tan(0.5 * phi0), q);
  }
  /// Of k |v| + a v.e the rate is a^2 - k^2.
  [[nodiscard]] double stop() const { return v0 * (k + a * std::cos(phi0)) / (k * k - a * a); }
  /// Along and across the line of fall, by Simpson's rule over log phi.
  [[nodiscard]] std::array<double, 2> way() const {
    std::array<double, 2> sum{0.0, 0.0};
    constexpr int panels = 200000;
    const double span = 60.0, h = span / panels;
    for (int i = 0; i <= panels; ++i) {
      const double phi = phi0 * std::exp(-h * i), v = speed(phi);
      const double weight = (i == 0 || i == panels ? 1.0 : i % 2 == 1 ? 4.0 : 2.0) * h / 3.0;
      const double time = v * phi / (a * std::sin(phi));
      sum[0] += weight * time * v * std::cos(phi);
      sum[1] += weight * time * v * std::sin(phi);
    }
    return sum;
  }
};

TEST(ContactsInPlane, ABlockPushedSidewaysOnAnInclineStops) {
  const Incline incline{2.0, 3.0, 1.5, 2.0};
  PointInSpace block({0.0, 0.0, 0.0}, {1.5 * std::cos(2.0), 1.5 * std::sin(2.0), 0.0});
  block.moves({{"vx", 2.0}});
  block.touches(0.3);
  const auto way = incline.way();
  for (const auto method : {ode::Method::dopri5, ode::Method::dop853, ode::Method::radau5}) {
    IntegrationOptions options;
    options.method = method;
    options.tolerances = {1e-11, 1e-13};
    options.until = 4.0;
    const auto run = run_model(block.model, options);
    ASSERT_EQ(run.status.termination, result::Termination::completed) << run.status.message;
    ASSERT_EQ(kinds_of(run), std::vector<EventKind>{EventKind::stick});
    EXPECT_NEAR(run.events[0].t, incline.stop(), 1e-9);
    EXPECT_NEAR(run.final.x[0], way[0], 1e-9);
    EXPECT_NEAR(run.final.x[1], way[1], 1e-9);
    EXPECT_EQ(run.final.x[3], 0.0);
    EXPECT_EQ(run.final.x[4], 0.0);
    // What holds it: the force down the plane.
    EXPECT_NEAR(run.final.outputs.at(2), -2.0, 1e-9);
    EXPECT_NEAR(run.final.outputs.at(3), 0.0, 1e-9);
  }
}

TEST(ContactsInPlane, ABlockOnASteepInclineTurnsDown) {
  const Incline incline{4.0, 3.0, 1.0, 2.5};
  PointInSpace block({0.0, 0.0, 0.0}, {std::cos(2.5), std::sin(2.5), 0.0});
  block.moves({{"vx", 4.0}});
  block.touches(0.3);
  const auto run = run_tightly(block.model, 1.0);
  ASSERT_EQ(run.status.termination, result::Termination::completed) << run.status.message;
  EXPECT_TRUE(run.events.empty());
  const double vx = run.final.x[3], vy = run.final.x[4];
  EXPECT_NEAR(std::hypot(vx, vy), incline.speed(std::atan2(vy, vx)), 1e-9);
  EXPECT_NEAR(3.0 * std::hypot(vx, vy) + 4.0 * vx, 3.0 + 4.0 * std::cos(2.5) + 7.0, 1e-9);
}

/// It sticks until the force leaves the cone, and then follows it.
TEST(ContactsInPlane, AForceThatGrowsOvercomesFriction) {
  const double angle = 0.7, friction = 0.4, pull = 3.0;
  PointInSpace block({0.0, 0.0, 0.0}, {0.0, 0.0, 0.0});
  const SX t = block.model.time();
  block.moves({{"vx", pull * t * std::cos(angle)}, {"vy", pull * t * std::sin(angle)}});
  block.touches(friction);
  const auto run = run_model(block.model, 3.0, {1e-8, 1e-10});
  ASSERT_EQ(run.status.termination, result::Termination::completed) << run.status.message;
  ASSERT_EQ(kinds_of(run), std::vector<EventKind>{EventKind::slip});
  const double start = friction * gravity / pull;
  EXPECT_NEAR(run.events[0].t, start, 1e-10);
  const double speed = 0.5 * pull * (3.0 - start) * (3.0 - start);
  EXPECT_NEAR(run.final.x[3], speed * std::cos(angle), 1e-7);
  EXPECT_NEAR(run.final.x[4], speed * std::sin(angle), 1e-7);
  for (std::size_t i = 0; i < run.trajectory.t.size(); ++i) {
    if (run.trajectory.contact_modes[i][0] != ContactMode::stick) continue;
    EXPECT_EQ(run.trajectory.x[i][3], 0.0);
    EXPECT_EQ(run.trajectory.x[i][4], 0.0);
  }
}

/// Inverse masses by which the normal force changes fast with the direction of the slip: (W_zz - mu W_z. d) is small.
TEST(ContactsInPlane, ASlipBeginsWhereItsDirectionChangesTheNormalForce) {
  const Matrix inverse{{0.88, 1.07, -0.23}, {1.07, 2.12, -0.61}, {-0.23, -0.61, 0.64}};
  const Matrix mass = linalg::inverse(inverse);
  SX symmetric(3, 3);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) symmetric(i, j) = 0.5 * (mass(i, j) + mass(j, i));
  }
  constexpr double friction = 1.4, pull_x = 0.976, pull_y = 0.217;
  PointInSpace block({0.0, 0.0, 0.0}, {0.0, 0.0, 0.0});
  const SX t = block.model.time();
  block.moves({{"vx", -pull_x * t}, {"vy", -pull_y * t}}, symmetric);
  block.touches(friction);
  for (const auto method : {ode::Method::dopri5, ode::Method::dop853, ode::Method::radau5}) {
    IntegrationOptions options;
    options.method = method;
    options.until = 14.2;
    const auto run = run_model(block.model, options);
    ASSERT_EQ(run.status.termination, result::Termination::completed) << run.status.message;
    ASSERT_EQ(kinds_of(run), std::vector<EventKind>{EventKind::slip});
    EXPECT_NEAR(run.events[0].t, friction * gravity / std::hypot(pull_x, pull_y), 1e-9);
  }
}

/// A puck on springs comes to rest while its friction turns: a step runs through no rest unseen, whatever its method.
TEST(ContactsInPlane, ASlipThatEndsUnderATurningForceTakesFewSteps) {
  for (const double speed : {-1.93, 0.3, 1.0}) {
    SCOPED_TRACE(speed);
    std::vector<std::vector<double>> ends;
    for (const auto method : every_method) {
      model::Builder model("puck");
      const SX x = model.state("x", {-0.98}), y = model.state("y", {0.47}), z = model.state("z", {0.0});
      static_cast<void>(model.state("vx", {speed}));
      static_cast<void>(model.state("vy", {1.52}));
      static_cast<void>(model.state("vz", {0.0}));
      model.mechanics({.positions = {"x", "y", "z"},
                       .velocities = {"vx", "vy", "vz"},
                       .potential = 10.0 * z + 0.895 * x * x + 2.965 * y * y});
      model.contact("ground", z, {.tangent = {{"x", 1.0}}, .friction = 0.49, .second_tangent = {{"y", 1.0}}});
      IntegrationOptions options;
      options.method = method;
      options.until = 4.0;
      options.max_steps = 1500;
      const auto run = run_model(model, options);
      ASSERT_EQ(run.status.termination, result::Termination::completed) << run.status.message;
      EXPECT_EQ(run.final.contact_modes, std::vector<result::ContactMode>{result::ContactMode::stick});
      ends.push_back(run.final.x);
    }
    for (const auto& end : ends) {
      for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(end[i], ends.front()[i], 1e-7);
    }
  }
}

/// A block lies on a plate, both move, and the force on the block grows and turns. From s = t - 1 = 0 on it slips with
/// the velocity s^2 e(3 s), e(a) = (cos a, sin a), for which slip begins as slowly as it can: friction has a direction
/// where the velocity is a difference of speeds of 1 that has lost all its digits to them.
TEST(ContactsInPlane, ASlipThatBeginsUnderATurningForceTakesFewSteps) {
  constexpr double limit = 0.4 * gravity;
  model::Builder model("block on a plate");
  const std::vector<std::string> names{"x", "y", "z", "X", "Y"};
  std::vector<std::string> rates;
  SX z;
  for (const auto& name : names) {
    const SX state = model.state(name, {0.0});
    if (name == "z") z = state;
  }
  for (const auto& name : names) {
    rates.push_back("v" + name);
    static_cast<void>(model.state(rates.back(), {name == "z" ? 0.0 : 1.0}));
  }
  const SX s = model.time() - 1.0;
  const std::array<SX, 2> e{cos(3.0 * s), sin(3.0 * s)}, across{-e[1], e[0]};
  std::map<std::string, SX> force{{"vz", SX(-gravity)}};
  for (std::size_t i = 0; i < 2; ++i) {
    force[rates[i]] = 2.0 * s * e[i] + 3.0 * s * s * across[i] + limit * e[i];
    force[rates[i + 3]] = -limit * e[i];
  }
  model.mechanics({.positions = names, .velocities = rates, .force = force});
  model.contact("plate", z,
                {.tangent = {{"x", 1.0}, {"X", -1.0}}, .friction = 0.4, .second_tangent = {{"y", 1.0}, {"Y", -1.0}}});
  for (const auto method : {ode::Method::radau5, ode::Method::radau9, ode::Method::radau13}) {
    SCOPED_TRACE(static_cast<int>(method));
    IntegrationOptions options;
    options.method = method;
    options.until = 2.5;
    options.max_steps = 2000;
    const auto run = run_model(model, options);
    ASSERT_EQ(run.status.termination, result::Termination::completed) << run.status.message;
    ASSERT_EQ(kinds_of(run), std::vector<EventKind>{EventKind::slip});
    EXPECT_NEAR(run.events[0].t, 1.0, 1e-8);
    // Before, both have had half of the force: its integral is s^2 e(3 s), too.
    const double plate[] = {1.0 - 0.5 * std::cos(3.0), 1.0 + 0.5 * std::sin(3.0)};
    const double slip[] = {2.25 * std::cos(4.5), 2.25 * std::sin(4.5)};
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_NEAR(run.final.x[5 + i], plate[i] + slip[i], 1e-6);
      EXPECT_NEAR(run.final.x[8 + i], plate[i], 1e-6);
    }
  }
}

/// dv/dp = M^-1 (n - mu T v_t/|v_t|) by 10^6 steps of the classical method; slip that ends would stick.
Vector behind_impact(const Matrix& mass, Vector v, double friction, double restitution) {
  const Matrix inverse = linalg::inverse(mass);
  const auto rate = [&](const Vector& at) -> Vector {
    const double slip = std::hypot(at[0], at[1]);
    return inverse * Vector{-friction * at[0] / slip, -friction * at[1] / slip, 1.0};
  };
  const auto step = [&](const Vector& at, double h) -> Vector {
    const Vector a = rate(at), b = rate(at + 0.5 * h * a), c = rate(at + 0.5 * h * b), d = rate(at + h * c);
    return at + h / 6.0 * (a + 2.0 * b + 2.0 * c + d);
  };
  double work = 0.0, h = 1e-5;
  while (v[2] < -1e-13) {
    const double length = std::min(h, -v[2] / rate(v)[2]);
    const auto middle = step(v, 0.5 * length), next = step(v, length);
    work -= length / 6.0 * (v[2] + 4.0 * middle[2] + next[2]);
    v = next;
  }
  double left = restitution * restitution * work;
  while (left > 1e-13) {
    const double slope = rate(v)[2];
    const double length = std::min(h, 2.0 * left / (v[2] + std::sqrt(v[2] * v[2] + 2.0 * slope * left)));
    const auto middle = step(v, 0.5 * length), next = step(v, length);
    left -= length / 6.0 * (v[2] + 4.0 * middle[2] + next[2]);
    v = next;
  }
  return v;
}

TEST(ContactsInPlane, TheSlipTurnsInAnImpact) {
  const Matrix mass{{1.0, 0.2, -0.3}, {0.2, 3.0, 0.4}, {-0.3, 0.4, 2.0}};
  SX symbolic(3, 3);
  for (casadi_int i = 0; i < 3; ++i) {
    for (casadi_int j = 0; j < 3; ++j) symbolic(i, j) = mass(i, j);
  }
  for (const double restitution : {0.0, 0.6}) {
    PointInSpace body({0.0, 0.0, 0.0}, {1.5, -1.0, -2.0});
    body.moves({}, symbolic);
    body.touches(0.4, restitution);
    const auto run = run_tightly(body.model, 0.001);
    ASSERT_EQ(run.status.termination, result::Termination::completed) << run.status.message;
    ASSERT_FALSE(run.events.empty());
    const auto exact = behind_impact(mass, {1.5, -1.0, -2.0}, 0.4, restitution);
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_NEAR(run.events[0].x_after[3 + i], exact(static_cast<linalg::Index>(i)), 1e-9) << restitution;
    }
  }
}

/// Friction holds in the impact what has come to rest in it.
TEST(ContactsInPlane, AnImpactMayEndTheSlip) {
  const Matrix mass{{1.0, 0.2, 0.0}, {0.2, 1.5, 0.1}, {0.0, 0.1, 2.0}};
  SX symbolic(3, 3);
  for (casadi_int i = 0; i < 3; ++i) {
    for (casadi_int j = 0; j < 3; ++j) symbolic(i, j) = mass(i, j);
  }
  PointInSpace body({0.0, 0.0, 0.0}, {0.3, -0.2, -3.0});
  body.moves({}, symbolic);
  body.touches(0.8);
  const auto run = run_tightly(body.model, 0.1);
  ASSERT_EQ(run.status.termination, result::Termination::completed) << run.status.message;
  ASSERT_EQ(kinds_of(run), std::vector<EventKind>{EventKind::impact});
  for (std::size_t i = 3; i < 6; ++i) EXPECT_NEAR(run.events[0].x_after[i], 0.0, 1e-11);
  EXPECT_EQ(run.final.contact_modes, std::vector<ContactMode>{ContactMode::stick});
  EXPECT_EQ(run.final.x[3], 0.0);
  EXPECT_EQ(run.final.x[4], 0.0);
}

}  // namespace
}  // namespace saltus::event_integrator::testing
