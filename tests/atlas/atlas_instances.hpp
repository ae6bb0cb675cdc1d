// Random situations at the intersection of two surfaces, per decision tree, each in a random one of the eight frames.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <string_view>
#include <utility>
#include <vector>

#include "../unit/switching/plane_frames.hpp"
#include "../unit/switching/random_fields.hpp"
#include "saltus/switching/plane/intersection.hpp"
#include "saltus/switching/plane/intersection_roots.hpp"
#include "saltus/switching/plane/spiral.hpp"

namespace saltus::switching {

/// entering: sliding on one surface reaches the other; edge, fold, unstable: exits (a), (b), (c) of [guglielmi2022];
/// spiral: fields that turn around the intersection.
enum class Tree { entering, edge, fold, unstable, spiral };

struct AtlasInstance {
  Velocities f{};
  Velocities rates{};             ///< d f / dt along the old mode (exits)
  std::array<double, 2> alpha{};  ///< entering: of the surface that is slid on; else the root (at the event)
  std::array<int, 2> incoming{};  ///< entering
  SquareEdge edge;                ///< edge
  Relabelling frame{0};           ///< from the frame in which the instance was made to its own

  /// Of fields that turn around the intersection.
  [[nodiscard]] bool inwards() const { return spiral_cycle(plane_table(f), 0)->cycle_ratio < 1.0; }
  [[nodiscard]] std::array<double, 2> kappa(std::array<double, 2> made) const {
    if (frame.exchange) std::swap(made[0], made[1]);
    return made;
  }
  [[nodiscard]] std::array<int, 2> mode(std::array<int, 2> made) const { return frame.signs(made); }
  /// A mode in the frame in which the instance was made.
  [[nodiscard]] std::array<int, 2> made(std::array<int, 2> mode) const {
    if (frame.exchange) std::swap(mode[0], mode[1]);
    if (frame.reflect_1) mode[0] = -mode[0];
    if (frame.reflect_2) mode[1] = -mode[1];
    return mode;
  }
};

class AtlasInstances {
 public:
  explicit AtlasInstances(unsigned seed) : random_(seed) {}

  AtlasInstance next(Tree tree) {
    for (;;) {
      AtlasInstance one;
      if (!make(tree, one)) continue;
      relabel(one);
      return one;
    }
  }

 private:
  /// f at the corners of G (x - x*, y - y*) + d (x - x*)(y - y*), per row.
  static Velocities corners_of(const std::array<std::array<double, 2>, 2>& g, const std::array<double, 2>& d,
                               const std::array<double, 2>& root) {
    Velocities f{};
    for (std::size_t k = 0; k < 4; ++k) {
      const double x = ((k & 1U) != 0 ? 1.0 : 0.0) - root[0];
      const double y = ((k & 2U) != 0 ? 1.0 : 0.0) - root[1];
      for (std::size_t j = 0; j < 2; ++j) f[j][k] = g[j][0] * x + g[j][1] * y + d[j] * x * y;
    }
    return f;
  }

  double inside() { return 0.5 + 0.45 * random_.uniform(); }

  bool make(Tree tree, AtlasInstance& one) {
    switch (tree) {
      case Tree::entering:
        return make_entering(one);
      case Tree::edge:
        return make_edge(one);
      case Tree::fold:
        return make_fold(one);
      case Tree::unstable:
        return make_unstable(one);
      case Tree::spiral:
        one.f = random_.spiral();
        one.alpha = intersection_roots(plane_table(one.f)).rising->alpha;  // there is one, (4.14)
        return true;
    }
    return false;
  }

  /// (4.3): from sliding on surface 1 in psi_2 < 0.
  bool make_entering(AtlasInstance& one) {
    one.f = random_.fields();
    const auto& f = one.f;
    one.incoming = {0, -1};
    one.alpha = {f[0][0] / (f[0][0] - f[0][1]), 0.0};
    return f[0][0] > 0.0 && f[0][1] < 0.0 && f[0][0] * f[1][1] - f[0][1] * f[1][0] > 0.0;
  }

  /// (4.8): alpha_1 passes 1.
  bool make_edge(AtlasInstance& one) {
    one.alpha = {1.0, inside()};
    one.edge = {0, 1};
    one.f = random_.fields();
    one.rates = random_.fields();
    std::array<double, 2> rate{};
    for (std::size_t j = 0; j < 2; ++j) {
      // g_j(1, alpha_2) = 0, the larger of both velocities kept.
      const double ratio = (1.0 - one.alpha[1]) / one.alpha[1];
      if (ratio < 1.0) {
        one.f[j][3] = -one.f[j][1] * ratio;
      } else {
        one.f[j][1] = -one.f[j][3] / ratio;
      }
      rate[j] = (1.0 - one.alpha[1]) * one.rates[j][1] + one.alpha[1] * one.rates[j][3];
    }
    const auto g = [&](std::size_t j, std::size_t p) {
      const auto& v = one.f[j];
      return p == 0 ? (1.0 - one.alpha[1]) * (v[1] - v[0]) + one.alpha[1] * (v[3] - v[2]) : v[3] - v[1];
    };
    const double determinant = g(0, 0) * g(1, 1) - g(0, 1) * g(1, 0);
    const double out = -(g(1, 1) * rate[0] - g(0, 1) * rate[1]);  // d alpha_1 / dt times det G
    return determinant > 0.0 && std::min(g(0, 0), g(1, 1)) < 0.0 && out > 0.0;
  }

  /// A double root inside: G = (a, c a)' (1, b)', and fields that shift so that it vanishes.
  bool make_fold(AtlasInstance& one) {
    one.alpha = {inside(), inside()};
    const double g1 = random_.uniform();
    const double g2 = random_.uniform();
    const double second = std::tan(0.78 * 2.0 * random_.uniform());  // the ratio of the rows of G
    const std::array<double, 2> d{random_.uniform(), random_.uniform()};
    one.f = corners_of({{{g1, g2}, {second * g1, second * g2}}}, d, one.alpha);
    // With v = (g2, -g1), G v = 0, and w = (second, -1), w' G = 0: the roots at alpha + s v obey
    // s^2 v_1 v_2 (w'd) + t (w'rate) = 0.
    const double bend = -g1 * g2 * (second * d[0] - d[1]);
    std::array<double, 2> rate{random_.uniform(), random_.uniform()};
    const double shift = second * rate[0] - rate[1];
    for (std::size_t j = 0; j < 2; ++j) one.rates[j].fill(bend * shift > 0.0 ? rate[j] : -rate[j]);
    return std::abs(bend) > 1e-3 && std::abs(shift) > 1e-2 && std::abs(second) < 10.0;
  }

  /// (4.13): G11 = 0 < G22, G12 > 0, f_1^{--} < 0 < f_1^{-+}; G11 grows, the root stays.
  bool make_unstable(AtlasInstance& one) {
    one.alpha = {inside(), inside()};
    const double g12 = std::abs(random_.uniform());
    const double g21 = -std::abs(random_.uniform());
    const double g22 = std::abs(random_.uniform());
    one.f = corners_of({{{0.0, g12}, {g21, g22}}}, {random_.uniform(), random_.uniform()}, one.alpha);
    one.rates = corners_of({{{1.0, 0.0}, {0.0, 0.0}}}, {0.0, 0.0}, one.alpha);
    return one.f[0][0] < 0.0 && one.f[0][2] > 0.0 && std::min(g12, -g21) > 0.02 && g22 > 0.02;
  }

  void relabel(AtlasInstance& one) {
    one.frame = Relabelling(static_cast<unsigned>(4.0 * (1.0 + random_.uniform())) % 8);
    one.f = one.frame.fields(one.f);
    one.rates = one.frame.fields(one.rates);
    const auto lambda = one.frame.signs(std::array<double, 2>{2.0 * one.alpha[0] - 1.0, 2.0 * one.alpha[1] - 1.0});
    for (std::size_t j = 0; j < 2; ++j) one.alpha[j] = 0.5 * (1.0 + lambda[j]);
    one.incoming = one.frame.signs(one.incoming);
    std::array<int, 2> side{};
    side[one.edge.surface] = one.edge.side;
    side = one.frame.signs(side);
    one.edge = side[0] != 0 ? SquareEdge{0, side[0]} : SquareEdge{1, side[1]};
  }

  RandomFields random_;
};

}  // namespace saltus::switching
