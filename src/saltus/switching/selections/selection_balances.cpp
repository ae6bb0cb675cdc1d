#include "saltus/switching/selections/selection_balances.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/base/components.hpp"
#include "saltus/switching/table/field_accuracy.hpp"

namespace saltus::switching {

Balances balances_of(const linalg::Matrix& effects, const linalg::Matrix& terms) {
  const auto r = static_cast<std::size_t>(effects.rows()), q = static_cast<std::size_t>(effects.cols());
  const auto acts = [&](std::size_t k, std::size_t i) {
    return std::abs(effects(index(k), index(i))) > field_accuracy * terms(index(k), index(i));
  };
  Balances balances;
  Components components(r);
  for (std::size_t i = 0; i < q; ++i) {
    std::size_t first = r;
    for (std::size_t k = 0; k < r; ++k) {
      if (!acts(k, i)) continue;
      if (first == r) first = k;
      components.join(first, k);
    }
    if (first == r) balances.unused.push_back(i);
  }
  for (auto& functions : components.lists()) {
    Balance balance;
    balance.functions = std::move(functions);
    for (std::size_t i = 0; i < q; ++i) {
      const auto& own = balance.functions;
      if (std::any_of(own.begin(), own.end(), [&](std::size_t f) { return acts(f, i); })) balance.rows.push_back(i);
    }
    balances.all.push_back(std::move(balance));
  }
  return balances;
}

}  // namespace saltus::switching
