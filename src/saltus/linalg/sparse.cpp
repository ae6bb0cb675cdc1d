#include "saltus/linalg/sparse.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/base/contracts.hpp"

namespace saltus::linalg {
namespace {

/// The place of an entry: along the compressed direction, and inside of it.
template <Major major>
[[nodiscard]] std::pair<Index, Index> place_of(const Triplet& entry) {
  if constexpr (major == Major::columns) return {entry.column, entry.row};
  return {entry.row, entry.column};
}

}  // namespace

template <Major major>
Sparse<major>::Sparse(Index rows, Index columns) : rows_(rows), columns_(columns), start_(at(outer_size()) + 1, 0) {}

template <Major major>
Sparse<major>::Sparse(Index rows, Index columns, std::span<const Triplet> entries) : Sparse(rows, columns) {
  std::vector<int> count(at(outer_size()) + 1, 0);
  for (const Triplet& entry : entries) ++count[at(place_of<major>(entry).first) + 1];
  for (std::size_t o = 1; o < count.size(); ++o) count[o] += count[o - 1];
  std::vector<Entry> sorted(entries.size());
  std::vector<int> next = count;
  for (const Triplet& entry : entries) {
    const auto [outer, inner] = place_of<major>(entry);
    sorted[at(next[at(outer)]++)] = {static_cast<int>(inner), entry.value};
  }
  for (Index o = 0; o < outer_size(); ++o) {
    const auto first = sorted.begin() + count[at(o)], last = sorted.begin() + count[at(o) + 1];
    std::stable_sort(first, last, [](const Entry& a, const Entry& b) { return a.inner < b.inner; });
    for (auto entry = first; entry != last; ++entry) {
      if (std::ssize(inner_) > start_[at(o)] && inner_.back() == entry->inner) {
        values_.back() += entry->value;
      } else {
        inner_.push_back(entry->inner);
        values_.push_back(entry->value);
      }
    }
    start_[at(o) + 1] = static_cast<int>(inner_.size());
  }
}

template <Major major>
Sparse<major>::Sparse(Index rows, Index columns, std::vector<int> start, std::vector<int> inner,
                      std::vector<double> values)
    : rows_(rows), columns_(columns), start_(std::move(start)), inner_(std::move(inner)), values_(std::move(values)) {
  SALTUS_ASSERT(std::ssize(start_) == outer_size() + 1 && inner_.size() == values_.size());
}

template <Major major>
double Sparse<major>::operator()(Index row, Index column) const {
  const auto [outer, inner] = place_of<major>({row, column, 0.0});
  const auto first = inner_.begin() + start_[at(outer)], last = inner_.begin() + start_[at(outer) + 1];
  const auto found = std::lower_bound(first, last, static_cast<int>(inner));
  return found != last && *found == inner ? values_[at(found - inner_.begin())] : 0.0;
}

template <Major major>
Vector Sparse<major>::diagonal() const {
  Vector result(std::min(rows_, columns_));
  for (Index i = 0; i < result.size(); ++i) result[i] = (*this)(i, i);
  return result;
}

template <Major major>
Matrix Sparse<major>::dense() const {
  Matrix result = Matrix::zero(rows_, columns_);
  for (Index o = 0; o < outer_size(); ++o) {
    for (const Entry entry : along(o)) {
      (major == Major::columns ? result(entry.inner, o) : result(o, entry.inner)) = entry.value;
    }
  }
  return result;
}

template <Major major>
double Sparse<major>::norm() const {
  return ConstView(values_).norm();
}

template <Major major>
bool Sparse<major>::all_finite() const {
  return ConstView(values_).all_finite();
}

template <Major major>
Matrix Sparse<major>::times(ConstView x) const {
  SALTUS_ASSERT(x.rows() == columns_);
  Matrix result = Matrix::zero(rows_, x.cols());
  for (Index j = 0; j < x.cols(); ++j) {
    for (Index o = 0; o < outer_size(); ++o) {
      for (const Entry entry : along(o)) {
        if constexpr (major == Major::columns) {
          result(entry.inner, j) += entry.value * x(o, j);
        } else {
          result(o, j) += entry.value * x(entry.inner, j);
        }
      }
    }
  }
  return result;
}

template <Major major>
Matrix Sparse<major>::transposed_times(ConstView x) const {
  SALTUS_ASSERT(x.rows() == rows_);
  Matrix result = Matrix::zero(columns_, x.cols());
  for (Index j = 0; j < x.cols(); ++j) {
    for (Index o = 0; o < outer_size(); ++o) {
      for (const Entry entry : along(o)) {
        if constexpr (major == Major::columns) {
          result(o, j) += entry.value * x(entry.inner, j);
        } else {
          result(entry.inner, j) += entry.value * x(o, j);
        }
      }
    }
  }
  return result;
}

template <Major major>
Sparse<major> Sparse<major>::transposed() const {
  std::vector<Triplet> entries = triplets();
  for (Triplet& entry : entries) std::swap(entry.row, entry.column);
  return {columns_, rows_, entries};
}

template <Major major>
void Sparse<major>::scale_rows(ConstView factors) {
  for (Index o = 0; o < outer_size(); ++o) {
    for (int k = start_[at(o)]; k < start_[at(o) + 1]; ++k)
      values_[at(k)] *= factors[major == Major::columns ? inner_[at(k)] : o];
  }
}

template <Major major>
std::vector<Triplet> Sparse<major>::triplets() const {
  std::vector<Triplet> result;
  result.reserve(values_.size());
  for (Index o = 0; o < outer_size(); ++o) {
    for (const Entry entry : along(o)) {
      if constexpr (major == Major::columns) {
        result.push_back({entry.inner, o, entry.value});
      } else {
        result.push_back({o, entry.inner, entry.value});
      }
    }
  }
  return result;
}

template class Sparse<Major::columns>;
template class Sparse<Major::rows>;

SparseColumns operator+(const SparseColumns& a, const SparseColumns& b) {
  std::vector<Triplet> entries = a.triplets();
  const std::vector<Triplet> others = b.triplets();
  entries.insert(entries.end(), others.begin(), others.end());
  return {a.rows(), a.cols(), entries};
}

namespace {

/// Vector o of the product is the sum of those of `vectors`, by the entries of vector o of `factors`.
template <Major major>
Sparse<major> product(const Sparse<major>& vectors, const Sparse<major>& factors, Index rows, Index columns) {
  std::vector<Triplet> entries;
  const auto size = at(major == Major::columns ? rows : columns);
  std::vector<double> sums(size, 0.0);
  std::vector<bool> is_met(size, false);
  std::vector<int> met;
  for (Index o = 0; o < factors.outer_size(); ++o) {
    for (const Entry factor : factors.along(o)) {
      for (const Entry entry : vectors.along(factor.inner)) {
        if (!is_met[at(entry.inner)]) met.push_back(entry.inner);
        is_met[at(entry.inner)] = true;
        sums[at(entry.inner)] += entry.value * factor.value;
      }
    }
    for (const int inner : met) {
      const double sum = sums[at(inner)];
      entries.push_back(major == Major::columns ? Triplet{inner, o, sum} : Triplet{o, inner, sum});
      sums[at(inner)] = 0.0;
      is_met[at(inner)] = false;
    }
    met.clear();
  }
  return {rows, columns, entries};
}

}  // namespace

SparseColumns operator*(const SparseColumns& a, const SparseColumns& b) {
  SALTUS_ASSERT(a.cols() == b.rows());
  return product(a, b, a.rows(), b.cols());
}

SparseRows operator*(const SparseRows& a, const SparseRows& b) {
  SALTUS_ASSERT(a.cols() == b.rows());
  return product(b, a, a.rows(), b.cols());
}

SparseRows by_rows(SparseView<Major::columns> a) {
  std::vector<int> start(at(a.rows()) + 1, 0), inner(at(a.entries()));
  std::vector<double> values(inner.size());
  for (Index j = 0; j < a.cols(); ++j) {
    for (const Entry entry : a.along(j)) ++start[at(entry.inner) + 1];
  }
  for (std::size_t i = 1; i < start.size(); ++i) start[i] += start[i - 1];
  std::vector<int> next = start;
  for (Index j = 0; j < a.cols(); ++j) {
    for (const Entry entry : a.along(j)) {
      const auto place = at(next[at(entry.inner)]++);
      inner[place] = static_cast<int>(j);
      values[place] = entry.value;
    }
  }
  return {a.rows(), a.cols(), std::move(start), std::move(inner), std::move(values)};
}

}  // namespace saltus::linalg
