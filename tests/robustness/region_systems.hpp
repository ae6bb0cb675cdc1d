// Random systems of regions by indicator as plain numbers.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "saltus/result/result.hpp"
#include "tally.hpp"

namespace saltus::robustness {

enum class RegionKind {
  cells,    ///< indicators |x - centre|^2, in two or three states
  sectors,  ///< of the plane about one point: indicators slope . x, three to seven of them
  cones,    ///< indicators slope . x + offset in three states, or all offsets 0
};

/// xdot = A_i x + b_i where the indicator quadratic |x|^2 + slope_i . x + offset_i is the smallest.
struct Region {
  std::vector<double> slope;
  double offset = 0.0;
  std::vector<double> b;
  std::vector<std::vector<double>> A;
};

struct RegionSystem {
  RegionKind kind = RegionKind::cells;
  std::uint64_t seed = 0;
  double quadratic = 0.0;
  std::vector<double> start;
  std::vector<Region> regions;
};

/// The system number `seed`: the same on every machine.
[[nodiscard]] RegionSystem draw_regions(std::uint64_t seed);

/// With Taylor series for 16, Dormand and Prince's pairs for 5 and 8; regions are "r0", "r1", ….
class RegionModel {
 public:
  explicit RegionModel(const RegionSystem& system);
  ~RegionModel();
  [[nodiscard]] result::Result run(int order, double rtol, const std::vector<double>& start) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

/// The first thing that is wrong with a run to `rtol`, or an empty string: a status, rows whose active regions are not
/// those with the smallest indicator, or whose weights do not hold them together; stretches that Runge-Kutta steps of
/// fixed length with weights of their own do not confirm, as far as linear equations determine these.
[[nodiscard]] std::string complaint(const RegionSystem& system, const result::Result& result, double rtol);

[[nodiscard]] Tally run_region_campaign(std::uint64_t first, std::uint64_t count);

}  // namespace saltus::robustness
