// Selections that enter additively: the velocities they can give, where 0 leaves these, and which selections give 0.
#pragma once

#include <cstdint>
#include <vector>

#include "saltus/linalg/factors.hpp"
#include "saltus/linalg/matrix.hpp"

namespace saltus::switching {

/// Holds the set { a + B lambda : lambda in [0, 1]^q } in R^r, a zonotope, for B of rank r <= q. It holds 0 as long as
/// every pair of parallel facets has 0 between them; facets follow from B alone and are found again only where that
/// changes by more than rounding. Cost per new B: that of column_hyperplanes().
class SelectionRange {
 public:
  /// Holds both facets with a normal d: lambda_i is at opposite bounds on them, and free where d . B_i = 0.
  struct Facets {
    linalg::Vector normal;          ///< sum of |d . B_i| is 1
    std::vector<std::int8_t> sign;  ///< q: of d . B_i
  };
  /// Holds the range of d . (a + B lambda) over the cube.
  struct Span {
    double min = 0.0, max = 0.0;
    double terms = 0.0;  ///< sizes of what they are the sum of: bounds their rounding
  };

  /// Takes the set of this B.
  /// @param effects  B, r x q
  /// @return false if its rank is below r, or there are more flats of one rank than `most_flats`
  bool set(const linalg::Matrix& effects);
  [[nodiscard]] const std::vector<Facets>& facets() const { return facets_; }
  /// Returns the span along the normal of a pair of facets.
  /// @param constant  a, r
  [[nodiscard]] Span span(std::size_t facets, const linalg::Vector& constant) const;

  /// Ten agents, each with each, have up to 42 525 of a rank; about a second.
  static constexpr std::size_t most_flats = 50000;

 private:
  linalg::Matrix effects_, of_facets_;  ///< B, and the one that facets belong to
  std::vector<Facets> facets_;
};

/// Returns the solution of a + B lambda = 0 nearest to lambda = 1/2, bounds or not: 1/2 - B^T (B B^T)^-1 (a + B 1/2).
[[nodiscard]] linalg::Vector central_selections(const linalg::Matrix& effects, const linalg::Vector& constant);

/// Finds the same bits from one point of a motion to the next. B is factored again only where it changes.
class CentralSelections {
 public:
  [[nodiscard]] const linalg::Vector& solve(const linalg::Matrix& effects, const linalg::Vector& constant);

 private:
  linalg::Matrix effects_;
  linalg::OrthogonalFactors factors_;  ///< of effects_
  linalg::Vector half_, excess_, lambda_;
};

/// Returns the solution in [0, 1]^q nearest to 1/2, by Newton's method for the r multipliers of a + B clip(1/2 + B^T
/// mu) = 0; the nearest miss where there is none. Cost: some ten solutions of r equations.
[[nodiscard]] linalg::Vector bounded_selections(const linalg::Matrix& effects, const linalg::Vector& constant);

/// Does the same where the central ones are known: `lambda` becomes those in the box. Cost: nothing where it lies
/// there.
void bound_selections(const linalg::Matrix& effects, const linalg::Vector& constant, linalg::Vector& lambda);

}  // namespace saltus::switching
