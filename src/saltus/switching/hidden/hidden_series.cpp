#include <algorithm>
#include <cmath>

#include "saltus/base/contracts.hpp"
#include "saltus/switching/hidden/hidden_series_internal.hpp"

namespace saltus::switching {
namespace {

/// v about a point: first derivatives, and the second one over both components.
struct Expansion {
  Expansion(const MultiAffine& face, int row, double x, double y) {
    const auto corner = [&](std::size_t c) { return face.value(row, c); };
    along_x = (1.0 - y) * (corner(1) - corner(0)) + y * (corner(3) - corner(2));
    along_y = (1.0 - x) * (corner(2) - corner(0)) + x * (corner(3) - corner(1));
    mixed = (corner(3) - corner(2)) - (corner(1) - corner(0));
  }
  /// The term of v behind those of the components and of the product of their series.
  [[nodiscard]] double next(double x, double y, double product) const {
    return along_x * x + along_y * y + mixed * product;
  }
  double along_x, along_y, mixed;
};

constexpr double inverse(std::size_t k) { return 1.0 / static_cast<double>(k); }

}  // namespace

void PairSeries::take(const MultiAffine& face, const std::vector<int>& free, const std::vector<double>& u,
                      const std::vector<double>& v, double tolerance, double longest) {
  SALTUS_ASSERT(face.selections() == 2 && free.size() == 2);
  const auto first = static_cast<std::size_t>(free[0]);
  const auto second = static_cast<std::size_t>(free[1]);
  const Expansion about_first(face, free[0], u[first], u[second]);
  const Expansion about_second(face, free[1], u[first], u[second]);
  std::array<double, order> products{};  // of the two series without their first terms
  Coefficients x{u[first], v[first]};
  Coefficients y{u[second], v[second]};
#pragma GCC unroll 16
  for (std::size_t k = 1; k < order; ++k) {
    std::array<double, 2> product{};  // two sums that do not wait for each other
#pragma GCC unroll 16
    for (std::size_t i = 1; i < k; ++i) product[i % 2] += x[i] * y[k - i];
    products[k] = product[0] + product[1];
    x[k + 1] = about_first.next(x[k], y[k], products[k]) * inverse(k + 1);
    y[k + 1] = about_second.next(x[k], y[k], products[k]) * inverse(k + 1);
  }
  coefficients_[first] = x;
  coefficients_[second] = y;
  for (std::size_t j = 0; j < u.size(); ++j) {
    if (j == first || j == second) continue;
    const Expansion about(face, static_cast<int>(j), u[first], u[second]);
    Coefficients& w = coefficients_[j];
    w[0] = u[j];
    w[1] = v[j];
    for (std::size_t k = 1; k < order; ++k) w[k + 1] = about.next(x[k], y[k], products[k]) * inverse(k + 1);
  }
  h_ = length(tolerance, longest);
  double power = 1.0;
  for (std::size_t k = 1; k <= order; ++k) {
    power *= h_;
    for (Coefficients& coefficients : coefficients_) coefficients[k] *= power;
  }
}

double PairSeries::length(double tolerance, double longest) const {
  double shortest = std::log(longest);
  for (const std::size_t k : {order - 1, order}) {
    double largest = 0.0;
    for (const Coefficients& c : coefficients_) largest = std::max(largest, std::abs(c[k]) / (1.0 + std::abs(c[0])));
    if (largest > 0.0) shortest = std::min(shortest, std::log(tolerance / largest) * inverse(k));
  }
  return std::exp(shortest);
}

void PairSeries::evaluate(double theta, double* u) const {
  for (std::size_t j = 0; j < coefficients_.size(); ++j) {
    const Coefficients& c = coefficients_[j];
    double value = c[order];
    for (std::size_t k = order; k > 0; --k) value = value * theta + c[k - 1];
    u[j] = value;
  }
}

void PairSeries::bounds(double* low, double* high) const {
  for (std::size_t j = 0; j < coefficients_.size(); ++j) {
    low[j] = high[j] = coefficients_[j][0];
    for (std::size_t k = 1; k <= order; ++k) {
      low[j] += std::min(coefficients_[j][k], 0.0);
      high[j] += std::max(coefficients_[j][k], 0.0);
    }
  }
}

}  // namespace saltus::switching
