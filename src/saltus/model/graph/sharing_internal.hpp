// Which switching functions are the same: equal up to a constant factor at seeded points.
#pragma once

#include <array>
#include <functional>
#include <map>
#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

#include "saltus/model/graph/tape_internal.hpp"

namespace saltus::model {

/// Returns a repeatable number in (-1, 1) for every (point, variable): splitmix64, so that no state is kept and results
/// never depend on the order of declarations.
[[nodiscard]] double seeded_draw(std::uint64_t point, std::uint64_t variable);
/// Returns what the draws of a variable are seeded with.
[[nodiscard]] inline std::uint64_t seed_of(const Tape& tape, std::size_t variable) {
  return static_cast<std::uint64_t>(tape.variables()[variable].number);
}

/// Points of the pool: 16 common finite ones are found among the first for all but contrived domains; the extreme ones
/// after them only tell functions apart that look alike nearer by, as x - 1e20 and x - 2e20 do.
inline constexpr int pool_points = 64;
inline constexpr int extreme_points = 12;

/// Returns the value of a polynomial expression that does not change with t, x, u, whatever its alphas (corners) are;
/// with the parameters' values, to rounding. A value that is 0 to rounding is 0.
[[nodiscard]] std::optional<double> constant_value(const Tape& tape, int node);

struct SharedFunction {
  int function = 0;
  int orientation = +1;  ///< -1: the factor is negative
};

/// Holds the switching functions met so far, found again by their values. Cost: logarithmic in their number for
/// functions that are finite at the first two points, else linear.
class SharingIndex {
 public:
  void insert(const Tape& tape, int psi, int function);
  /// Finds the first-met function that is a multiple of psi and that `accepts` takes.
  [[nodiscard]] std::optional<SharedFunction> find(const Tape& tape, int psi,
                                                   const std::function<bool(const SharedFunction&)>& accepts) const;
  /// Returns whether this very expression is one of them.
  [[nodiscard]] bool has(int psi) const { return by_psi_.contains(psi); }

 private:
  struct Samples {
    int psi = 0;
    int function = 0;
    std::array<double, pool_points + extreme_points> value{}, error{};
  };
  [[nodiscard]] static Samples sample(const Tape& tape, int psi);
  [[nodiscard]] static std::optional<double> key(const Samples& samples);
  [[nodiscard]] static int same(const Samples& known, const Samples& asked);

  std::vector<Samples> known_;
  std::unordered_map<int, std::size_t> by_psi_;  ///< the first of each expression
  std::multimap<double, int> by_ratio_;          ///< value at the second point over value at the first
  std::vector<int> irregular_;                   ///< those without such a ratio
};

/// Returns for every psi the position of the first one that it is a multiple of (its own, if of none before).
[[nodiscard]] std::vector<std::size_t> first_multiples(const Tape& tape, const std::vector<int>& psi);

/// Holds a switching function at the first points of the pool where it is finite or not (NaN).
struct ThresholdSamples {
  std::array<double, pool_points> value{};
};
[[nodiscard]] ThresholdSamples threshold_samples(const Tape& tape, int psi);

/// Returns the signs (true: positive) that two parallel thresholds, a = c b + d with constants c and d, cannot have
/// together.
/// @return nothing if they are not parallel: equal to 1e-12 relative at 16 points where both are finite
[[nodiscard]] std::optional<std::pair<bool, bool>> impossible_signs(const ThresholdSamples& a,
                                                                    const ThresholdSamples& b);

}  // namespace saltus::model
