// Polynomials of the degree of Taylor series in Bernstein form.
#include <algorithm>
#include <cmath>

#include "saltus/ode/bernstein_internal.hpp"
#include "saltus/ode/explicit/lanes_internal.hpp"
#include "saltus/ode/only_zero_internal.hpp"
#include "saltus/ode/sign_change_internal.hpp"

namespace saltus::ode {
namespace {

/// By Horner's rule from the terms, a fraction of the work: those of theta^0 ... theta^(zero_order - 1) are 0.
struct FromTerms {
  struct Sum {
    const SeriesCoefficients& terms;
    double sign;
    std::size_t first;
    /// In two sums, of even and of odd powers, which do not wait for each other.
    double operator()(double theta) const {
      const double square = theta * theta;
      double sum = terms[series_degree];
      double between = terms[series_degree - 1];
      std::size_t k = series_degree - 1;
      for (; k >= first + 2; k -= 2) {
        sum = terms[k - 1] + square * sum;
        between = terms[k - 2] + square * between;
      }
      // k is the power of `between`, k + 1 that of `sum`.
      double value = between + theta * sum;
      if (k > first) value = terms[k - 1] + theta * value;
      return sign * value;
    }
  };
  [[nodiscard]] std::optional<SignChange> only_zero(const SeriesCoefficients& p) const;
  [[nodiscard]] Sum whole(const SeriesCoefficients& /*p*/) const { return {terms, static_cast<double>(sign), 0}; }
  [[nodiscard]] Sum without_zero(const SeriesCoefficients& /*p*/, int zero_order) const {
    return {terms, static_cast<double>(sign), static_cast<std::size_t>(zero_order)};
  }

  const SeriesCoefficients& terms;
  int sign;
};

/// Value and slope side by side, each in two sums.
class SeriesAndSlope {
 public:
  explicit SeriesAndSlope(const SeriesCoefficients& terms) {
    for (std::size_t k = 0; k < series_degree; ++k)
      pairs_[k] = Pair{terms[k], static_cast<double>(k + 1) * terms[k + 1]};
    pairs_[series_degree] = Pair{terms[series_degree], 0.0};
  }
  [[nodiscard]] Pair operator()(double theta) const {
    const double square = theta * theta;
    Pair even = pairs_[series_degree];
    Pair odd = pairs_[series_degree - 1];
    for (std::size_t k = series_degree - 2; k > 0; k -= 2) {
      even = pairs_[k] + square * even;
      odd = pairs_[k - 1] + square * odd;
    }
    return pairs_[0] + square * even + theta * odd;
  }

 private:
  static_assert(series_degree % 2 == 0);
  Pair pairs_[series_degree + 1];
};

/// As only_zero of degree 8 does it (only_zero_internal.hpp): Newton from the inverse quadratic through both ends and
/// the middle; the signs on both sides are checked.
std::optional<SignChange> FromTerms::only_zero(const SeriesCoefficients& p) const {
  const Sum value = whole(p);
  const double at_middle = value(0.5);
  double theta = zero_of_inverse_quadratic(p.front(), at_middle, p.back());
  const double begin = at_middle < 0.0 ? 0.0 : 0.5;
  if (!(theta >= begin && theta <= begin + 0.5)) theta = begin + 0.25;
  const SeriesAndSlope polynomial(terms);
  constexpr int most = 6;
  double correction = 1.0;
  // The error behind a correction is about its square.
  for (int step = 0; step < most && std::abs(correction) > 0x1p-25; ++step) {
    const Pair here = polynomial(theta);
    correction = here[0] / here[1];
    theta -= correction;
  }
  if (!(theta > 0.0 && theta < 1.0)) return std::nullopt;
  const SignChange bracket{std::max(theta - half_width_of_zero, 0.0), std::min(theta + half_width_of_zero, 1.0)};
  if (!(value(bracket.lower) >= 0.0 && value(bracket.upper) < 0.0)) return std::nullopt;
  return bracket;
}

}  // namespace

SeriesCoefficients to_bernstein(const SeriesCoefficients& terms) {
  static constexpr auto share = inverse_binomials<series_degree>();
  SeriesCoefficients b;
  for (std::size_t k = 0; k < b.size(); ++k) b[k] = terms[k] * share[k];
  binomial_sums<series_degree>(b.data());
  return b;
}

SeriesCoefficients part_of(const SeriesCoefficients& coefficients, double from, double to) {
  SeriesCoefficients part = to == 1.0 ? coefficients : sign_change::cut(coefficients, to).left;
  if (from > 0.0) part = sign_change::cut(part, from / to).right;
  return part;
}

double evaluate(const SeriesCoefficients& coefficients, double theta) { return value_at(coefficients, theta); }
double derivative(const SeriesCoefficients& coefficients, double theta) { return slope_at(coefficients, theta); }

std::optional<SignChange> first_sign_change(const SeriesCoefficients& coefficients, int sign, int zero_order,
                                            double noise) {
  return sign_change::search_sign_change(coefficients, sign, zero_order, noise, sign_change::FromCoefficients{});
}

std::optional<SignChange> first_sign_change(const SeriesCoefficients& coefficients, const SeriesCoefficients& terms,
                                            int sign, int zero_order, double noise) {
  return sign_change::search_sign_change(coefficients, sign, zero_order, noise, FromTerms{terms, sign});
}

}  // namespace saltus::ode
