// Values of a System and of its dynamic complementarity system where nothing slides, for tests that compare them.
#pragma once

#include <vector>

#include <casadi/core/dm.hpp>

#include "saltus/reformulation/dcs.hpp"

namespace saltus::problems {

struct SmoothPoint {
  double t = 0.0;
  std::vector<double> x, u;
};

/// What a system is at a point off all surfaces.
struct SystemValues {
  std::vector<double> f, alpha, outputs;
  double nearest = 0.0;  ///< the smallest |psi|, or difference of the two smallest indicators
};
[[nodiscard]] SystemValues values_at(const model::System& system, const SmoothPoint& point);

struct DcsValues {
  std::vector<double> f, alpha, outputs, selection, lifted, held, surface_alpha;
  double nearest = 0.0;
};
[[nodiscard]] DcsValues values_at(const reformulation::Dcs& dcs, const model::System& system, const SmoothPoint& point);

/// Values of an expression over the symbols of a Dcs; of `values`, selection, lifted and held are used.
[[nodiscard]] std::vector<double> evaluated(const reformulation::Dcs& dcs, const model::System& system,
                                            const casadi::SX& expression, const SmoothPoint& point,
                                            const DcsValues& values);

/// A repeatable point around the initial state.
[[nodiscard]] SmoothPoint random_point(const model::System& system, unsigned seed);

}  // namespace saltus::problems
