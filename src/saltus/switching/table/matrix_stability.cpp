#include "saltus/switching/table/matrix_stability.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "saltus/base/at.hpp"

namespace saltus::switching {
namespace {

constexpr int exhaustive = 10;  ///< 2^10 minors of at most 10 x 10: about 0.1 ms

/// Determinant of the n x n matrix a, which is overwritten.
double determinant_of(double* a, int n, int stride) {
  double determinant = 1.0;
  for (int k = 0; k < n; ++k) {
    int pivot = k;
    for (int i = k + 1; i < n; ++i) {
      if (std::abs(a[i * stride + k]) > std::abs(a[pivot * stride + k])) pivot = i;
    }
    if (a[pivot * stride + k] == 0.0) return 0.0;
    if (pivot != k) {
      for (int j = k; j < n; ++j) std::swap(a[pivot * stride + j], a[k * stride + j]);
      determinant = -determinant;
    }
    determinant *= a[k * stride + k];
    for (int i = k + 1; i < n; ++i) {
      const double factor = a[i * stride + k] / a[k * stride + k];
      for (int j = k + 1; j < n; ++j) a[i * stride + j] -= factor * a[k * stride + j];
    }
  }
  return determinant;
}

/// Principal minor of -A (rows scaled) for the indices in `subset`.
double minor_of(std::span<const double> a, int n, unsigned subset, std::vector<double>& work) {
  int size = 0;
  for (int i = 0; i < n; ++i) {
    if ((subset >> i & 1U) == 0) continue;
    int column = 0;
    for (int j = 0; j < n; ++j) {
      if ((subset >> j & 1U) != 0) work[at(size * n + column++)] = -a[at(i * n + j)];
    }
    ++size;
  }
  return determinant_of(work.data(), size, n);
}

double best_ordering(std::span<const double> a, int n, std::vector<double>& work) {
  std::vector<double> best(std::size_t{1} << n, std::numeric_limits<double>::infinity());
  for (unsigned subset = 1; subset < best.size(); ++subset) {
    double before = -std::numeric_limits<double>::infinity();
    for (int j = 0; j < n; ++j) {
      if ((subset >> j & 1U) != 0) before = std::max(before, best[subset & ~(1U << j)]);
    }
    best[subset] = std::min(before, minor_of(a, n, subset, work));
  }
  return best.back();
}

double greedy_ordering(std::span<const double> a, int n, std::vector<double>& work) {
  double margin = std::numeric_limits<double>::infinity();
  unsigned chosen = 0;
  for (int k = 0; k < n; ++k) {
    double best = -std::numeric_limits<double>::infinity();
    unsigned next = 0;
    for (int j = 0; j < n; ++j) {
      if ((chosen >> j & 1U) != 0) continue;
      const double minor = minor_of(a, n, chosen | 1U << j, work);
      if (minor > best) {
        best = minor;
        next = 1U << j;
      }
    }
    chosen |= next;
    margin = std::min(margin, best);
  }
  return margin;
}

double norm(const std::vector<double>& a, int n) {
  double largest = 0.0;
  for (int i = 0; i < n; ++i) {
    double sum = 0.0;
    for (int j = 0; j < n; ++j) sum += std::abs(a[at(i * n + j)]);
    largest = std::max(largest, sum);
  }
  return largest;
}

void square(std::vector<double>& a, std::vector<double>& work, int n) {
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      double sum = 0.0;
      for (int k = 0; k < n; ++k) sum += a[at(i * n + k)] * a[at(k * n + j)];
      work[at(i * n + j)] = sum;
    }
  }
  std::swap(a, work);
}

}  // namespace

LuFactors::LuFactors(int n) : n_(n), lu_(at(n * n)), pivot_(at(n)) {}

bool LuFactors::factor(std::span<const double> matrix) {
  std::copy(matrix.begin(), matrix.end(), lu_.begin());
  determinant_ = 1.0;
  bool regular = true;
  for (int k = 0; k < n_; ++k) {
    int pivot = k;
    for (int i = k + 1; i < n_; ++i) {
      if (std::abs(lu_[at(i * n_ + k)]) > std::abs(lu_[at(pivot * n_ + k)])) pivot = i;
    }
    pivot_[at(k)] = pivot;
    if (pivot != k) {
      for (int j = 0; j < n_; ++j) std::swap(lu_[at(pivot * n_ + j)], lu_[at(k * n_ + j)]);
      determinant_ = -determinant_;
    }
    const double diagonal = lu_[at(k * n_ + k)];
    determinant_ *= diagonal;
    if (!(std::abs(diagonal) > 0.0)) {
      regular = false;
      continue;
    }
    for (int i = k + 1; i < n_; ++i) {
      const double factor = lu_[at(i * n_ + k)] /= diagonal;
      for (int j = k + 1; j < n_; ++j) lu_[at(i * n_ + j)] -= factor * lu_[at(k * n_ + j)];
    }
  }
  return regular;
}

void LuFactors::solve(double* b) const {
  for (int k = 0; k < n_; ++k) std::swap(b[k], b[pivot_[at(k)]]);
  for (int k = 0; k < n_; ++k) {
    for (int i = k + 1; i < n_; ++i) b[i] -= lu_[at(i * n_ + k)] * b[k];
  }
  for (int k = n_ - 1; k >= 0; --k) {
    for (int j = k + 1; j < n_; ++j) b[k] -= lu_[at(k * n_ + j)] * b[j];
    b[k] /= lu_[at(k * n_ + k)];
  }
}

bool is_hurwitz(std::span<const double> matrix, int n) {
  if (n == 0) return true;
  if (n == 1) return matrix[0] < 0.0;
  if (n == 2) return matrix[0] + matrix[3] < 0.0 && matrix[0] * matrix[3] - matrix[1] * matrix[2] > 0.0;
  std::vector<double> a(matrix.begin(), matrix.end());
  const double size = norm(a, n);
  if (!(size > 0.0)) return false;
  // C = (I - hA)^-1 (I + hA) = -I + 2 (I - hA)^-1 with h = 1 / |A|: eigenvalues inside the unit circle iff Re < 0.
  std::vector<double> shifted(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) shifted[i] = -a[i] / size;
  for (int i = 0; i < n; ++i) shifted[at(i * n + i)] += 1.0;
  LuFactors lu(n);
  if (!lu.factor(shifted)) return false;  // an eigenvalue at |A| > 0
  std::vector<double> column(at(n));
  for (int j = 0; j < n; ++j) {
    std::fill(column.begin(), column.end(), 0.0);
    column[at(j)] = 2.0;
    lu.solve(column.data());
    column[at(j)] -= 1.0;
    for (int i = 0; i < n; ++i) a[at(i * n + j)] = column[at(i)];
  }
  // 2^40 powers tell real parts of 1e-12 |A| from 0; beyond that it is rounding.
  for (int k = 0; k < 40; ++k) {
    square(a, shifted, n);
    const double power = norm(a, n);
    if (power < 0.5) return true;
    if (!(power < 1e100)) return false;
  }
  return false;
}

double hurwitz_margin(std::span<const double> matrix, int n) {
  std::vector<double> a(matrix.begin(), matrix.end());
  const double size = norm(a, n);
  if (!(size > 0.0)) return 0.0;
  for (double& entry : a) entry /= size;
  // Faddeev and LeVerrier: c_k = -tr(A B) / k with B <- A B + c_k I from B = I.
  std::vector<double> c(at(n + 1));
  c[0] = 1.0;
  std::vector<double> product(a);
  for (int k = 1; k <= n; ++k) {
    double trace = 0.0;
    for (int i = 0; i < n; ++i) trace += product[at(i * n + i)];
    c[at(k)] = -trace / k;
    std::vector<double> b(product);
    for (int i = 0; i < n; ++i) b[at(i * n + i)] += c[at(k)];
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) {
        double sum = 0.0;
        for (int l = 0; l < n; ++l) sum += a[at(i * n + l)] * b[at(l * n + j)];
        product[at(i * n + j)] = sum;
      }
    }
  }
  double margin = std::numeric_limits<double>::infinity();
  std::vector<double> hurwitz(at(n * n));
  for (int k = 1; k <= n; ++k) {
    for (int i = 0; i < k; ++i) {
      for (int j = 0; j < k; ++j) {
        const int degree = 2 * (j + 1) - (i + 1);
        hurwitz[at(i * k + j)] = degree >= 0 && degree <= n ? c[at(degree)] : 0.0;
      }
    }
    margin = std::min(margin, determinant_of(hurwitz.data(), k, k));
  }
  return margin;
}

double fisher_fuller_margin(std::span<const double> matrix, int n) {
  // NOTE: up to 2 x 2 without workspace, since sliding on two surfaces asks in every step.
  const auto scaled = [&](int i, int j) {
    double largest = 0.0;
    for (int k = 0; k < n; ++k) largest = std::max(largest, std::abs(matrix[at(i * n + k)]));
    return largest > 0.0 ? matrix[at(i * n + j)] / largest : 0.0;
  };
  if (n == 1) return -scaled(0, 0);
  if (n == 2) {
    const double first = scaled(0, 0);
    const double second = scaled(1, 1);
    return std::min(first * second - scaled(0, 1) * scaled(1, 0), std::max(-first, -second));
  }
  std::vector<double> a(at(n * n));
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) a[at(i * n + j)] = scaled(i, j);
  }
  std::vector<double> work(a.size());
  return n <= exhaustive ? best_ordering(a, n, work) : greedy_ordering(a, n, work);
}

}  // namespace saltus::switching
