// The table of two surfaces as the decision trees read it: numbers of order one, and signs beyond rounding.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string_view>

#include "saltus/switching/plane/plane_table.hpp"

namespace saltus::switching {

/// A quantity below this fraction of its scale has no sign (its scale is the product of the largest normal components
/// that enter it): switches are located to about 1e-12 of the fields, which leaves two digits.
inline constexpr double sign_tolerance = 1e-10;

/// Holds the bilinear interpolation of the normal component on one surface, g = a + b alpha_1 + c alpha_2 + d alpha_1
/// alpha_2.
struct Bilinear {
  double a, b, c, d;

  [[nodiscard]] double operator()(const PlaneAlpha& alpha) const {
    return (a + b * alpha[0]) + (c + d * alpha[0]) * alpha[1];
  }
};

/// Holds rows divided by a power of two, so that their largest entry is in [0.5, 1): exact, and no product over- or
/// underflows.
struct Plane {
  std::array<std::array<double, 4>, 2> f{};
  std::array<double, 2> scale{};  ///< largest entry of each row
  std::array<int, 2> exponent{};  ///< of the power of two that was divided out

  Plane() = default;
  explicit Plane(const PlaneTable& table) {
    for (std::size_t j = 0; j < 2; ++j) {
      double largest = 0.0;
      for (std::size_t k = 0; k < 4; ++k) largest = std::max(largest, std::abs(table.velocity(j, k)));
      static_cast<void>(std::frexp(largest, &exponent[j]));
      exponent[j] = std::clamp(exponent[j], -1000, 1000);  // within the range of powers of two
      const double factor = std::ldexp(1.0, -exponent[j]);
      scale[j] = factor * largest;
      for (std::size_t k = 0; k < 4; ++k) f[j][k] = factor * table.velocity(j, k);
    }
  }

  /// Returns f_1^{k1 k2} and f_2^{k1 k2}.
  [[nodiscard]] double f1(int k1, int k2) const { return f[0][corner(k1, k2)]; }
  [[nodiscard]] double f2(int k1, int k2) const { return f[1][corner(k1, k2)]; }

  [[nodiscard]] Bilinear g(std::size_t j) const {
    const auto& [mm, pm, mp, pp] = f[j];
    return {mm, pm - mm, mp - mm, (pp - mp) - (pm - mm)};
  }

  /// Returns H_j = f_j^{-+} f_j^{+-} - f_j^{++} f_j^{--}: on g_j = 0 the slope d alpha_1/d alpha_2 has the sign of
  /// -H_j.
  [[nodiscard]] double h(std::size_t j) const { return f[j][2] * f[j][1] - f[j][3] * f[j][0]; }

 private:
  static std::size_t corner(int k1, int k2) { return (k1 > 0 ? 1U : 0U) + (k2 > 0 ? 2U : 0U); }
};

/// Remembers the first quantity whose sign is rounding.
class SignTests {
 public:
  bool positive(double quantity, double scale, std::string_view name) {
    if (!(std::abs(quantity) > sign_tolerance * scale)) fail(name);
    return quantity > 0.0;
  }
  bool negative(double quantity, double scale, std::string_view name) { return !positive(quantity, scale, name); }
  void fail(std::string_view name) {
    if (undecided_.empty()) undecided_ = name;
  }
  [[nodiscard]] std::string_view undecided() const { return undecided_; }

 private:
  std::string_view undecided_;
};

}  // namespace saltus::switching
