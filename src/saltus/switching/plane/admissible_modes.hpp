// All modes in which a solution can go on from the intersection of two surfaces: Filippov's non-uniqueness.
#pragma once

#include <array>
#include <cstddef>

#include "saltus/base/contracts.hpp"
#include "saltus/switching/plane/intersection_roots.hpp"
#include "saltus/switching/plane/plane_table.hpp"

namespace saltus::switching {

/// Holds a mode of both surfaces with its selections.
struct PlaneContinuation {
  PlaneMode mode{};
  PlaneAlpha alpha{};
  /// Limit of regularised solutions: a region, sliding that attracts on its surface, a root with (4.12).
  bool attracts = false;
};

/// Holds at most four regions, four edges and two roots.
class PlaneModes {
 public:
  void push(const PlaneContinuation& mode) {
    SALTUS_ASSERT(size_ < modes_.size());
    modes_[size_++] = mode;
  }
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] const PlaneContinuation& operator[](std::size_t i) const { return modes_[i]; }
  [[nodiscard]] const PlaneContinuation* begin() const { return modes_.data(); }
  [[nodiscard]] const PlaneContinuation* end() const { return modes_.data() + size_; }

 private:
  std::array<PlaneContinuation, 10> modes_{};
  std::size_t size_ = 0;
};

/// Returns the modes that continue a solution in the sense of Definition 2.1 of [guglielmi2022], each by its own
/// inequalities:
///   region k:           k_j f_j^k > 0, j = 1, 2   (by the drift, so that tangencies count by their higher derivatives)
///   sliding on psi_1, psi_2 leaves to k2: g_1(alpha_1, k2) = 0 with alpha_1 in [0, 1], k2 g_2(alpha_1, k2) > 0
///   sliding on both:    every root of g_1 = g_2 = 0 in the square, whatever its stability.
/// A mode of which an inequality is an equality to 1e-10 is left out. Order: roots, edges, regions.
[[nodiscard]] PlaneModes admissible_modes(const PlaneTable& table);

}  // namespace saltus::switching
