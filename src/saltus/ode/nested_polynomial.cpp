#include "saltus/ode/nested_polynomial.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "saltus/base/contracts.hpp"
#include "saltus/ode/bernstein.hpp"
#include "saltus/ode/bernstein_internal.hpp"
#include "saltus/ode/explicit/nested_form_internal.hpp"

namespace saltus::ode {
namespace {

template <std::size_t degree>
using Coefficients = std::array<double, degree + 1>;

/// Bernstein coefficients of the products that the form is a sum of, of its own degree N: s^a r^b is the sum of
/// C(N - a - b, i - a) / C(N, i) times B_i, i = a ... N - b.
template <std::size_t degree>
constexpr auto own_products = [] {
  std::array<Coefficients<degree>, degree + 1> table{};
  for (std::size_t k = 0; k <= degree; ++k) {
    const std::size_t a = power_of_s(k);
    for (std::size_t i = a; i + power_of_r(k) <= degree; ++i) {
      table[k][i] = binomial(degree - k, i - a) / binomial(degree, i);
    }
  }
  return table;
}();

template <std::size_t degree, std::size_t k, std::size_t... i>
inline void add_product(double c, Coefficients<degree>& b, std::index_sequence<i...>) {
  constexpr std::size_t a = power_of_s(k);
  ((b[a + i] += own_products<degree>[k][a + i] * c), ...);
}

template <std::size_t degree, std::size_t... k>
inline Coefficients<degree> bernstein(const double* c, double end, std::index_sequence<k...>) {
  Coefficients<degree> b;
  b.fill(c[0]);
  (add_product<degree, k + 1>(c[k + 1], b, std::make_index_sequence<degree + 1 - (k + 1)>{}), ...);
  b[degree] = end;
  return b;
}

/// Sizes of numbers.
struct Extent {
  double least;
  double largest;  ///< of their absolute values
  double none;     ///< NaN if one is not finite
};

/// All comparisons without ways out: which one is taken is as good as random.
template <std::size_t count, std::size_t... i>
inline Extent extent(const std::array<double, count>& b, std::index_sequence<i...>) {
  Extent of{b[0], 0.0, 0.0};
  ((of.least = std::min(of.least, b[i]), of.largest = std::max(of.largest, std::abs(b[i])), of.none += 0.0 * b[i]),
   ...);
  return of;
}

/// Where the cubic theta(y) through the ends of a falling polynomial, with their slopes, is at y = 0. Slopes that are
/// less than a third of the chord's, or rise, would make it turn around: the chord is followed.
template <std::size_t degree>
double first_guess(const Coefficients<degree>& b) {
  constexpr auto n = static_cast<double>(degree);
  const double chord = b.back() - b.front();
  const double share = -b.front() / chord;
  const double at_start = chord / (n * (b[1] - b[0]));
  const double at_end = chord / (n * (b[degree] - b[degree - 1]));
  constexpr double steepest = 3.0;
  const bool turns = !(at_start >= 0.0 && at_start <= steepest && at_end >= 0.0 && at_end <= steepest);
  const double rest = 1.0 - share;
  const double cubic = share * (share * (3.0 - 2.0 * share) + rest * (rest * at_start - share * at_end));
  return turns ? share : cubic;
}

/// The zero of c_first + ... near a guess, if Halley's method gets there: of third order for one division, as Newton's.
/// That one is followed where the polynomial bends much on the way, as Halley's has fixed points at extrema.
template <std::size_t first, std::size_t degree>
std::optional<PlainZero> halley(const double* c, double theta) {
  // Of theta: beside an extremum at 0 the error behind a correction is about a quarter of its cube, 6e-14. That of the
  // slope, which the bend carries on, is about its square.
  constexpr double small = 0x1p-14;
  constexpr int most = 6;
  for (int step = 0; step < most; ++step) {
    const SecondJet here = nested_second_jet<first, degree>(c, theta, 1.0 - theta);
    const double square = here.slope * here.slope;
    const double bent = here.value * here.bend;
    const bool is_near = std::abs(bent) <= 0.5 * square;
    const bool is_last = std::abs(here.value) <= small * theta * std::abs(here.slope);
    const double correction = is_near ? here.value * here.slope / (square - bent) : here.value / here.slope;
    theta -= correction;
    if (!(theta >= 0.0 && theta <= 1.0)) return std::nullopt;
    if (is_near && is_last) return PlainZero{PlainZero::Kind::one, theta, here.slope - 2.0 * correction * here.bend};
  }
  return std::nullopt;
}

template <std::size_t degree, std::size_t... k>
inline void multiply(const NestedPolynomial& polynomial, double factor, double* c, std::index_sequence<k...>) {
  ((c[k] = factor * polynomial.c[k]), ...);
}

template <std::size_t degree>
PlainZero search(const NestedPolynomial& polynomial, int sign, int zero_order, double noise) {
  constexpr auto all = std::make_index_sequence<degree + 1>{};
  double c[degree + 1];
  multiply<degree>(polynomial, sign, c, all);
  if (zero_order == 1) c[0] = 0.0;
  auto b = bernstein<degree>(c, sign * polynomial.end, std::make_index_sequence<degree>{});
  if (zero_order == 1) b[0] = b[1];  // it says nothing
  const Extent of = extent(b, all);
  noise = std::max(noise, 8.0 * std::numeric_limits<double>::epsilon() * of.largest);
  if (!(of.none == 0.0)) return {};
  if (of.least >= -noise) return {PlainZero::Kind::none};
  if (!falls_once(b, noise)) return {};
  if (zero_order == 0) return halley<0, degree>(c, first_guess<degree>(b)).value_or(PlainZero{});
  // p / theta: theta times B_i of degree N - 1 is (i + 1) / N times B_(i+1) of degree N.
  Coefficients<degree - 1> quotient;
  for (std::size_t i = 0; i < degree; ++i) quotient[i] = b[i + 1] * (double{degree} / static_cast<double>(i + 1));
  auto zero = halley<1, degree>(c, first_guess<degree - 1>(quotient)).value_or(PlainZero{});
  zero.slope *= zero.theta;
  return zero;
}

}  // namespace

PlainZero plain_zero(const NestedPolynomial& polynomial, int sign, int zero_order, double noise) {
  SALTUS_ASSERT((sign == 1 || sign == -1) && zero_order >= 0 && noise >= 0.0);
  if (zero_order > 1) return {};
  PlainZero zero;
  switch (polynomial.degree) {
    case 3:
      zero = search<3>(polynomial, sign, zero_order, noise);
      break;
    case 4:
      zero = search<4>(polynomial, sign, zero_order, noise);
      break;
    case 5:
      zero = search<5>(polynomial, sign, zero_order, noise);
      break;
    case 7:
      zero = search<7>(polynomial, sign, zero_order, noise);
      break;
    default:
      break;
  }
  zero.slope *= sign;
  return zero;
}

}  // namespace saltus::ode
