// Smooth relaxations of one complementarity pair, 0 <= a _|_ b >= 0.
#pragma once

#include <array>
#include <string_view>

namespace saltus::solver::homotopy {

/// Names functions phi(a, b; sigma) <= 0 together with a, b >= 0; for sigma -> 0 the complementary points.
enum class Relaxation {
  scholtes,                 ///< a b - sigma
  fischer_burmeister,       ///< a + b - sqrt(a^2 + b^2 + s^2), s^2 = 2 sigma
  natural_residual,         ///< (a + b - sqrt((a - b)^2 + s^2)) / 2, s^2 = 4 sigma
  chen_chen_kanzow,         ///< half of fischer_burmeister plus half of scholtes
  steffensen_ulbrich_sine,  ///< a + b - Y(a - b), Y = |a - b| smoothed by a sine for |a - b| < s
  steffensen_ulbrich_poly,  ///< the same, smoothed by a polynomial of degree four
  kanzow_schwartz,          ///< (a - s)(b - s) if a + b >= 2s, else -((a - s)^2 + (b - s)^2) / 2, s = sigma
  lin_fukushima,            ///< a b - s^2 and s^2 - (a + s)(b + s), s = sigma; needs no other bound on a, b
  kadrani,                  ///< (a - s)(b - s), a >= -s, b >= -s, s = sigma
};
inline constexpr std::array all_relaxations{
    Relaxation::scholtes,         Relaxation::fischer_burmeister,      Relaxation::natural_residual,
    Relaxation::chen_chen_kanzow, Relaxation::steffensen_ulbrich_sine, Relaxation::steffensen_ulbrich_poly,
    Relaxation::kanzow_schwartz,  Relaxation::lin_fukushima,           Relaxation::kadrani,
};

/// Returns the name of a relaxation in model files.
[[nodiscard]] std::string_view name(Relaxation relaxation);

/// Returns how many inequalities phi <= 0 the relaxation has: 2 for lin_fukushima, else 1.
[[nodiscard]] int inequalities(Relaxation relaxation);

/// Returns whether phi has no second derivative but the mixed one, so that a and b each need no Hessian of their own.
[[nodiscard]] bool is_bilinear(Relaxation relaxation);

/// Returns the lower bound of a and b that belongs to the relaxation: -s for kadrani, -inf for lin_fukushima, else 0.
[[nodiscard]] double lower_bound(Relaxation relaxation, double sigma);

/// Holds phi with its first and second derivatives, with those with respect to sigma, too: elastic problems vary it.
struct PairFunction {
  double value = 0.0;
  double a = 0.0;
  double b = 0.0;
  double aa = 0.0;
  double ab = 0.0;
  double bb = 0.0;
  double s = 0.0;  ///< with respect to sigma, and so below
  double as = 0.0;
  double bs = 0.0;
  double ss = 0.0;
};

/// Evaluates the relaxation at (a, b), number `which` of its inequalities. The parameter is normalised: a pair whose
/// one side is of order 1 has its other side of order sigma at most. So s = sigma where the set reaches that far along
/// the axes; with s^2 = sigma no such pair ever gets more accurate than 1e-5. The other relaxations have a = b =
/// sqrt(sigma) on their boundary. kanzow_schwartz has second derivatives on either side of its seam a + b = 2s only.
/// Source: [hoheisel2013]; [kanzow1996] for the NCP functions, [scholtes2001] for scholtes.
[[nodiscard]] PairFunction pair_function(Relaxation relaxation, int which, double a, double b, double sigma);

}  // namespace saltus::solver::homotopy
