// The regularised system: step selections become continuous functions of the state, in a layer around their surfaces.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/model/system.hpp"

namespace saltus::smoothed {

/// Holds one side of the surfaces inside a nested function (the only one, if nothing is inside), and the corners of pi
/// there.
struct Side {
  std::vector<int> values;  ///< 0 or 1, one per Layer::inner
  std::size_t lower = 0;    ///< column of psi = -epsilon in the regularised system
  std::size_t upper = 0;    ///< column of psi = epsilon; that of `lower` for a function that makes no jump
};

/// Holds the layer of one switching function of the original system: one for each side of the surfaces inside it.
struct Layer {
  std::vector<std::size_t> inner;  ///< layers with a smaller index
  std::vector<Side> sides;         ///< 2^(number of inner layers)
};

/// Holds the modes of a group by `indicator`: names, and the columns of eps (log theta_i + weight_range) in the
/// regularised system, positive where a region has a weight that matters.
struct SoftRegions {
  std::vector<std::string> names;
  std::vector<std::size_t> columns;
};

/// A region is active from a weight of exp(-14), about 1e-6, on: less does not move the state by more than that.
inline constexpr double weight_range = 14.0;

/// Holds the regularised system, and how to read its results.
struct Regularisation {
  model::System system;       ///< its last outputs are the selections, one per column of `columns`, and
                              ///< the weights of all regions
  std::vector<Layer> layers;  ///< of the listed functions, and of others that have a column
  std::vector<model::SwitchingColumn> columns;  ///< of the original system, with indices into `layers`
  std::vector<SoftRegions> regions;
  double epsilon = 0.0;
};

/// Replaces every selection of a listed switching function by
///   alpha_j = (1 + pi(psi_j / epsilon)) / 2,   pi(u) = u for |u| <= 1, sign(u) outside
/// ([guglielmi2022], section 2.2). Kinks, time events, discrete states, jumps and [[events]] stay what they are. With
/// Inclusion::filippov the right-hand side is the multi-affine interpolation between the sides of all surfaces that
/// occur inside others; with aizerman_pyatnitskii the selections enter it as written.
/// The weights of modes by `indicator` become soft minima
///   theta_i = exp(-g_i / epsilon) / sum_j exp(-g_j / epsilon),
/// of which the event engine's are the limit, also where the indicators depend on each other. They have no corners;
/// where regions are left tangentially the error is epsilon log(1 / epsilon).
/// @param epsilon  > 0, in the units of the switching functions
/// @return the system; not_available if more than six surfaces have functions nested around them (2^6 sides), or if
///         an indicator jumps
[[nodiscard]] Expected<Regularisation> regularise(const model::System& system, double epsilon);

}  // namespace saltus::smoothed
