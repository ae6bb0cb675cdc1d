#include "saltus/model/switched_rates.hpp"

#include "saltus/base/at.hpp"

namespace saltus::model {

std::vector<std::vector<int>> switched_rates(const System& system) {
  std::vector<std::vector<int>> rates(system.switching.size());
  if (system.switching.empty() || system.f.numel() == 0) return rates;
  const casadi::Sparsity pattern = casadi::SX::jacobian_sparsity(system.f_as_written, system.alpha);
  for (casadi_int column = 0; column < pattern.size2(); ++column) {
    for (casadi_int k = pattern.colind(column); k < pattern.colind(column + 1); ++k) {
      rates[at(column)].push_back(static_cast<int>(pattern.row(k)));
    }
  }
  return rates;
}

}  // namespace saltus::model
