// Loops over the entries of views: one run where they are contiguous, one per column elsewhere.
#pragma once

#include "saltus/linalg/views.hpp"

namespace saltus::linalg {

/// f(entry) for each entry, column by column.
template <class Function>
void for_each_entry(ConstView a, const Function& f) {
  const bool flat = a.is_contiguous();
  const Index rows = flat ? a.size() : a.rows(), columns = flat ? 1 : a.cols(), step = flat ? 1 : a.row_step();
  for (Index j = 0; j < columns; ++j) {
    const double* const p = a.data() + j * a.column_step();
    if (step == 1) {
      for (Index i = 0; i < rows; ++i) f(p[i]);
    } else {
      for (Index i = 0; i < rows; ++i) f(p[i * step]);
    }
  }
}

/// f(entry of a, entry of b) for each place of two views of one shape; entries of a can be written.
template <class Function>
void for_each_pair(View a, ConstView b, const Function& f) {
  const bool flat = a.is_contiguous() && b.is_contiguous();
  const Index rows = flat ? a.size() : a.rows(), columns = flat ? 1 : a.cols();
  const Index own = flat ? 1 : a.row_step(), other = flat ? 1 : b.row_step();
  for (Index j = 0; j < columns; ++j) {
    double* const p = a.data() + j * a.column_step();
    const double* const q = b.data() + j * b.column_step();
    if (own == 1 && other == 1) {
      for (Index i = 0; i < rows; ++i) f(p[i], q[i]);
    } else {
      for (Index i = 0; i < rows; ++i) f(p[i * own], q[i * other]);
    }
  }
}

}  // namespace saltus::linalg
