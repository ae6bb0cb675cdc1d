#include "saltus/switching/table/group_decision.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <optional>
#include <vector>

#include "saltus/base/at.hpp"
#include "saltus/base/contracts.hpp"
#include "saltus/switching/table/field_accuracy.hpp"

namespace saltus::switching {
namespace {

/// The table with some selections fixed: weights of the two values of every bit, or free.
class RestrictedTable {
 public:
  explicit RestrictedTable(const CornerTable& table)
      : table_(table), fixed_(static_cast<std::size_t>(table.surfaces)) {}

  void fix(int surface, double alpha) { fixed_[at(surface)] = alpha; }
  [[nodiscard]] bool is_free(int surface) const { return !fixed_[at(surface)].has_value(); }
  [[nodiscard]] bool is_interpolated() const {
    return std::any_of(fixed_.begin(), fixed_.end(), [](const auto& a) { return a && *a != 0.0 && *a != 1.0; });
  }

  /// Free corners: those whose fixed bits are 0 (the fixed selections are summed over).
  [[nodiscard]] bool is_representative(std::size_t corner) const {
    for (std::size_t i = 0; i < fixed_.size(); ++i) {
      if (fixed_[i] && (corner >> i & 1U) != 0) return false;
    }
    return true;
  }

  /// Side of `surface` at a free corner. An interpolated value has the drift of its sign.
  [[nodiscard]] Side side(int surface, std::size_t corner) const {
    Side sum;
    double magnitude = 0.0;
    for (std::size_t other = 0; other < table_.corners(); ++other) {
      const double weight = weight_of(corner, other);
      if (weight == 0.0) continue;
      const Side& side = table_.side(surface, other);
      if (weight == 1.0) return side;
      sum.velocity += weight * side.velocity;
      magnitude += weight * std::abs(side.velocity);
    }
    if (std::abs(sum.velocity) <= field_rounding * magnitude) return sum;  // interpolated tangency: stays
    sum.drift = sum.velocity > 0.0 ? Drift::up : Drift::down;
    return sum;
  }

 private:
  static std::size_t at(int surface) { return static_cast<std::size_t>(surface); }

  [[nodiscard]] double weight_of(std::size_t free_corner, std::size_t corner) const {
    double weight = 1.0;
    for (std::size_t i = 0; i < fixed_.size(); ++i) {
      const bool bit = (corner >> i & 1U) != 0;
      if (fixed_[i]) {
        weight *= bit ? *fixed_[i] : 1.0 - *fixed_[i];
      } else if (((corner ^ free_corner) >> i & 1U) != 0) {  // NOTE: comparing two bits is miscompiled by g++ 12.2 -O1
        return 0.0;
      }
    }
    return weight;
  }

  const CornerTable& table_;
  std::vector<std::optional<double>> fixed_;
};

/// The common drift of a surface at all free corners, if there is one and it is not `stays`.
std::optional<Drift> definite_drift(const CornerTable& table, const RestrictedTable& restricted, int surface) {
  std::optional<Drift> common;
  for (std::size_t corner = 0; corner < table.corners(); ++corner) {
    if (!restricted.is_representative(corner)) continue;
    const Drift drift = restricted.side(surface, corner).drift;
    if (drift == Drift::stays || (common && *common != drift)) return std::nullopt;
    common = drift;
  }
  return common;
}

bool same_side(const Side& a, const Side& b, double scale) {
  return a.drift == b.drift && std::abs(a.velocity - b.velocity) <= field_rounding * scale;
}

double largest_velocity(const CornerTable& table, int surface) {
  double largest = 0.0;
  for (std::size_t corner = 0; corner < table.corners(); ++corner) {
    largest = std::max(largest, std::abs(table.side(surface, corner).velocity));
  }
  return largest;
}

/// The situation of a surface whose sides depend on its own selection only.
std::optional<SurfaceSituation> own_situation(const CornerTable& table, const RestrictedTable& restricted,
                                              int surface) {
  std::optional<Side> below;
  std::optional<Side> above;
  const double scale = largest_velocity(table, surface);
  for (std::size_t corner = 0; corner < table.corners(); ++corner) {
    if (!restricted.is_representative(corner)) continue;
    auto& known = (corner >> surface & 1U) != 0 ? above : below;
    const Side side = restricted.side(surface, corner);
    if (known && !same_side(*known, side, scale)) return std::nullopt;
    known = side;
  }
  return SurfaceSituation{*below, *above, table.arrival[at(surface)]};
}

/// Decides surface j from the table as restricted so far, if one of the two rules applies.
std::optional<SurfaceDecision> decide_by_rule(const CornerTable& table, const RestrictedTable& restricted, int j) {
  if (const auto own = own_situation(table, restricted, j)) {
    SurfaceDecision result = decide_surface(*own);
    // An interpolated tangency has no higher derivatives in the table to decide it.
    if (result.verdict == Verdict::stands && restricted.is_interpolated()) result.verdict = Verdict::coupled;
    return result;
  }
  if (const auto drift = definite_drift(table, restricted, j)) {
    const int side = static_cast<int>(*drift);
    return SurfaceDecision{Verdict::decided,
                           side,
                           side > 0 ? 1.0 : 0.0,
                           {},
                           side > 0 ? "all fields point to psi > 0" : "all fields point to psi < 0"};
  }
  return std::nullopt;
}

}  // namespace

GroupDecision decide_group(const CornerTable& table) {
  SALTUS_ASSERT(1 <= table.surfaces && table.surfaces <= 12);
  GroupDecision decision;
  decision.surfaces.resize(static_cast<std::size_t>(table.surfaces));
  RestrictedTable restricted(table);
  std::vector<int> open(static_cast<std::size_t>(table.surfaces));
  std::iota(open.begin(), open.end(), 0);
  for (int round = 0; !open.empty(); ++round) {
    std::vector<int> decided;
    for (const int j : open) {
      auto result = decide_by_rule(table, restricted, j);
      if (!result) continue;
      // Behind the first round the hidden transient may have carried the solution to another continuation.
      if (round > 0 && !result->other_modes.empty()) result->verdict = Verdict::coupled;
      if (result->verdict != Verdict::decided) {
        decision.verdict = result->verdict;
        decision.culprit = j;
      }
      if (result->verdict == Verdict::two_fold || result->verdict == Verdict::coupled) return decision;
      decision.surfaces[at(j)] = *result;
      decided.push_back(j);
    }
    if (decided.empty()) {
      decision.verdict = Verdict::coupled;
      decision.culprit = open.front();
      return decision;
    }
    for (const int j : decided) {
      restricted.fix(j, decision.surfaces[at(j)].alpha);
      std::erase(open, j);
    }
  }
  return decision;
}

std::vector<std::vector<int>> parts_by_influence(const CornerTable& table) {
  SALTUS_ASSERT(1 <= table.surfaces && table.surfaces <= 12);
  const auto m = static_cast<std::size_t>(table.surfaces);
  std::vector<unsigned> influence(m);  // bit j: surface i depends on surface j, at last through others
  for (std::size_t i = 0; i < m; ++i) {
    const int surface = static_cast<int>(i);
    const double scale = largest_velocity(table, surface);
    influence[i] = 1U << i;
    for (std::size_t corner = 0; corner < table.corners(); ++corner) {
      for (std::size_t j = 0; j < m; ++j) {
        const std::size_t other = corner ^ (std::size_t{1} << j);
        if (!same_side(table.side(surface, corner), table.side(surface, other), scale)) influence[i] |= 1U << j;
      }
    }
  }
  for (std::size_t k = 0; k < m; ++k) {
    for (std::size_t i = 0; i < m; ++i) {
      if ((influence[i] >> k & 1U) != 0) influence[i] |= influence[k];
    }
  }
  // Who depends on fewer comes first; those of one part depend on the same.
  std::vector<int> order(m);
  std::iota(order.begin(), order.end(), 0);
  const auto felt = [&](int i) { return influence[at(i)]; };
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    const int fewer = std::popcount(felt(a)), more = std::popcount(felt(b));
    return fewer != more ? fewer < more : felt(a) < felt(b);
  });
  std::vector<std::vector<int>> parts;
  for (const int i : order) {
    if (parts.empty() || felt(parts.back().front()) != felt(i)) parts.emplace_back();
    parts.back().push_back(i);
  }
  return parts;
}

}  // namespace saltus::switching
