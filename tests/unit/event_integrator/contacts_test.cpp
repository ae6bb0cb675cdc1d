// Contacts in the event engine, against closed forms.
#include <algorithm>
#include <cmath>

#include "run_model.hpp"

namespace saltus::event_integrator::testing {
namespace {

using casadi::SX;
using result::ContactMode;
using result::EventKind;

constexpr double g = 9.81;

std::vector<EventKind> kinds(const Integration& run) {
  std::vector<EventKind> result;
  for (const auto& event : run.events) result.push_back(event.kind);
  return result;
}

void expect_done(const Integration& run) {
  EXPECT_EQ(run.status.termination, result::Termination::completed) << run.status.message;
}

/// No gap below rounding, in no row. Output 0 is the gap of the first contact, and so on.
void expect_apart(const Integration& run, const std::vector<std::size_t>& gaps) {
  for (const auto& outputs : run.trajectory.outputs) {
    for (const std::size_t gap : gaps) EXPECT_GE(outputs[gap], -1e-12);
  }
}

/// A point mass in the plane, x and z, over the ground z = 0.
struct PointMass {
  model::Builder model{"mass"};
  SX x, z, vx, vz;

  PointMass(double height, double speed) {
    x = model.state("x", {0.0});
    z = model.state("z", {height});
    vx = model.state("vx", {speed});
    vz = model.state("vz", {0.0});
  }
  void moves(double mass, const std::map<std::string, SX>& force = {}) {
    model.mechanics({.positions = {"x", "z"},
                     .velocities = {"vx", "vz"},
                     .mass = mass * SX::eye(2),
                     .potential = mass * g * z,
                     .force = force});
  }
};

TEST(Contacts, ABallBouncesAndComesToRest) {
  model::Builder model("ball");
  const SX y = model.state("y", {10.0});
  static_cast<void>(model.state("v", {0.0}));
  model.mechanics({.positions = {"y"}, .velocities = {"v"}, .potential = 9.8 * y});
  model.contact("ground", y, {.restitution = 0.9});
  const auto run = run_tightly(model, 30.0);
  expect_done(run);
  ASSERT_GT(run.events.size(), 10U);
  double t = 10.0 / 7.0;
  for (std::size_t n = 0; n < 10; ++n) {
    EXPECT_EQ(run.events[n].kind, EventKind::impact);
    EXPECT_EQ(run.events[n].surfaces, std::vector<std::string>{"ground"});
    EXPECT_NEAR(run.events[n].t, t, 1e-11 * t);
    const double speed = 14.0 * std::pow(0.9, static_cast<double>(n));
    EXPECT_NEAR(run.events[n].impulse->front()[0], 1.9 * speed, 1e-10 * speed);
    t += 2.0 * 10.0 / 7.0 * std::pow(0.9, static_cast<double>(n) + 1.0);
  }
  EXPECT_EQ(run.events.back().kind, EventKind::accumulation);
  EXPECT_NEAR(run.events.back().t, 27.142857142857142, 1e-8);
  EXPECT_EQ(run.final.contact_modes, std::vector<ContactMode>{ContactMode::closed});
  EXPECT_EQ(run.final.x.size(), 2U);
  EXPECT_NEAR(run.final.x[0], 0.0, 1e-12);
  EXPECT_NEAR(run.final.x[1], 0.0, 1e-12);
  EXPECT_NEAR(run.final.outputs.at(1), 9.8, 1e-12);  // the force
  expect_apart(run, {0});
}

/// A point mass bounces as it does without friction, however fast it moves along the ground.
TEST(Contacts, BouncesAccumulateWithFrictionToo) {
  for (const double speed : {0.5, 3.0, 1e2, 1e4}) {
    for (const double restitution : {0.1, 0.5, 0.8}) {
      PointMass ball(1.0, speed);
      ball.moves(1.0);
      ball.model.contact("ground", ball.z, {.tangent = {{"x", 1.0}}, .friction = 0.2, .restitution = restitution});
      const double end = std::sqrt(2.0 / g) * (1.0 + restitution) / (1.0 - restitution);
      const auto run = run_model(ball.model, end + 0.1, {1e-8, 1e-10});
      expect_done(run);
      std::vector<double> times;
      for (const auto& event : run.events) {
        if (event.kind == EventKind::accumulation) times.push_back(event.t);
      }
      ASSERT_EQ(times.size(), 1U) << speed << " " << restitution;
      EXPECT_NEAR(times[0], end, 1e-7) << speed << " " << restitution;
    }
  }
}

/// Bounces that are nothing before there were enough of them to see where they go: their limit is the last one.
TEST(Contacts, FewBouncesAccumulateToo) {
  for (const double speed : {0.0, 1e3}) {
    const double angle = 0.3;
    PointMass ball(1.0, speed);
    ball.moves(1.0);
    ball.model.contact(
        "ground", std::cos(angle) * ball.z - std::sin(angle) * ball.x,
        {.tangent = {{"x", std::cos(angle)}, {"z", std::sin(angle)}}, .friction = 0.1, .restitution = 1e-4});
    const auto run = run_model(ball.model, 300.0, {1e-8, 1e-10});
    const auto found = kinds(run);
    EXPECT_EQ(std::count(found.begin(), found.end(), EventKind::accumulation), 1) << speed;
    const auto place = std::find(found.begin(), found.end(), EventKind::accumulation);
    ASSERT_TRUE(place != found.begin() && place != found.end()) << speed;
    const auto& end = run.events[static_cast<std::size_t>(place - found.begin())];
    EXPECT_EQ(*(place - 1), EventKind::impact) << speed;
    EXPECT_EQ(end.t, run.events[static_cast<std::size_t>(place - found.begin()) - 1].t) << speed;
    EXPECT_EQ(end.surfaces, std::vector<std::string>{"ground"});
  }
}

TEST(Contacts, TwoBallsOnASpring) {
  model::Builder model("balls");
  const SX q1 = model.state("q1", {1.0}), q2 = model.state("q2", {2.0});
  static_cast<void>(model.state("v1", {0.0}));
  static_cast<void>(model.state("v2", {0.0}));
  model.mechanics({.positions = {"q1", "q2"},
                   .velocities = {"v1", "v2"},
                   .potential = g * (q1 + q2) + 0.5e4 * (q2 - q1 - 1.0) * (q2 - q1 - 1.0)});
  model.contact("ground", q1 - 0.2, {.restitution = 0.8});
  const auto run = run_tightly(model, 1.0);
  expect_done(run);
  ASSERT_EQ(kinds(run), (std::vector<EventKind>{EventKind::impact, EventKind::impact}));
  EXPECT_NEAR(run.events[0].t, 0.40385502, 5e-9);
  EXPECT_NEAR(run.events[1].t, 0.42331697, 5e-9);
  const std::vector<double> exact{0.2468418867, 1.2282103120, -2.3798395218, -3.1140923934};
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(run.final.x[i], exact[i], 1e-8);
}

TEST(Contacts, AnImpactWithFrictionTakesItsShareOfTheTangentialVelocity) {
  PointMass ball(1.0, 4.0);
  ball.model.mechanics({.positions = {"x", "z"}, .velocities = {"vx", "vz"}, .potential = 10.0 * ball.z});
  ball.model.contact("ground", ball.z, {.tangent = {{"x", 1.0}}, .friction = 0.3});
  const auto run = run_tightly(ball.model, 2.0);
  expect_done(run);
  ASSERT_EQ(kinds(run), (std::vector<EventKind>{EventKind::impact, EventKind::stick}));
  EXPECT_NEAR(run.events[0].t, std::sqrt(0.2), 1e-12);
  const double behind = 4.0 - 0.3 * std::sqrt(20.0);
  EXPECT_NEAR(run.events[0].x_after[2], behind, 1e-11);
  EXPECT_EQ(run.events[0].contact_modes_after, std::vector<ContactMode>{ContactMode::slip});
  EXPECT_NEAR(run.events[1].t - run.events[0].t, behind / 3.0, 1e-11);
  EXPECT_EQ(run.final.x[2], 0.0);
  EXPECT_EQ(run.final.contact_modes, std::vector<ContactMode>{ContactMode::stick});
  expect_apart(run, {0});
}

TEST(Contacts, AnInelasticCornerHoldsWhatArrives) {
  model::Builder model("corner");
  const SX x = model.state("x", {0.8}), y = model.state("y", {0.5});
  static_cast<void>(model.state("vx", {-1.5}));
  static_cast<void>(model.state("vy", {-1.0}));
  model.mechanics({.positions = {"x", "y"}, .velocities = {"vx", "vy"}, .force = {{"vx", -1.0}, {"vy", -2.0}}});
  model.contact("left", x);
  model.contact("down", y);
  const auto run = run_tightly(model, 2.0);
  expect_done(run);
  EXPECT_EQ(kinds(run), (std::vector<EventKind>{EventKind::impact, EventKind::impact}));
  for (const double value : run.final.x) EXPECT_NEAR(value, 0.0, 1e-14);
  EXPECT_EQ(run.final.contact_modes, (std::vector<ContactMode>(2, ContactMode::closed)));
}

TEST(Contacts, AForceThatGrowsLiftsOff) {
  PointMass mass(0.0, 0.0);
  const double pull = 5.0;
  mass.moves(2.0, {{"vz", pull * mass.model.time()}});
  mass.model.contact("ground", mass.z);
  const auto run = run_tightly(mass.model, 6.0);
  expect_done(run);
  ASSERT_EQ(kinds(run), std::vector<EventKind>{EventKind::lift_off});
  const double t = 2.0 * g / pull;
  EXPECT_NEAR(run.events[0].t, t, 1e-12);
  EXPECT_NEAR(run.final.x[1], pull * std::pow(6.0 - t, 3) / 12.0, 1e-10);
  EXPECT_EQ(run.final.contact_modes, std::vector<ContactMode>{ContactMode::open});
}

TEST(Contacts, AForceThatGrowsOvercomesFriction) {
  PointMass mass(0.0, 0.0);
  const double pull = 3.0, m = 2.0, mu = 0.4;
  mass.moves(m, {{"vx", pull * mass.model.time()}});
  mass.model.contact("ground", mass.z, {.tangent = {{"x", 1.0}}, .friction = mu});
  const auto run = run_tightly(mass.model, 4.0);
  expect_done(run);
  ASSERT_EQ(kinds(run), std::vector<EventKind>{EventKind::slip});
  const double t = mu * m * g / pull;
  EXPECT_NEAR(run.events[0].t, t, 1e-12);
  EXPECT_NEAR(run.final.x[2], pull * (4.0 - t) * (4.0 - t) / (2.0 * m), 1e-10);
  EXPECT_NEAR(run.final.x[0], pull * std::pow(4.0 - t, 3) / (6.0 * m), 1e-10);
}

/// m v' = F sin t - mu m g sign v with F > mu m g: stick, slip up, stick, slip down, with closed forms between.
TEST(Contacts, SticksAndSlipsUnderAnOscillatingForce) {
  PointMass mass(0.0, 0.0);
  const double force = 6.0, mu = 0.5;
  mass.moves(1.0, {{"vx", force * sin(mass.model.time())}});
  mass.model.contact("ground", mass.z, {.tangent = {{"x", 1.0}}, .friction = mu});
  const auto run = run_tightly(mass.model, 6.0);
  expect_done(run);
  ASSERT_GE(run.events.size(), 3U);
  const double first = std::asin(mu * g / force);
  EXPECT_EQ(run.events[0].kind, EventKind::slip);
  EXPECT_NEAR(run.events[0].t, first, 1e-11);
  EXPECT_EQ(run.events[1].kind, EventKind::stick);
  const double second = run.events[1].t;
  EXPECT_NEAR(force * (std::cos(first) - std::cos(second)) - mu * g * (second - first), 0.0, 1e-10);
  EXPECT_EQ(run.events[2].kind, EventKind::slip);
  EXPECT_NEAR(run.events[2].t, first + std::acos(-1.0), 1e-10);
  for (std::size_t i = 0; i < run.trajectory.t.size(); ++i) {
    if (run.trajectory.contact_modes[i][0] == ContactMode::stick) {
      EXPECT_EQ(run.trajectory.x[i][2], 0.0);
    }
  }
}

TEST(Contacts, RestitutionKnowsTheMassMatrix) {
  model::Builder model("rotated");
  const SX a = model.state("a", {1.0}), b = model.state("b", {2.0});
  static_cast<void>(model.state("va", {-1.0}));
  static_cast<void>(model.state("vb", {-3.0}));
  const SX mass = SX::blockcat({{3.0, 0.5}, {0.5, 2.0}});
  model.mechanics({.positions = {"a", "b"}, .velocities = {"va", "vb"}, .mass = mass});
  model.contact("wall", a + 2.0 * b, {.restitution = 0.5});
  const auto run = run_tightly(model, 1.0);
  expect_done(run);
  ASSERT_EQ(run.events.size(), 1U);
  const auto& event = run.events[0];
  EXPECT_NEAR(event.t, 5.0 / 7.0, 1e-12);
  const double det = 3.0 * 2.0 - 0.25, ra = (2.0 - 0.5 * 2.0) / det, rb = (-0.5 + 3.0 * 2.0) / det;  // M^-1 n
  const double impulse = 1.5 * 7.0 / (ra + 2.0 * rb);
  EXPECT_NEAR(event.x_after[2], -1.0 + impulse * ra, 1e-12);
  EXPECT_NEAR(event.x_after[3], -3.0 + impulse * rb, 1e-12);
}

/// Of three equal balls in a row the first one hits; the other two touch each other. Compression ends with one
/// velocity.
TEST(Contacts, NewtonsCradle) {
  model::Builder model("cradle");
  std::vector<SX> q;
  const std::vector<double> place{0.0, 2.0, 3.0}, speed{1.0, 0.0, 0.0};
  for (std::size_t i = 0; i < 3; ++i) q.push_back(model.state("q" + std::to_string(i), {place[i]}));
  for (std::size_t i = 0; i < 3; ++i) static_cast<void>(model.state("v" + std::to_string(i), {speed[i]}));
  model.mechanics({.positions = {"q0", "q1", "q2"}, .velocities = {"v0", "v1", "v2"}});
  model.contact("first", q[1] - q[0] - 1.0, {.restitution = 1.0});
  model.contact("second", q[2] - q[1] - 1.0, {.restitution = 1.0});
  const auto run = run_tightly(model, 2.0);
  expect_done(run);
  ASSERT_EQ(kinds(run), std::vector<EventKind>{EventKind::impact});
  EXPECT_NEAR(run.events[0].t, 1.0, 1e-12);
  const std::vector<double> exact{-1.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0};
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(run.final.x[3 + i], exact[i], 1e-12);
}

/// A block on an incline that tips up: it sticks until tan(angle) = mu, then slides.
TEST(Contacts, ABlockOnTwoFeetSticksAndSlides) {
  model::Builder model("block");
  const SX x = model.state("x", {0.0}), z = model.state("z", {0.0}), phi = model.state("phi", {0.0});
  for (const char* name : {"vx", "vz", "w"}) static_cast<void>(model.state(name, {0.0}));
  const SX t = model.time();
  model.mechanics({.positions = {"x", "z", "phi"},
                   .velocities = {"vx", "vz", "w"},
                   .mass = SX::diag(SX(std::vector<double>{2.0, 2.0, 0.3})),
                   .force = {{"vx", 2.0 * t}, {"vz", -20.0}}});
  model.contact("left", z - sin(phi), {.tangent = {{"x", 1.0}}, .friction = 0.5});
  model.contact("right", z + sin(phi), {.tangent = {{"x", 1.0}}, .friction = 0.5});
  const auto run = run_tightly(model, 7.0);
  expect_done(run);
  ASSERT_FALSE(run.events.empty());
  EXPECT_EQ(run.events.back().kind, EventKind::slip);
  EXPECT_NEAR(run.events.back().t, 5.0, 1e-8);
  EXPECT_NEAR(run.final.x[3], 0.5 * (7.0 - 5.0) * (7.0 - 5.0), 1e-8);
  expect_apart(run, {0, 4});
}

/// Two discs on a table, one pushed: it rolls off the other one. Where the force ends, gap, rate and acceleration are
/// roundings.
TEST(Contacts, ADiscLeavesAnotherOneAtEveryTolerance) {
  model::Builder model("discs");
  const SX x1 = model.state("x1", {-2.0}), y1 = model.state("y1", {0.0}), x2 = model.state("x2", {-1.0}),
           y2 = model.state("y2", {0.1});
  const SX vx1 = model.state("vx1", {4.0}), vy1 = model.state("vy1", {0.0}), vx2 = model.state("vx2", {0.0}),
           vy2 = model.state("vy2", {0.0});
  model.mechanics(
      {.positions = {"x1", "y1", "x2", "y2"},
       .velocities = {"vx1", "vy1", "vx2", "vy2"},
       .mass = SX::diag(SX(std::vector<double>{2.0, 2.0, 1.0, 1.0})),
       .force = {{"vx1", 10.0 - 2.0 * vx1}, {"vy1", -2.0 * vy1}, {"vx2", -2.0 * vx2}, {"vy2", -2.0 * vy2}}});
  model.contact("discs", (x1 - x2) * (x1 - x2) + (y1 - y2) * (y1 - y2) - 0.25);
  for (const auto method : {ode::Method::dopri5, ode::Method::dop853, ode::Method::taylor, ode::Method::radau5}) {
    for (const double rtol : {1e-5, 1e-6, 1e-7, 1e-9, 1e-11}) {
      SCOPED_TRACE(::testing::Message() << static_cast<int>(method) << " " << rtol);
      IntegrationOptions options;
      options.method = method;
      options.tolerances = {rtol, rtol / 100.0};
      options.until = 2.0;
      options.max_events = 100;
      const auto run = run_model(model, options);
      expect_done(run);
      EXPECT_EQ(kinds(run), (std::vector<EventKind>{EventKind::impact, EventKind::lift_off}));
      EXPECT_NEAR(run.events.back().t, 0.46576918, 1e3 * rtol);
    }
  }
}

/// A step may lead from one side of the post to the other one: what is found on its way is located on the near side,
/// however little the iteration of an implicit step leaves of it.
TEST(Contacts, AFreeBallHitsARoundPost) {
  struct Flight {
    double x, y, v, until;
  };
  constexpr double radius = 0.2;
  constexpr Flight flights[] = {
      {-1.06, -0.066, 4.945, 1.9735085945399393}, {-1.1, -0.127, 2.065, 0.976997578692494},
      {-1.274, 0.005, 4.141, 2.9239314175319966}, {-1.648, -0.081, 2.964, 4.501518218623482},
      {-1.3, -0.143, 4.351, 3.220983681912204},   {-0.727, 0.13, 3.688, 1.2095986984815619},
      {-1.424, 0.0, 0.515, 30.192233009708737},   {-0.561, -0.014, 4.877, 0.8328890711502974}};
  for (const auto method : {ode::Method::dopri5, ode::Method::dop853, ode::Method::radau5, ode::Method::radau9,
                            ode::Method::radau13, ode::Method::taylor}) {
    for (const auto& flight : flights) {
      SCOPED_TRACE(::testing::Message() << static_cast<int>(method) << " from " << flight.x << ", " << flight.y);
      model::Builder model("post");
      const SX x = model.state("x", {flight.x}), y = model.state("y", {flight.y});
      static_cast<void>(model.state("vx", {flight.v}));
      static_cast<void>(model.state("vy", {0.0}));
      model.mechanics({.positions = {"x", "y"}, .velocities = {"vx", "vy"}});
      model.contact("post", sqrt(x * x + y * y) - radius, {.restitution = 1.0});
      IntegrationOptions options;
      options.method = method;
      options.tolerances = {1e-8, 1e-10};
      options.until = flight.until;
      const auto run = run_model(model, options);
      expect_done(run);
      ASSERT_EQ(kinds(run), std::vector<EventKind>{EventKind::impact});
      const double way = -std::sqrt(radius * radius - flight.y * flight.y) - flight.x;
      EXPECT_NEAR(run.events[0].t, way / flight.v, 1e-12);
      expect_apart(run, {0});
    }
  }
}

TEST(Contacts, CollidesAtTheStart) {
  model::Builder model("start");
  const SX y = model.state("y", {0.0});
  static_cast<void>(model.state("v", {-2.0}));
  model.mechanics({.positions = {"y"}, .velocities = {"v"}, .potential = 10.0 * y});
  model.contact("ground", y, {.restitution = 0.5});
  const auto run = run_tightly(model, 0.1);
  expect_done(run);
  ASSERT_EQ(kinds(run), std::vector<EventKind>{EventKind::impact});
  EXPECT_EQ(run.events[0].t, 0.0);
  EXPECT_NEAR(run.final.x[1], 1.0 - 10.0 * 0.1, 1e-12);
}

}  // namespace
}  // namespace saltus::event_integrator::testing
