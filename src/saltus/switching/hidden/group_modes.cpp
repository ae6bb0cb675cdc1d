#include "saltus/switching/hidden/group_modes.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

#include "saltus/base/at.hpp"
#include "saltus/base/contains.hpp"
#include "saltus/base/contracts.hpp"
#include "saltus/base/stop.hpp"
#include "saltus/switching/hidden/hidden_face_internal.hpp"
#include "saltus/switching/plane/plane_internal.hpp"
#include "saltus/switching/selections/selection_newton.hpp"
#include "saltus/switching/table/matrix_stability.hpp"
#include "saltus/switching/table/multi_affine.hpp"

namespace saltus::switching {
namespace {

/// Half the width of the smallest boxes: nearer roots may be missed, or taken for one.
constexpr double smallest = 0x1p-6;

/// The velocities of a table between its corners.
struct CornerField {
  MultiAffine g;
  void operator()(const double* alpha, double* velocity) const { g.evaluate(alpha, velocity); }
};

/// The modes of one table, one zone of the cube after the other.
class Enumeration {
 public:
  Enumeration(const CornerTable& table, Borderline borderline)
      : table_(table),
        keeps_borderline_(borderline == Borderline::kept),
        m_(at(table.surfaces)),
        field_{MultiAffine(table)},
        face_(table.surfaces, field_, Interpolation::multi_affine),
        u_(m_),
        v_(m_),
        zone_(m_, -1) {}

  std::vector<GroupMode> run() {
    do {
      heed_stop();
      look_at_zone();
    } while (next_zone());
    return std::move(modes_);
  }

 private:
  bool next_zone() {
    for (int& z : zone_) {
      if (++z <= 1) return true;
      z = -1;
    }
    return false;
  }

  void look_at_zone() {
    for (std::size_t j = 0; j < m_; ++j) u_[j] = zone_[j] > 0 ? 1.0 : zone_[j] < 0 ? 0.0 : 0.5;
    if (!contains(zone_, 0)) return look_at_region();
    face_.enter(zone_);
    const std::vector<double> half(face_.free().size(), 0.5);
    bisect(half, 0.5);
  }

  /// Regions by their drifts, so that tangencies count by their higher derivatives.
  void look_at_region() {
    std::size_t corner = 0;
    for (std::size_t j = 0; j < m_; ++j) corner |= (zone_[j] > 0 ? std::size_t{1} : 0U) << j;
    for (std::size_t j = 0; j < m_; ++j) {
      if (static_cast<int>(table_.side(static_cast<int>(j), corner).drift) != zone_[j]) return;
    }
    modes_.push_back({zone_, u_});
  }

  /// The box of the free selections around `middle` that extends `half` to all sides.
  void bisect(const std::vector<double>& middle, double half) {
    if (!may_hold_root(middle, half)) return;
    if (half <= smallest || (half < 0.5 && is_settled(middle, half))) return;
    for (std::size_t part = 0; part < std::size_t{1} << middle.size(); ++part) {
      std::vector<double> inner = middle;
      for (std::size_t i = 0; i < inner.size(); ++i) inner[i] += (part >> i & 1U) != 0 ? 0.5 * half : -0.5 * half;
      bisect(inner, 0.5 * half);
    }
  }

  bool may_hold_root(const std::vector<double>& middle, double half) {
    const auto& free = face_.free();
    std::vector<bool> below(free.size()), above(free.size());
    for (std::size_t corner = 0; corner < std::size_t{1} << free.size(); ++corner) {
      for (std::size_t i = 0; i < free.size(); ++i) {
        u_[at(free[i])] = middle[i] + ((corner >> i & 1U) != 0 ? half : -half);
      }
      face_.velocity(u_.data(), v_.data());
      for (std::size_t i = 0; i < free.size(); ++i) {
        below[i] = below[i] || v_[at(free[i])] <= 0.0;
        above[i] = above[i] || v_[at(free[i])] >= 0.0;
      }
    }
    const auto holds = [](bool value) { return value; };
    return std::all_of(below.begin(), below.end(), holds) && std::all_of(above.begin(), above.end(), holds);
  }

  /// Newton's method from the middle: whether the root that it finds is the only one in the smallest box that holds
  /// both it and this box.
  bool is_settled(const std::vector<double>& middle, double half) {
    const auto& free = face_.free();
    const std::size_t n = free.size();
    std::vector<double> selections = middle;
    SelectionNewton newton(static_cast<int>(n));
    const auto velocities = [&](const double* alpha, double* g) {
      for (std::size_t i = 0; i < n; ++i) u_[at(free[i])] = alpha[i];
      face_.velocity(u_.data(), v_.data());
      for (std::size_t i = 0; i < n; ++i) g[i] = v_[at(free[i])];
    };
    if (!newton.solve(velocities, selections.data())) return false;
    std::vector<double> low(n), high(n);
    for (std::size_t i = 0; i < n; ++i) {
      low[i] = std::min(middle[i] - half, selections[i]);
      high[i] = std::max(middle[i] + half, selections[i]);
    }
    std::vector<double> rest(n);
    velocities(selections.data(), rest.data());
    note(selections, newton.jacobian());
    return is_one_to_one(newton.jacobian(), low, high);
  }

  /// Whether G(root)^-1 G has dominant diagonals in the whole box, which its corners tell, G being multi-affine, too:
  /// g takes no value twice there.
  bool is_one_to_one(std::span<const double> jacobian, const std::vector<double>& low,
                     const std::vector<double>& high) {
    const auto& free = face_.free();
    const std::size_t n = free.size();
    LuFactors lu(static_cast<int>(n));
    if (!lu.factor(jacobian)) return false;
    std::vector<double> derivatives(m_ * n), column(n), least(n, 2.0), most(n * n, 0.0);
    for (std::size_t corner = 0; corner < std::size_t{1} << n; ++corner) {
      for (std::size_t i = 0; i < n; ++i) {
        u_[at(free[i])] = (corner >> i & 1U) != 0 ? high[i] : low[i];
      }
      face_.velocity(u_.data(), v_.data());
      face_.derivatives(u_.data(), v_.data(), derivatives.data());
      for (std::size_t p = 0; p < n; ++p) {
        for (std::size_t i = 0; i < n; ++i) column[i] = derivatives[at(free[i]) * n + p];
        lu.solve(column.data());
        for (std::size_t i = 0; i < n; ++i) {
          if (i == p) least[i] = std::min(least[i], column[i]);
          if (i != p) most[i * n + p] = std::max(most[i * n + p], std::abs(column[i]));
        }
      }
    }
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t p = 0; p < n; ++p) least[i] -= most[i * n + p];
      if (!(least[i] > 0.0)) return false;
    }
    return true;
  }

  /// The root that u_ is at, with its velocities in v_: a mode, if it is inside and the others are left.
  void note(const std::vector<double>& selections, std::span<const double> jacobian) {
    const double least = keeps_borderline_ ? -sign_tolerance : sign_tolerance;
    for (const double a : selections) {
      if (!(a > least && a < 1.0 - least)) return;
    }
    for (std::size_t j = 0; j < m_; ++j) {
      if (zone_[j] != 0 && !(zone_[j] * v_[j] > least)) return;
    }
    if (keeps_borderline_ && !(fisher_fuller_margin(jacobian, static_cast<int>(selections.size())) > 0.0)) return;
    const auto is_known = [&](const GroupMode& known) {
      return known.mode == zone_ && std::equal(u_.begin(), u_.end(), known.alpha.begin(),
                                               [](double a, double b) { return std::abs(a - b) <= 1e-8; });
    };
    if (std::none_of(modes_.begin(), modes_.end(), is_known)) modes_.push_back({zone_, u_});
  }

  const CornerTable& table_;
  bool keeps_borderline_;
  std::size_t m_;
  CornerField field_;
  HiddenFace face_;
  std::vector<double> u_, v_;
  std::vector<int> zone_;
  std::vector<GroupMode> modes_;
};

}  // namespace

std::vector<GroupMode> admissible_modes(const CornerTable& table, Borderline borderline) {
  SALTUS_ASSERT(table.surfaces >= 1 && table.surfaces <= largest_enumerated);
  return Enumeration(table, borderline).run();
}

}  // namespace saltus::switching
