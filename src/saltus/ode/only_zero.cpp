// With r = theta / (1 - theta) the polynomial is (1 - theta)^8 times g(r) = sum of C(8, i) b_i r^i.
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "saltus/ode/explicit/lanes_internal.hpp"
#include "saltus/ode/explicit/ratio_form_internal.hpp"
#include "saltus/ode/only_zero_internal.hpp"

namespace saltus::ode {
namespace {

/// Value and slope of g side by side.
class RatioFormAndSlope {
 public:
  explicit RatioFormAndSlope(const BernsteinCoefficients& c) : last_(c.back()) {
    for (std::size_t i = 0; i < c.size() - 1; ++i) pairs_[i] = Pair{c[i], static_cast<double>(i + 1) * c[i + 1]};
  }
  [[nodiscard]] Pair operator()(double r) const {
    Pair both = seventh_degree([&](std::size_t i) { return pairs_[i]; }, Pair{r, r});
    const double fourth = (r * r) * (r * r);
    both[0] += last_ * (fourth * fourth);
    return both;
  }

 private:
  Pair pairs_[event_degree];
  double last_;
};

/// g at two places.
Pair values(const BernsteinCoefficients& c, Pair r) {
  const Pair fourth = (r * r) * (r * r);
  return seventh_degree([&](std::size_t i) { return Pair{c[i], c[i]}; }, r) + c.back() * (fourth * fourth);
}

}  // namespace

std::optional<SignChange> only_zero(const BernsteinCoefficients& coefficients) {
  BernsteinCoefficients c;
  for (std::size_t i = 0; i < c.size(); ++i) c[i] = binomials_of_8[i] * coefficients[i];
  const double sum = ((c[0] + c[1]) + (c[2] + c[3])) + ((c[4] + c[5]) + (c[6] + c[7])) + c[8];
  const double middle = sum / 256.0;
  const bool from_start = middle < 0.0;
  double guess = zero_of_inverse_quadratic(coefficients.front(), middle, coefficients.back());
  const double begin = from_start ? 0.0 : 0.5;
  // Not where values rise between: the middle of the half is as good.
  if (!(guess >= begin && guess <= begin + 0.5)) guess = begin + 0.25;
  if (!from_start) std::reverse(c.begin(), c.end());
  double r = from_start ? guess / (1.0 - guess) : (1.0 - guess) / guess;
  const RatioFormAndSlope g(c);
  constexpr int most = 6;
  double correction = 1.0;
  // Of g / (1 + r)^8, the polynomial itself, which is straighter than g. The error behind a correction is about its
  // square.
  for (int step = 0; step < most && std::abs(correction) > 0x1p-25; ++step) {
    const Pair here = g(r);
    const double scale = 1.0 + r;
    correction = here[0] * scale / (here[1] * scale - event_degree * here[0]);
    r -= correction;
  }
  // A change of r is at most one of theta.
  if (!(r >= 0.0 && r <= 1.0)) return std::nullopt;
  const Pair beside = values(c, Pair{r - half_width_of_zero, r + half_width_of_zero});
  const double before = from_start ? beside[0] : beside[1];
  const double behind = from_start ? beside[1] : beside[0];
  const bool is_between = (before >= 0.0 || (from_start && r <= half_width_of_zero)) && behind < 0.0;
  if (!is_between) return std::nullopt;
  const double share = r / (1.0 + r);
  const double zero = from_start ? share : 1.0 - share;
  return SignChange{std::max(zero - half_width_of_zero, 0.0), std::min(zero + half_width_of_zero, 1.0)};
}

}  // namespace saltus::ode
