#include "saltus/switching/selections/selection_balances.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "saltus/base/at.hpp"
#include "saltus/switching/table/field_accuracy.hpp"

namespace saltus::switching {

Balances balances_of(const Eigen::MatrixXd& effects, const Eigen::MatrixXd& terms) {
  const auto r = static_cast<std::size_t>(effects.rows()), q = static_cast<std::size_t>(effects.cols());
  const auto acts = [&](std::size_t k, std::size_t i) {
    return std::abs(effects(index(k), index(i))) > field_accuracy * terms(index(k), index(i));
  };
  Balances balances;
  std::vector<std::size_t> group(r);
  std::iota(group.begin(), group.end(), std::size_t{0});
  for (std::size_t i = 0; i < q; ++i) {
    std::size_t first = r;
    for (std::size_t k = 0; k < r; ++k) {
      if (!acts(k, i)) continue;
      if (first == r) {
        first = group[k];
      } else if (group[k] != first) {
        const std::size_t other = group[k];
        std::replace(group.begin(), group.end(), other, first);
      }
    }
    if (first == r) balances.unused.push_back(i);
  }
  for (std::size_t k = 0; k < r; ++k) {
    if (std::find(group.begin(), group.begin() + static_cast<std::ptrdiff_t>(k), group[k]) !=
        group.begin() + static_cast<std::ptrdiff_t>(k)) {
      continue;
    }
    Balance balance;
    for (std::size_t other = k; other < r; ++other) {
      if (group[other] == group[k]) balance.functions.push_back(other);
    }
    for (std::size_t i = 0; i < q; ++i) {
      const auto& own = balance.functions;
      if (std::any_of(own.begin(), own.end(), [&](std::size_t f) { return acts(f, i); })) balance.rows.push_back(i);
    }
    balances.all.push_back(std::move(balance));
  }
  return balances;
}

}  // namespace saltus::switching
