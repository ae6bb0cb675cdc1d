#include "saltus/switching/table/multi_affine.hpp"

#include <cmath>

namespace saltus::switching {
namespace {

/// Exact at alpha = 0 and 1.
double between(double low, double high, double alpha) { return (1.0 - alpha) * low + alpha * high; }

}  // namespace

MultiAffine::MultiAffine(int rows, int selections) { resize(rows, selections); }

void MultiAffine::resize(int rows, int selections) {
  rows_ = rows;
  selections_ = selections;
  values_.resize(static_cast<std::size_t>(rows) * corners());
  work_.resize(corners());
}

MultiAffine::MultiAffine(const CornerTable& table) : MultiAffine(table.surfaces, table.surfaces) {
  for (std::size_t i = 0; i < values_.size(); ++i) values_[i] = table.sides[i].velocity;
}

MultiAffine::MultiAffine(int surfaces, ProjectedField g) : MultiAffine(surfaces, surfaces) {
  const auto m = static_cast<std::size_t>(surfaces);
  std::vector<double> alpha(m);
  std::vector<double> velocity(m);
  for (std::size_t corner = 0; corner < corners(); ++corner) {
    for (std::size_t i = 0; i < m; ++i) alpha[i] = (corner >> i & 1U) != 0 ? 1.0 : 0.0;
    g(alpha.data(), velocity.data());
    for (std::size_t j = 0; j < m; ++j) values_[j * corners() + corner] = velocity[j];
  }
}

void MultiAffine::contract(const double* alpha, double* result) const {
  const double* v = values_.data();
  if (selections_ == 2) {
    const PairWeights weights(alpha);
    for (int j = 0; j < rows_; ++j, v += 4) result[j] = weights.value(v);
    return;
  }
  if (selections_ == 0) {
    for (int j = 0; j < rows_; ++j) result[j] = v[j];
    return;
  }
  for (int j = 0; j < rows_; ++j, v += corners()) {
    const double* from = v;
    for (int i = selections_ - 1; i >= 0; --i) {
      const std::size_t half = std::size_t{1} << i;
      for (std::size_t c = 0; c < half; ++c) work_[c] = between(from[c], from[c + half], alpha[i]);
      from = work_.data();
    }
    result[j] = work_[0];
  }
}

void selection_jacobian(ProjectedField field, Interpolation interpolation, int surfaces, double* alpha, const double* g,
                        double* jacobian, double* shifted) {
  for (int p = 0; p < surfaces; ++p) {
    const double here = alpha[p];
    const double there = difference_end(here, interpolation);
    alpha[p] = there;
    field(alpha, shifted);
    alpha[p] = here;
    for (int j = 0; j < surfaces; ++j) jacobian[j * surfaces + p] = (shifted[j] - g[j]) / (there - here);
  }
}

}  // namespace saltus::switching
