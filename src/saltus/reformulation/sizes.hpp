// How large the problem of one stage is: Table 4 of [nurkanovic2024].
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/reformulation/reformulation_options.hpp"

namespace saltus::model {
struct System;
}

namespace saltus::reformulation {

/// Holds numbers of one stage, with the multipliers theta as variables of their own, as the paper counts (our systems
/// have them eliminated: f is written in alpha and beta).
struct Counts {
  int alpha = 0;              ///< n_psi; 0 in Stewart's form
  int theta = 0;              ///< n_f: fields that differ, in Stewart's form sign patterns
  int beta = 0;               ///< lifted variables
  int algebraic = 0;          ///< n_alg:  step n_f + 3 n_psi + n_beta;  Stewart 2 n_f + 1
  int complementarities = 0;  ///< n_comp: step 2 n_psi;                 Stewart n_f
  int equations = 0;          ///< n_eq:   step n_psi + n_beta + n_f;    Stewart n_f + 1

  [[nodiscard]] bool operator==(const Counts&) const = default;
};

/// Holds one group of switching functions that occur in common products.
struct GroupSizes {
  std::vector<std::string> surfaces;  ///< names; of modes for a group by `indicator`
  Form form = Form::step;
  Counts counts;
};

struct Sizes {
  std::vector<GroupSizes> groups;
  Counts total;
};

/// @return the sizes of reformulate's result, or the reason why there is none.
[[nodiscard]] Expected<Sizes> sizes_of(const model::System& system, const ReformulationOptions& options = {});
/// Counts the same for several options, in little more time than for one.
[[nodiscard]] std::vector<Expected<Sizes>> sizes_of_all(const model::System& system,
                                                        std::span<const ReformulationOptions> options);

}  // namespace saltus::reformulation
