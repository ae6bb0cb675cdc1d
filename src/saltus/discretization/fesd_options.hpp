// The choices that make up a FESD discretisation.
#pragma once

#include <array>
#include <string_view>

namespace saltus::discretization {

enum class TableauFamily {
  radau_iia,       ///< collocation at the right Radau points, 1 to 9 stages, order 2s - 1; c_s = 1
  gauss_legendre,  ///< collocation at the Gauss points, 1 to 9 stages, order 2s; c_s < 1
  lobatto_iiia,    ///< collocation at the Lobatto points, 2 to 5 stages, order 2s - 2; c_1 = 0, c_s = 1
  lobatto_iiic,    ///< at the Lobatto points with a_i1 = b_1, 2 to 5 stages, order 2s - 2; c_s = 1
  explicit_rk,     ///< Euler, midpoint, Kutta, classical: 1 to 4 stages, order s
};

/// Says what the unknowns of a Runge-Kutta element are.
enum class Representation {
  integral,      ///< the states of the stages
  differential,  ///< their slopes
};

/// Says which multipliers lambda_m' (m' = 0: left end, last: right end) are complementary to which selections a_m of
/// the same element, componentwise; a = alpha with lambda_n, 1 - alpha with lambda_p, or theta with lambda.
enum class CrossComplementarity {
  stage_stage,  ///< lambda_m' _|_ a_m for all m', m: eq. (37) of [nurkanovic2024]
  fe_stage,     ///< lambda_m' _|_ sum_m a_m
  stage_fe,     ///< sum_m' lambda_m' _|_ a_m
  fe_fe,        ///< sum_m' lambda_m' _|_ sum_m a_m
  paper,        ///< eq. (38): all products of two neighbouring elements in one sum, and lambda_m _|_ a_m
  same_stage,   ///< lambda_m _|_ a_m only, and all steps of the same length: no detection of switches
};
inline constexpr std::array all_cross_complementarities{
    CrossComplementarity::stage_stage, CrossComplementarity::fe_stage, CrossComplementarity::stage_fe,
    CrossComplementarity::fe_fe,       CrossComplementarity::paper,    CrossComplementarity::same_stage};

/// Says what makes neighbouring elements equally long where no switch separates them. For every pair a _|_ lambda let
/// sB(.) and sF(.) be sums over the points of the element before and after their boundary,
///   nu = sB(a) sF(a) + sB(lambda) sF(lambda),   eta = product of all nu (both pairs of a step selection):
/// zero exactly where the active set changes.
enum class StepEquilibration {
  none,               ///< lengths between switches are left undetermined
  heuristic_mean,     ///< objective rho sum (h_n - T/N)^2
  heuristic_diff,     ///< objective rho sum (h_n - h_(n-1))^2
  l2_relaxed,         ///< objective rho sum eta_n (h_n - h_(n-1))^2
  l2_relaxed_scaled,  ///< objective rho sum tanh(eta_n / s) (h_n - h_(n-1))^2
  direct,             ///< eta_n (h_n - h_(n-1)) = 0, eq. (39) of [nurkanovic2024]
  mlcp,               ///< the same by linear complementarities: |h_n - h_(n-1)| _|_ min over all pairs of
                      ///< min(sB(a), sF(a)) + min(sB(lambda), sF(lambda))
  paper,              ///< direct with the printed nu = sB(lambda_n) sF(lambda_n) + sB(lambda_p) sF(lambda_p) of step
                      ///< selections: zero in all of sliding too, where it leaves lengths undetermined
};
inline constexpr std::array all_step_equilibrations{StepEquilibration::none,
                                                    StepEquilibration::heuristic_mean,
                                                    StepEquilibration::heuristic_diff,
                                                    StepEquilibration::l2_relaxed,
                                                    StepEquilibration::l2_relaxed_scaled,
                                                    StepEquilibration::direct,
                                                    StepEquilibration::mlcp,
                                                    StepEquilibration::paper};

/// Returns the names in model files.
[[nodiscard]] std::string_view name(Representation representation);
[[nodiscard]] std::string_view name(CrossComplementarity cross_complementarity);
[[nodiscard]] std::string_view name(StepEquilibration step_equilibration);

struct FesdOptions {
  Representation representation = Representation::integral;
  CrossComplementarity cross_complementarity = CrossComplementarity::fe_stage;
  StepEquilibration step_equilibration = StepEquilibration::heuristic_mean;
  /// (1 - gamma_h) T/N <= h_n <= (1 + gamma_h) T/N; in [0, 1]. 1 lets elements vanish.
  double gamma_h = 1.0;
  double rho_h = 1.0;    ///< > 0, weight of the terms in the objective
  double sigma_h = 0.1;  ///< > 0, s of l2_relaxed_scaled
};

}  // namespace saltus::discretization
