#include "saltus/switching/selections/column_flats.hpp"

#include <algorithm>
#include <unordered_set>

#include "saltus/base/at.hpp"

namespace saltus::switching {
namespace {

using linalg::Index;
using linalg::Matrix;
using linalg::Vector;

/// Of columns of length 1: they come from gradients and fields, good to 12 digits.
constexpr double no_length = 1e-9;

using Members = std::vector<bool>;

/// What is left of columns outside the span of some of them, and which have nothing left.
struct Rest {
  Matrix columns;
  Members members;

  explicit Rest(Matrix unit_columns) : columns(std::move(unit_columns)), members(count()) { note_members(); }

  /// The span gets column i, which has something left.
  void take(Index i) {
    const Vector direction = columns.col(i).normalized();
    // Twice: what is left of the first time are roundings of what was taken.
    for (int pass = 0; pass < 2; ++pass) {
      for (Index j = 0; j < columns.cols(); ++j) columns.col(j).add_scaled(-direction.dot(columns.col(j)), direction);
    }
    note_members();
  }
  [[nodiscard]] bool has(Index i) const { return members[at(i)]; }

 private:
  [[nodiscard]] std::size_t count() const { return static_cast<std::size_t>(columns.cols()); }
  void note_members() {
    for (std::size_t i = 0; i < count(); ++i) {
      members[i] = !(columns.col(static_cast<Index>(i)).squared_norm() > no_length * no_length);
    }
  }
};

Rest rest_of(const Matrix& unit_columns, const std::vector<Index>& basis) {
  Rest rest(unit_columns);
  for (const Index i : basis) rest.take(i);
  return rest;
}

/// Of its bases the first one in lexical order.
std::vector<Index> first_basis(const Matrix& unit_columns, const Members& members, Index rank) {
  Rest rest(unit_columns);
  std::vector<Index> basis;
  for (Index i = 0; i < unit_columns.cols() && static_cast<Index>(basis.size()) < rank; ++i) {
    if (!members[at(i)] || rest.has(i)) continue;
    rest.take(i);
    basis.push_back(i);
  }
  return basis;
}

struct Flat {
  std::vector<Index> basis;
  Members members;
};

}  // namespace

std::optional<std::vector<std::vector<Index>>> column_hyperplanes(const Matrix& columns, std::size_t most) {
  if (!columns.all_finite()) return std::nullopt;
  Matrix unit = columns;
  for (Index i = 0; i < unit.cols(); ++i) {
    if (const double size = unit.col(i).norm(); size > 0.0) unit.col(i) /= size;
  }
  std::vector<Flat> flats{{{}, Rest(unit).members}};
  Vector direction(columns.rows()), left(columns.rows());
  for (Index rank = 1; rank < columns.rows(); ++rank) {
    std::vector<Flat> next;
    std::unordered_set<Members> known;
    for (const Flat& flat : flats) {
      const Rest rest = rest_of(unit, flat.basis);
      Members reached = flat.members;
      for (Index i = 0; i < unit.cols(); ++i) {
        if (reached[at(i)]) continue;
        direction = rest.columns.col(i).normalized();
        Members members = flat.members;
        // Those that an earlier column reached are with that one.
        for (Index j = i; j < unit.cols(); ++j) {
          const auto place = static_cast<std::size_t>(j);
          if (reached[place]) continue;
          left = rest.columns.col(j);
          left.add_scaled(-direction.dot(left), direction);
          if (j == i || !(left.squared_norm() > no_length * no_length)) members[place] = reached[place] = true;
        }
        if (!known.insert(members).second) continue;
        if (next.size() == most) return std::nullopt;
        next.push_back({flat.basis, std::move(members)});
        next.back().basis.push_back(i);
      }
    }
    flats = std::move(next);
  }
  std::vector<std::vector<Index>> bases;
  for (const Flat& flat : flats) bases.push_back(first_basis(unit, flat.members, columns.rows() - 1));
  std::sort(bases.begin(), bases.end());
  return bases;
}

}  // namespace saltus::switching
