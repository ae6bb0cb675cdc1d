#include "saltus/reformulation/lifting.hpp"

#include <limits>
#include <map>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/base/contracts.hpp"

namespace saltus::reformulation {
namespace {

/// Orders products so that equal ones are found.
std::vector<std::pair<int, bool>> key_of(const LiftedProduct& product) {
  std::vector<std::pair<int, bool>> key{{product.beta, false}};
  for (const auto& factor : product.factors) key.emplace_back(factor.alpha, factor.complement);
  return key;
}

int last_nonzero(const linalg::IntMatrix& signs, linalg::Index row) {
  int last = -1;
  for (int j = 0; j < static_cast<int>(signs.cols()); ++j) {
    if (signs(row, j) != 0) last = j;
  }
  return last;
}

}  // namespace

Lifting lift(const linalg::IntMatrix& signs, int most_factors) {
  SALTUS_ASSERT(most_factors >= 2);
  Lifting lifting;
  lifting.theta.resize(static_cast<std::size_t>(signs.rows()));
  for (int j = 0; j < static_cast<int>(signs.cols()); ++j) {
    std::map<std::vector<std::pair<int, bool>>, int> known;
    for (linalg::Index i = 0; i < signs.rows(); ++i) {
      LiftedProduct& product = lifting.theta[at(i)];
      if (signs(i, j) != 0) product.factors.push_back({j, signs(i, j) < 0});
      const std::size_t size = product.factors.size() + (product.beta >= 0 ? 1 : 0);
      if (j + 1 < most_factors || size < 2 || j >= last_nonzero(signs, i)) continue;
      const auto [place, is_new] = known.try_emplace(key_of(product), static_cast<int>(lifting.beta.size()));
      if (is_new) lifting.beta.push_back(product);
      product = {place->second, {}};
    }
  }
  return lifting;
}

Lifting without_lifting(const linalg::IntMatrix& signs) { return lift(signs, std::numeric_limits<int>::max()); }

}  // namespace saltus::reformulation
