// Whether a complementarity system determines its multipliers: ranks along a solution.
#pragma once

#include <memory>
#include <vector>

namespace saltus::model {
struct System;
}

namespace saltus::reformulation {

struct Dcs;

/// Says where a solution is; mode and alpha as in a result, but one entry per function of System::switching. A region
/// of a group by `indicator` has mode 0 where it is active, and its theta as alpha.
struct SolutionPoint {
  double t = 0.0;
  std::vector<double> x, u;
  std::vector<int> mode;
  std::vector<double> alpha;
};

/// Holds the linear system for the multipliers of an active set, its gradients and fields divided by their lengths: one
/// surface has the cosine of the angle between its gradient and the jump of the field.
struct ActiveSetRank {
  std::vector<int> surfaces;  ///< on which the solution slides, ascending: indices into Dcs::surfaces
  int regions = 0;            ///< active ones of parts in Stewart's form, where several are
  int unknowns = 0;           ///< alpha_K, theta_I, mu
  int rank = 0;
  double smallest_singular_value = 0.0;  ///< infinity where nothing is unknown
};

/// Decides whether selections follow from what stays 0. Let K be the surfaces that are 0, and I the active regions of a
/// simplex with more than one. Equations for alpha_K, theta_I and the rate of mu are the derivatives of psi_K and g_I +
/// mu e with respect to time, and e'theta = 1. Their matrix must be regular:
///   step:     W_{K,I} B_{K,I} = grad psi_K' (df/dalpha_K), |K| x |K|      (Assumption 7 of [nurkanovic2024])
///   Stewart:  [grad g_I' f_I, e; e', 0]                                  [stewart1990]
/// Where two surfaces meet, Stewart's form has four regions and only three equations: it is singular there, whatever
/// the fields are.
class WellPosedness {
 public:
  WellPosedness(const Dcs& dcs, const model::System& system);
  WellPosedness(WellPosedness&&) noexcept;
  ~WellPosedness();

  /// Cost: an evaluation of all gradients, and a singular value decomposition of each block of unknowns.
  [[nodiscard]] ActiveSetRank rank_at(const SolutionPoint& point) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace saltus::reformulation
