#include "saltus/switching/table/independent_rows.hpp"

#include "saltus/linalg/row_basis.hpp"

namespace saltus::switching {

std::vector<std::size_t> independent_rows(const linalg::Matrix& gradients) {
  std::vector<std::size_t> chosen;
  linalg::RowBasis basis(gradients.cols(), gradients.rows(), dependent_part);
  for (linalg::Index k = 0; k < gradients.rows(); ++k) {
    if (basis.takes(gradients.row(k))) chosen.push_back(static_cast<std::size_t>(k));
  }
  return chosen;
}

}  // namespace saltus::switching
