#include "saltus/solver/homotopy/relaxation.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include "saltus/base/contracts.hpp"
#include "saltus/base/enum_names.hpp"

namespace saltus::solver::homotopy {
namespace {

constexpr EnumNames<Relaxation::kadrani> relaxations("scholtes", "fischer_burmeister", "natural_residual",
                                                     "chen_chen_kanzow", "steffensen_ulbrich_sine",
                                                     "steffensen_ulbrich_poly", "kanzow_schwartz", "lin_fukushima",
                                                     "kadrani");

PairFunction scholtes(double a, double b, double sigma) { return {a * b - sigma, b, a, 0.0, 1.0, 0.0, -1.0}; }

/// a + b - sqrt(a^2 + b^2 + s2), s2 = 2 sigma > 0 keeps the root away from 0.
PairFunction fischer_burmeister(double a, double b, double sigma) {
  const double s2 = 2.0 * sigma;
  const double root = std::sqrt(a * a + b * b + s2);
  const double cube = root * root * root;
  // a + b - root loses all digits where a b is small: ((a + b)^2 - root^2) / (a + b + root) does not.
  const double sum = a + b;
  const double value = sum > 0.0 ? (2.0 * a * b - s2) / (sum + root) : sum - root;
  return {
      value,    1.0 - a / root, 1.0 - b / root, -(b * b + s2) / cube, a * b / cube, -(a * a + s2) / cube, -1.0 / root,
      a / cube, b / cube,       1.0 / cube};
}

PairFunction natural_residual(double a, double b, double sigma) {
  const double s2 = 4.0 * sigma;
  const double difference = a - b;
  const double root = std::sqrt(difference * difference + s2);
  const double slope = difference / root;
  const double cube = root * root * root;
  const double curvature = 0.5 * s2 / cube;
  const double sum = a + b;
  const double value = 0.5 * (sum > 0.0 ? (4.0 * a * b - s2) / (sum + root) : sum - root);
  return {value,      0.5 * (1.0 - slope), 0.5 * (1.0 + slope), -curvature,         curvature,
          -curvature, -1.0 / root,         difference / cube,   -difference / cube, 2.0 / cube};
}

PairFunction mean(const PairFunction& p, const PairFunction& q) {
  return {0.5 * (p.value + q.value), 0.5 * (p.a + q.a), 0.5 * (p.b + q.b),   0.5 * (p.aa + q.aa), 0.5 * (p.ab + q.ab),
          0.5 * (p.bb + q.bb),       0.5 * (p.s + q.s), 0.5 * (p.as + q.as), 0.5 * (p.bs + q.bs), 0.5 * (p.ss + q.ss)};
}

/// |z| made twice differentiable inside of |z| < 1, with its derivatives.
struct Smoothed {
  double value, slope, curvature;
};

Smoothed sine(double z) {
  const double angle = 0.5 * std::numbers::pi * z;
  return {1.0 - 2.0 / std::numbers::pi * std::cos(angle), std::sin(angle), 0.5 * std::numbers::pi * std::cos(angle)};
}

Smoothed polynomial(double z) {
  const double z2 = z * z;
  return {(3.0 + z2 * (6.0 - z2)) / 8.0, z * (3.0 - z2) / 2.0, 1.5 * (1.0 - z2)};
}

/// With t = 2 sqrt(sigma) / Y(0): a = b = sqrt(sigma) on the diagonal a + b = t Y(0).
PairFunction steffensen_ulbrich(double a, double b, double sigma, Smoothed (*smoothed)(double)) {
  const double t = 2.0 * std::sqrt(sigma) / smoothed(0.0).value;
  const double z = (a - b) / t;
  if (std::abs(z) >= 1.0) return a >= b ? PairFunction{2.0 * b, 0.0, 2.0} : PairFunction{2.0 * a, 2.0, 0.0};
  const auto [value, slope, curvature] = smoothed(z);
  const double second = curvature / t;
  const double t_s = 0.5 * t / sigma;
  const double of_t = z * slope - value;
  return {a + b - t * value,
          1.0 - slope,
          1.0 + slope,
          -second,
          second,
          -second,
          of_t * t_s,
          z * second * t_s,
          -z * second * t_s,
          -z * z * second * t_s * t_s - of_t * 0.5 * t_s / sigma};
}

PairFunction kanzow_schwartz(double a, double b, double s) {
  const double p = a - s;
  const double q = b - s;
  if (p + q >= 0.0) return {p * q, q, p, 0.0, 1.0, 0.0, -(p + q), -1.0, -1.0, 2.0};
  return {-0.5 * (p * p + q * q), -p, -q, -1.0, 0.0, -1.0, p + q, 1.0, 1.0, -2.0};
}

}  // namespace

std::string_view name(Relaxation relaxation) { return relaxations(relaxation); }

int inequalities(Relaxation relaxation) { return relaxation == Relaxation::lin_fukushima ? 2 : 1; }

bool is_bilinear(Relaxation relaxation) {
  return relaxation == Relaxation::scholtes || relaxation == Relaxation::lin_fukushima ||
         relaxation == Relaxation::kadrani;
}

double lower_bound(Relaxation relaxation, double sigma) {
  switch (relaxation) {
    case Relaxation::lin_fukushima:
      return -std::numeric_limits<double>::infinity();
    case Relaxation::kadrani:
      return -sigma;
    default:
      return 0.0;
  }
}

PairFunction pair_function(Relaxation relaxation, int which, double a, double b, double sigma) {
  SALTUS_ASSERT(which >= 0 && which < inequalities(relaxation) && sigma > 0.0);
  switch (relaxation) {
    case Relaxation::scholtes:
      return scholtes(a, b, sigma);
    case Relaxation::fischer_burmeister:
      return fischer_burmeister(a, b, sigma);
    case Relaxation::natural_residual:
      return natural_residual(a, b, sigma);
    case Relaxation::chen_chen_kanzow:
      return mean(fischer_burmeister(a, b, sigma), scholtes(a, b, sigma));
    case Relaxation::steffensen_ulbrich_sine:
      return steffensen_ulbrich(a, b, sigma, sine);
    case Relaxation::steffensen_ulbrich_poly:
      return steffensen_ulbrich(a, b, sigma, polynomial);
    case Relaxation::kanzow_schwartz:
      return kanzow_schwartz(a, b, sigma);
    case Relaxation::lin_fukushima:
      if (which == 0) return {a * b - sigma * sigma, b, a, 0.0, 1.0, 0.0, -2.0 * sigma, 0.0, 0.0, -2.0};
      return {-(a * b + sigma * (a + b)), -(b + sigma), -(a + sigma), 0.0, -1.0, 0.0, -(a + b), -1.0, -1.0, 0.0};
    case Relaxation::kadrani:
      return {(a - sigma) * (b - sigma), b - sigma, a - sigma, 0.0, 1.0, 0.0, 2.0 * sigma - a - b, -1.0, -1.0, 2.0};
  }
  return {};
}

}  // namespace saltus::solver::homotopy
