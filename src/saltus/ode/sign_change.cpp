#include "saltus/ode/sign_change_internal.hpp"

namespace saltus::ode {

std::optional<SignChange> first_sign_change(const BernsteinCoefficients& coefficients, int sign, int zero_order,
                                            double noise) {
  return sign_change::search_sign_change(coefficients, sign, zero_order, noise, sign_change::FromCoefficients{});
}

}  // namespace saltus::ode
