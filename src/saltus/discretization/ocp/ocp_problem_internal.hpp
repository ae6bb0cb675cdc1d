// What an OcpProblem holds.
#pragma once

#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "saltus/discretization/ocp/ocp_structure_internal.hpp"

namespace saltus::discretization {

/// Holds a fixed parameter that the relaxed problems follow from one value to another.
struct FollowedParameter {
  linalg::Index place = 0;  ///< among the parameters of the local functions
  double initial = 0.0, last = 0.0;
};

/// Returns what each selection is one of: "the switching function 'slip'".
[[nodiscard]] std::vector<std::string> names_of_selections(const model::System& system, const reformulation::Dcs& dcs);

struct OcpProblem::Implementation {
  std::unique_ptr<OcpStructure> structure;
  mpcc::Pattern jacobian_pattern, hessian_pattern;
  linalg::Vector start;
  std::vector<mpcc::NamedStart> other_starts;
  double time_weight = 0.0;
  double method_scale = 0.0;      ///< 0: without the method's terms
  std::vector<int> mean_lengths;  ///< of heuristic_mean: variables; their mean is 1 over the number of their interval
  std::vector<double> mean_values;
  std::optional<FollowedParameter> stabilisation;
  std::set<int> crowded;  ///< OcpProblem::crowded_intervals
  std::vector<std::string> path_names, terminal_names, state_names;
  std::vector<std::string> selection_names;  ///< of what switches, one per selection

  Implementation(std::unique_ptr<OcpStructure> made, const model::Ocp& ocp, const reformulation::Dcs& dcs);
  void find_patterns();
  void functions(mpcc::ConstVectorView w, mpcc::VectorView c) const;
  /// Returns factor of a function's objective: 1, or that of the method.
  [[nodiscard]] double factor(const Placed& placed) const { return placed.term == Term::method ? method_scale : 1.0; }
  [[nodiscard]] double term(Term wanted, mpcc::ConstVectorView w);
  [[nodiscard]] double mean_term(mpcc::ConstVectorView w) const;
  [[nodiscard]] double penalties(mpcc::ConstVectorView w) const;
  [[nodiscard]] double value(int place, mpcc::ConstVectorView w) const {
    return value_at(place, w, structure->constants);
  }
  [[nodiscard]] std::string pair_name(int pair) const;
  /// Returns "interval 3 (t = 0.6 to 0.8)", or, where the horizon is free, with shares of it.
  [[nodiscard]] std::string interval_name(int interval) const;
};

}  // namespace saltus::discretization
