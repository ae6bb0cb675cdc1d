// Multipliers of regions as short products: the lifting algorithm.
#pragma once

#include <vector>

#include "saltus/linalg/int_matrix.hpp"

namespace saltus::reformulation {

/// Is alpha_j, or 1 - alpha_j.
struct StepFactor {
  int alpha = 0;
  bool complement = false;

  bool operator==(const StepFactor&) const = default;
};

/// Is beta_k (none if -1) times the factors; 1 if there is nothing.
struct LiftedProduct {
  int beta = -1;
  std::vector<StepFactor> factors;

  bool operator==(const LiftedProduct&) const = default;
};

/// States theta_i and beta_k as products, G_lift(theta, alpha, beta) = 0 of [nurkanovic2024], section 6.3.
struct Lifting {
  std::vector<LiftedProduct> beta;   ///< each refers to earlier ones only
  std::vector<LiftedProduct> theta;  ///< one per row of S, in its order
};

/// Lifts theta_i = prod_j (1 - S_ij)/2 + S_ij alpha_j (eq. (21) of [nurkanovic2024]) to at most `most_factors` factors
/// per product, a beta counted as one. From the column `most_factors` on, what a row has so far becomes a beta and
/// takes one more factor at a time. All rows that have the same share it. This is Algorithm 1, with 0 in S as the
/// factor 1 and a row closed at its last nonzero column; as printed it fails on such S. All 2^n sign patterns of n
/// functions need
///   n_beta = 2^n - 2^most_factors   for most_factors <= n, else 0.
/// @param signs         rows of -1, 0, 1, one per region
/// @param most_factors  n_d >= 2
/// Cost: rows times columns times the logarithm of the rows.
[[nodiscard]] Lifting lift(const linalg::IntMatrix& signs, int most_factors);

/// Returns theta without lifting: all factors in one product.
[[nodiscard]] Lifting without_lifting(const linalg::IntMatrix& signs);

}  // namespace saltus::reformulation
