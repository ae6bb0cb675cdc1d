// Loops over the entries of views: one run where they are contiguous, one per column elsewhere; sums.
#pragma once

#include "saltus/linalg/views.hpp"

namespace saltus::linalg {

/// Sum of term(k) for k below n; four sums at a time, so that one need not wait for the last.
template <class Term>
double sum_of(Index n, const Term& term) {
  double part[4] = {0.0, 0.0, 0.0, 0.0};
  Index i = 0;
  for (; i + 4 <= n; i += 4) {
    for (Index k = 0; k < 4; ++k) part[k] += term(i + k);
  }
  for (; i < n; ++i) part[0] += term(i);
  return (part[0] + part[1]) + (part[2] + part[3]);
}

/// Sum of p[k own] q[k other] for k below n.
inline double dot_of(Index n, const double* p, Index own, const double* q, Index other) {
  if (n < 4) {
    double total = 0.0;
    for (Index i = 0; i < n; ++i) total += p[i * own] * q[i * other];
    return total;
  }
  if (own == 1 && other == 1) return sum_of(n, [&](Index i) { return p[i] * q[i]; });
  return sum_of(n, [&](Index i) { return p[i * own] * q[i * other]; });
}

/// f(entry) for each entry, column by column.
template <class Function>
void for_each_entry(ConstView a, const Function& f) {
  if (a.cols() == 1 && a.row_step() == 1) {  // most are short vectors
    const double* const p = a.data();
    for (Index i = 0; i < a.rows(); ++i) f(p[i]);
    return;
  }
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
  if (a.cols() == 1 && a.row_step() == 1 && b.row_step() == 1) {  // most are short vectors
    double* const p = a.data();
    const double* const q = b.data();
    for (Index i = 0; i < a.rows(); ++i) f(p[i], q[i]);
    return;
  }
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
