// Nodes of the interpolatory quadratures of highest order on [0, 1].
#pragma once

#include <vector>

namespace saltus::discretization {

/// Returns n nodes, ascending, correct to the rounding of long double: Gauss (n >= 1, degree 2n - 1), Radau with the
/// right end (n >= 1, degree 2n - 2), Lobatto with both ends (n >= 2, degree 2n - 3).
[[nodiscard]] std::vector<long double> gauss_nodes(int n);
[[nodiscard]] std::vector<long double> radau_nodes(int n);
[[nodiscard]] std::vector<long double> lobatto_nodes(int n);

/// Returns the integral from 0 to x of the polynomial that is 1 at nodes[j] and 0 at the others.
[[nodiscard]] long double integral_of_lagrange(const std::vector<long double>& nodes, int j, long double x);
/// Returns its value at x.
[[nodiscard]] long double lagrange(const std::vector<long double>& nodes, int j, long double x);

}  // namespace saltus::discretization
