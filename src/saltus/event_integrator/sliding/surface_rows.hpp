// The gradients of the surfaces that are slid on, J, and what moves or corrects along them.
#pragma once

#include <cstddef>
#include <vector>

#include "saltus/base/at.hpp"
#include "saltus/event_integrator/sliding/normal_rows.hpp"
#include "saltus/linalg/factors.hpp"
#include "saltus/linalg/matrix.hpp"

namespace saltus::event_integrator {

/// Solves the normal equations of rows of which some depend on others, for those that do not.
class IndependentRows {
 public:
  std::vector<linalg::Index> rows;  ///< ascending; empty = all

  /// Sets residual = (J J^T)^-1 residual of these rows of J, 0 of the others; false where they depend on each other.
  [[nodiscard]] bool solve(const NormalRows& gradients, std::size_t columns, linalg::Vector& residual);

 private:
  NormalRows part_;
  linalg::Vector part_residual_;
};

/// Holds J by rows, d psi_I/dt beside it; gradients that no mode changes are kept.
class SurfaceRows {
 public:
  explicit SurfaceRows(std::size_t surfaces) : known_(surfaces) {}

  NormalRows normal;
  linalg::Matrix dense;           ///< m x n_x where it is asked for
  linalg::Vector rates;           ///< d psi_I/dt
  linalg::Vector residual;        ///< of the normal equations
  double square = 0.0;            ///< |J|^2 of one row
  std::vector<bool> is_constant;  ///< in this mode
  std::size_t varying = 0;        ///< rows that are not
  std::vector<int> coordinate;    ///< the only nonzero column of a row, or -1
  std::vector<double> factor;     ///< of that column
  IndependentRows independent;

  void resize(std::size_t m, std::size_t states, bool with_dense);
  /// Takes a gradient that was the same in all modes so far.
  [[nodiscard]] bool take_known(std::size_t row, std::size_t surface);
  /// Takes a gradient; with `keep` it is known from now on.
  void take(std::size_t row, std::size_t surface, const std::vector<double>& gradient, bool constant, bool keep);
  /// Returns grad psi . f + d psi/dt.
  [[nodiscard]] double velocity(std::size_t row, const std::vector<double>& f) const {
    const auto r = static_cast<linalg::Index>(row);
    if (const int only = coordinate[row]; only >= 0) return factor[row] * f[at(only)] + rates[r];
    return normal[row].dot(f, rates[r]);
  }
  /// Sets residual = (J J^T)^-1 residual; false where rows depend on each other.
  [[nodiscard]] bool solve_normal_equations();

 private:
  void note(std::size_t row, bool constant);
  struct KnownRow {
    bool known = false;
    SparseRow row = {};
    double rate = 0.0;
    double size = 0.0;
  };
  std::vector<KnownRow> known_;  ///< by surface
};

}  // namespace saltus::event_integrator
