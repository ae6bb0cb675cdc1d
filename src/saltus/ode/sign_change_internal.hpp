// The first sign change of a polynomial beyond the noise, for any degree.
//
// With the expected sign turned to +, a value is high above +noise, low below -noise, else near. The first low point is
// isolated by bisecting [0, 1], the leftmost part first: a part without low coefficients has no low point (convex
// hull), one whose coefficients turn low once and stay low gets there exactly once (variation diminishing). Between the
// last high point before it and the low point everything is near: the zero from high to low is narrowed down.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

#include "saltus/base/at.hpp"
#include "saltus/base/contracts.hpp"
#include "saltus/ode/bernstein.hpp"
#include "saltus/ode/only_zero_internal.hpp"

namespace saltus::ode::sign_change {

template <std::size_t nodes>
using Coefficients = std::array<double, nodes>;

inline constexpr double bracket_width = 0x1p-40;
// Parts are bisected two bits beyond the brackets; what is undecided there is a dip narrower than any bracket.
inline constexpr int deepest = 42;

/// Holds a part without initial values: a list of these is on the stack of every search.
template <std::size_t nodes>
struct Part {
  double start;
  double width;
  Coefficients<nodes> b;
};

/// Holds both parts of a polynomial cut at theta, each on its own [0, 1].
template <std::size_t nodes>
struct Halves {
  Coefficients<nodes> left;
  Coefficients<nodes> right;
};

template <std::size_t nodes>
Halves<nodes> cut(const Coefficients<nodes>& coefficients, double theta) {
  Halves<nodes> halves{{}, coefficients};
  Coefficients<nodes>& b = halves.right;
  constexpr std::size_t n = nodes - 1;
  for (std::size_t level = 0; level <= n; ++level) {
    halves.left[level] = b[0];
    for (std::size_t i = 0; i < n - level; ++i) b[i] = (1.0 - theta) * b[i] + theta * b[i + 1];
  }
  return halves;
}

enum class Verdict {
  none,   ///< no low point
  once,   ///< gets low exactly once, and ends low
  split,  ///< undecided
};

/// Judges a part that does not begin low.
template <std::size_t nodes>
Verdict judge(const Coefficients<nodes>& b, double noise) {
  const auto is_low = [noise](double value) { return !(value >= -noise); };
  const auto first_low = std::find_if(b.begin(), b.end(), is_low);
  if (first_low == b.end()) return Verdict::none;
  if (std::all_of(first_low, b.end(), is_low)) return Verdict::once;
  // Dips hardly beyond the noise are given up: coefficients that tie with its level up to rounding would be bisected
  // without end.
  constexpr double margin = 1.0 + 0x1p-4;
  const bool shallow =
      !is_low(b.back()) && std::all_of(b.begin(), b.end(), [&](double v) { return v >= -margin * noise; });
  return shallow ? Verdict::none : Verdict::split;
}

/// Finds the part in which the polynomial gets low for the first time (exactly once, or at the limit of resolution).
template <std::size_t nodes>
std::optional<Part<nodes>> first_descent(const Coefficients<nodes>& coefficients, double noise) {
  std::array<Part<nodes>, deepest + 1> pending;  // leftmost last; each is at most as wide as the next one
  std::size_t count = 1;
  pending[0] = {0.0, 1.0, coefficients};
  while (count > 0) {
    const Part<nodes> part = pending[--count];
    const bool resolved = part.width <= std::ldexp(1.0, -deepest);
    switch (judge(part.b, noise)) {
      case Verdict::none:
        break;
      case Verdict::once:
        return part;
      case Verdict::split: {
        if (resolved) {
          if (part.b.back() < -noise) return part;
          break;
        }
        const Halves<nodes> halves = cut(part.b, 0.5);
        const double half = 0.5 * part.width;
        pending[count++] = {part.start + half, half, halves.right};
        pending[count++] = {part.start, half, halves.left};
        break;
      }
    }
  }
  return std::nullopt;
}

/// Narrows a bracket of the one place where a function turns from >= 0 to below (Chandrupatla: inverse quadratic
/// interpolation where the last three points admit it, else the middle). Points are kept half a width away from the
/// ends so that both close in.
template <class Function>
SignChange narrow(SignChange bracket, Function&& value) {
  double at_lower = value(bracket.lower);
  double at_upper = value(bracket.upper);
  double share = at_lower / (at_lower - at_upper);  // of the width, from the lower end: false position at first
  if (!(share >= 0.0 && share <= 1.0)) share = 0.5;
  while (bracket.upper - bracket.lower > bracket_width) {
    const double width = bracket.upper - bracket.lower;
    const double inset = std::min(0.5 * bracket_width, 0.25 * width);
    const double place = std::clamp(bracket.lower + share * width, bracket.lower + inset, bracket.upper - inset);
    if (!(place > bracket.lower && place < bracket.upper)) break;
    const double at_place = value(place);
    // The newest point, the end of the bracket beside it, and the end that was given up.
    double old = bracket.lower;
    double at_old = at_lower;
    if (at_place >= 0.0) {
      bracket.lower = place;
      at_lower = at_place;
    } else {
      old = bracket.upper;
      at_old = at_upper;
      bracket.upper = place;
      at_upper = at_place;
    }
    const bool moved_lower = at_place >= 0.0;
    const double other = moved_lower ? bracket.upper : bracket.lower;
    const double at_other = moved_lower ? at_upper : at_lower;
    const double xi = (place - other) / (old - other);
    const double phi = (at_place - at_other) / (at_old - at_other);
    double from_place = 0.5;
    if (phi * phi < xi && (1.0 - phi) * (1.0 - phi) < 1.0 - xi) {
      from_place = at_place / (at_other - at_place) * at_old / (at_other - at_old) +
                   (old - place) / (other - place) * at_place / (at_old - at_place) * at_other / (at_old - at_other);
    }
    if (!(from_place >= 0.0 && from_place <= 1.0)) from_place = 0.5;
    share = moved_lower ? from_place : 1.0 - from_place;
  }
  return bracket;
}

/// Evaluates a polynomial by Horner's rule in theta / (1 - theta), from the nearer end: a quarter of the work of de
/// Casteljau, and as few roundings of the coefficients.
template <std::size_t nodes>
class Scaled {
 public:
  explicit Scaled(const Coefficients<nodes>& b) : c_(b) {
    constexpr Coefficients<nodes> binomials = [] {
      Coefficients<nodes> row{1.0};
      for (std::size_t k = 1; k < nodes; ++k) {
        row[k] = row[k - 1] * static_cast<double>(nodes - k) / static_cast<double>(k);
      }
      return row;
    }();
    for (std::size_t i = 0; i < c_.size(); ++i) c_[i] *= binomials[i];
  }

  [[nodiscard]] double operator()(double theta) const {
    const double far = 1.0 - theta;
    const bool from_start = theta <= 0.5;
    const double ratio = from_start ? theta / far : far / theta;
    double sum = 0.0;
    if (from_start) {
      for (std::size_t i = c_.size(); i-- > 0;) sum = sum * ratio + c_[i];
    } else {
      for (std::size_t i = 0; i < c_.size(); ++i) sum = sum * ratio + c_[i];
    }
    return sum * power<nodes - 1>(from_start ? far : theta);
  }

 private:
  /// By squares.
  template <std::size_t exponent>
  static double power(double base) {
    if constexpr (exponent == 1) {
      return base;
    } else if constexpr (exponent % 2 == 1) {
      return base * power<exponent - 1>(base);
    } else {
      return power<exponent / 2>(base * base);
    }
  }

  Coefficients<nodes> c_;
};

/// Evaluates p(theta) / theta^order for a polynomial whose first `order` coefficients are 0, raised to the full degree
/// again by leaving the last coefficients unused.
template <std::size_t nodes>
class Quotient {
 public:
  Quotient(const Coefficients<nodes>& coefficients, int order) : b_(coefficients), degree_(nodes - 1) {
    for (int k = 0; k < order; ++k, --degree_) {
      // theta B_i of degree N - 1 is (i + 1) / N times B_(i+1) of degree N.
      for (int i = 0; i < degree_; ++i) b_[at(i)] = b_[at(i + 1)] * degree_ / (i + 1);
    }
  }

  [[nodiscard]] double operator()(double theta) const {
    Coefficients<nodes> b = b_;
    for (int level = degree_; level > 0; --level) {
      for (int i = 0; i < level; ++i) b[at(i)] = (1.0 - theta) * b[at(i)] + theta * b[at(i + 1)];
    }
    return b[0];
  }

 private:
  Coefficients<nodes> b_;
  int degree_;
};

/// Finds a high point from which the polynomial descends to a low one without rising to high again; 0 if there is none.
template <std::size_t nodes>
double high_before(const Coefficients<nodes>& p, double low, double noise) {
  // Seen backwards from the low point and upside down, the part in which it gets high is a first descent. There it ends
  // high, and what is high on the way stays so.
  Coefficients<nodes> backwards = cut(p, low).left;
  std::reverse(backwards.begin(), backwards.end());
  for (double& value : backwards) value = -value;
  const auto ascent = first_descent(backwards, noise);
  return ascent ? low * (1.0 - std::min(1.0, ascent->start + ascent->width)) : 0.0;
}

/// Evaluates values of a polynomial, and of what is left of it without its zero at 0, from its Bernstein coefficients.
struct FromCoefficients {
  /// Finds a bracket of the zero of a polynomial that falls once, if it is found in a quicker way than by narrowing.
  template <std::size_t nodes>
  [[nodiscard]] std::optional<SignChange> only_zero(const Coefficients<nodes>& p) const {
    if constexpr (nodes == event_nodes) {
      return ode::only_zero(p);
    } else {
      return std::nullopt;
    }
  }
  /// Does the same behind a zero at 0: that of p(theta) / theta, raised to the same degree.
  template <std::size_t nodes>
  [[nodiscard]] std::optional<SignChange> only_zero_behind_start(const Coefficients<nodes>& p) const {
    if constexpr (nodes == event_nodes) {
      Coefficients<nodes> quotient = p;
      for (std::size_t i = 0; i + 1 < nodes; ++i) {
        const double share = static_cast<double>(nodes - 1 - i) / static_cast<double>(i + 1);
        quotient[i] = p[i] + share * p[i + 1];
      }
      return ode::only_zero(quotient);
    } else {
      return std::nullopt;
    }
  }
  template <std::size_t nodes>
  [[nodiscard]] Scaled<nodes> whole(const Coefficients<nodes>& p) const {
    return Scaled<nodes>(p);
  }
  template <std::size_t nodes>
  [[nodiscard]] Quotient<nodes> without_zero(const Coefficients<nodes>& p, int zero_order) const {
    return Quotient<nodes>(p, zero_order);
  }
};

/// Takes the arguments of first_sign_change, and where values are from, those of a polynomial times `sign`.
template <std::size_t nodes, class Values>
std::optional<SignChange> search_sign_change(const Coefficients<nodes>& coefficients, int sign, int zero_order,
                                             double noise, const Values& values) {
  SALTUS_ASSERT((sign == 1 || sign == -1) && zero_order >= 0 && zero_order <= 3 && noise >= 0.0);
  Coefficients<nodes> p = coefficients;
  for (double& value : p) value *= sign;
  if (zero_order == 0 && falls_once(p, noise)) {  // what the parts below come to, without them
    const auto change = values.only_zero(p);
    return change ? *change : narrow({0.0, 1.0}, values.whole(p));
  }
  if (certainly_no_sign_change(coefficients, sign, zero_order, noise)) return std::nullopt;
  std::fill_n(p.begin(), zero_order, 0.0);
  if (!(p.front() >= -noise)) return SignChange{0.0, 0.0};
  if constexpr (requires { values.only_zero_behind_start(p); }) {
    if (zero_order == 1 && falls_once(p, noise, 1)) {
      if (const auto change = values.only_zero_behind_start(p)) return *change;
    }
  }

  const auto descent = first_descent(p, noise);
  if (!descent) return std::nullopt;
  const auto quotient = values.without_zero(p, zero_order);
  const double low = descent->start + descent->width;  // the part ends low
  const double high = high_before(p, low, noise);
  if (quotient(high) >= 0.0) return narrow({high, low}, quotient);
  // On the other side from the start, within the noise: as long as it stays near.
  const auto above_noise = [&](double theta) { return evaluate(p, theta) + noise; };
  return SignChange{high, narrow({descent->start, low}, above_noise).upper};
}

}  // namespace saltus::ode::sign_change
