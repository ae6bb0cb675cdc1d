// Random systems with jumps, hysteresis and moving surfaces as plain numbers.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "saltus/result/result.hpp"
#include "tally.hpp"

namespace saltus::robustness {

enum class HybridFamily {
  jumps,   ///< masses between walls that restitute, with dry friction; or thresholds whose resets set off others
  relays,  ///< relays with two thresholds, and additive laws on surfaces that move, in up to 12 states
};
inline constexpr HybridFamily hybrid_families[] = {HybridFamily::jumps, HybridFamily::relays};
[[nodiscard]] std::string name(HybridFamily family);

/// A function of time: constant + amplitude sin(frequency t), or linear between points.
struct Course {
  double constant = 0.0, amplitude = 0.0, frequency = 1.0;
  std::vector<double> times, values;  ///< instead; constant outside
};

/// xdot_row -= size sign(x_row - course(t))
struct Law {
  std::size_t row = 0;
  double size = 0.0;
  Course course;
};

/// At x_position = place, velocity -e velocity where it points outwards; the state stays on `side` of it.
struct Wall {
  std::size_t position = 0, velocity = 0;
  double place = 0.0, side = 1.0, restitution = 0.5;
};

/// Where x_state exceeds its threshold, x += reset.
struct Threshold {
  std::size_t state = 0;
  double value = 0.0;
  std::vector<double> reset;
};

/// A discrete state n in {-1, 1}: -1 from slope . x > high on, 1 from slope . x < low on; xdot_row += gain n.
struct Relay {
  std::vector<double> slope;
  double low = 0.0, high = 0.0, gain = 0.0, start = 1.0;
  std::size_t row = 0;
};

/// xdot = A x + b + courses - laws + relays. State: the continuous ones, then one for each relay.
struct Hybrid {
  HybridFamily family = HybridFamily::jumps;
  std::uint64_t seed = 0;
  std::vector<double> start;  ///< continuous
  std::vector<std::vector<double>> A;
  std::vector<double> b;
  std::vector<std::pair<std::size_t, Course>> drives;
  std::vector<Law> laws;
  std::vector<Wall> walls;
  std::vector<Threshold> thresholds;
  std::vector<Relay> relays;
};

/// The system number `seed` of a family: the same on every machine.
[[nodiscard]] Hybrid draw(HybridFamily family, std::uint64_t seed);

enum class HybridIntegrator { dopri5, dop853, taylor };

/// Compiled, to be run from any start (continuous states) to t = 10. Throws std::runtime_error where a model does not
/// build. Laws are the columns "s0", "s1", …; jumps are "wall0", "threshold0", "high0", "low0", ….
class HybridModel {
 public:
  explicit HybridModel(const Hybrid& hybrid);
  ~HybridModel();
  [[nodiscard]] result::Result run(HybridIntegrator integrator, double rtol, const std::vector<double>& start) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

/// The first thing that is wrong with a run to `rtol`, or an empty string. By code that shares nothing with the engine:
/// rows on their sides of laws, walls and thresholds, and on the surfaces they slide on; stretches between them by
/// Runge-Kutta steps of fixed length; jumps by their own resets of the state before, at their thresholds.
[[nodiscard]] std::string complaint(const Hybrid& hybrid, const result::Result& result, double rtol);

/// What has come of systems first to first + count - 1, with each integrator at 1e-8.
[[nodiscard]] Tally run_campaign(HybridFamily family, std::uint64_t first, std::uint64_t count);

}  // namespace saltus::robustness
