#include "saltus/switching/table/independent_rows.hpp"

namespace saltus::switching {

using linalg::Index;

std::vector<std::size_t> independent_rows(const linalg::Matrix& gradients) {
  std::vector<std::size_t> chosen;
  linalg::Matrix basis(gradients.cols(), gradients.rows());
  for (Index k = 0; k < gradients.rows(); ++k) {
    linalg::Vector rest = gradients.row(k).transpose();
    const double size = rest.norm();
    if (!(size > 0.0)) continue;
    rest /= size;
    const auto count = static_cast<Index>(chosen.size());
    const auto spanned = basis.left_cols(count);
    // Twice: what the first pass leaves of a gradient that is nearly one of theirs is rounding.
    for (int pass = 0; pass < 2; ++pass) rest -= spanned * (spanned.transpose() * rest);
    if (!(rest.norm() > dependent_part)) continue;
    basis.col(count) = rest.normalized();
    chosen.push_back(static_cast<std::size_t>(k));
  }
  return chosen;
}

}  // namespace saltus::switching
