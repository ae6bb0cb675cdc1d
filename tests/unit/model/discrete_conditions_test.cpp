// Random conditions over discrete states, read by three ways and compared with their truth.
#include <array>
#include <functional>
#include <random>

#include "model_text.hpp"

namespace saltus::model {
namespace {

/// A condition over n and m as text, and what it says.
struct Stated {
  std::string text;
  std::function<bool(double n, double m)> truth;
};

class Generator {
 public:
  explicit Generator(unsigned seed) : random_(seed) {}

  Stated condition(int depth) {
    const int kind = depth == 0 ? 0 : draw(4);
    if (kind == 0) return comparison();
    const Stated a = condition(depth - 1);
    if (kind == 1) return {"not (" + a.text + ")", [a](double n, double m) { return !a.truth(n, m); }};
    const Stated b = condition(depth - 1);
    if (kind == 2) {
      return {"(" + a.text + " and " + b.text + ")",
              [a, b](double n, double m) { return a.truth(n, m) && b.truth(n, m); }};
    }
    return {"(" + a.text + " or " + b.text + ")",
            [a, b](double n, double m) { return a.truth(n, m) || b.truth(n, m); }};
  }

 private:
  int draw(int below) { return std::uniform_int_distribution<int>(0, below - 1)(random_); }

  struct Side {
    std::string text;
    std::function<double(double, double)> value;
  };

  Side side() {
    const double c = draw(4);
    const std::string number = std::to_string(static_cast<int>(c));
    switch (draw(5)) {
      case 0:
        return {number, [c](double, double) { return c; }};
      case 1:
        return {"n", [](double n, double) { return n; }};
      case 2:
        return {"2*m - " + number, [c](double, double m) { return 2.0 * m - c; }};
      case 3:
        return {"max(n, " + number + ")", [c](double n, double) { return std::max(n, c); }};
      default:
        return {"abs(m - " + number + ")", [c](double, double m) { return std::abs(m - c); }};
    }
  }

  Stated comparison() {
    const Side a = side(), b = side();
    const auto stated = [&](const std::string& op, auto compare) {
      return Stated{a.text + op + b.text,
                    [a, b, compare](double n, double m) { return compare(a.value(n, m), b.value(n, m)); }};
    };
    switch (draw(6)) {
      case 0:
        return stated(" < ", std::less<>());
      case 1:
        return stated(" <= ", std::less_equal<>());
      case 2:
        return stated(" > ", std::greater<>());
      case 3:
        return stated(" >= ", std::greater_equal<>());
      case 4:
        return stated(" == ", std::equal_to<>());
      default:
        return stated(" != ", std::not_equal_to<>());
    }
  }

  std::mt19937 random_;
};

/// Selections as the engine reads them, inner ones first: pointwise, as written at 0.
std::vector<double> selections(const System& system, const std::vector<double>& x) {
  std::vector<double> alpha(system.switching.size(), 0.5);
  for (std::size_t j = 0; j < alpha.size(); ++j) {
    EXPECT_EQ(system.switching[j].role, SwitchingRole::discrete) << system.switching[j].name;
    const double psi = value(system, system.switching[j].psi, x, alpha);
    alpha[j] = psi > 0.0 ? 1.0 : (psi < 0.0 ? 0.0 : system.switching[j].alpha_at_zero);
  }
  return alpha;
}

bool jump_condition(const System& system, const std::vector<double>& x, const std::vector<double>& alpha) {
  const Jump& jump = system.jumps.at(0);
  const auto guards = values(system, jump.guards, x, alpha);
  std::vector<double> steps;
  for (std::size_t i = 0; i < guards.size(); ++i) {
    steps.push_back(guards[i] > 0.0 || (guards[i] == 0.0 && jump.true_at_equality[i]) ? 1.0 : 0.0);
  }
  const casadi::Function f("f", {system.t, system.x, system.p, system.alpha, jump.guard_alpha}, {jump.value});
  return double(f(std::vector<casadi::DM>{0.0, x, system.parameter_values, alpha, steps}).at(0)) == 1.0;
}

/// if() in [dynamics] of x, a mode of y, the condition of a jump: all of the same text.
Expected<System> three_ways(const Stated& stated) {
  Description description = describe({.states = {{"x", "0"}, {"y", "0"}, {"n", "0"}, {"m", "0"}},
                                      .dynamics = {{"x", "if(" + stated.text + ", 7, 3)"}, {"n", "0"}, {"m", "0"}}});
  ModeDescription mode, other;
  mode.when = parsed(stated.text, {});
  mode.dynamics = {{"y", expression::number(7.0, {}), {}}};
  other.when = parsed("otherwise", {});
  other.dynamics = {{"y", expression::number(3.0, {}), {}}};
  description.modes = {mode, other};
  JumpDescription jump;
  jump.when = parsed(stated.text, {});
  jump.set = {{"n", expression::number(1.0, {}), {}}};
  description.jumps = {jump};
  return build(description, {});
}

TEST(DiscreteConditions, HoldAsWrittenInDynamicsModesAndJumps) {
  constexpr std::array places{-1.0, 0.0, 0.5, 1.0, 2.0, 3.0, 4.0};
  Generator generator(20261121);
  int accepted = 0;
  for (int k = 0; k < 120; ++k) {
    const Stated stated = generator.condition(3);
    const auto system = three_ways(stated);
    if (!system) {
      // A condition that always holds leaves nothing for 'otherwise': nothing else may be wrong with it.
      ASSERT_NE(system.error().message.find("nothing is left"), std::string::npos) << to_text(system.error());
      for (const double n : places) {
        for (const double m : places) EXPECT_TRUE(stated.truth(n, m)) << stated.text;
      }
      continue;
    }
    ++accepted;
    for (const double n : places) {
      for (const double m : places) {
        const std::vector<double> x{0.0, 0.0, n, m};
        const auto alpha = selections(*system, x);
        const auto f = values(*system, system->f, x, alpha);
        const bool truth = stated.truth(n, m);
        ASSERT_EQ(f[0], truth ? 7.0 : 3.0) << stated.text << " at n = " << n << ", m = " << m;
        ASSERT_EQ(f[1], truth ? 7.0 : 3.0) << stated.text << " at n = " << n << ", m = " << m;
        ASSERT_EQ(jump_condition(*system, x, alpha), truth) << stated.text << " at n = " << n << ", m = " << m;
      }
    }
  }
  EXPECT_GT(accepted, 100);
}

}  // namespace
}  // namespace saltus::model
