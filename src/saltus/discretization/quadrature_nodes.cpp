#include <cmath>
#include <cstddef>
#include <numbers>

#include "saltus/base/at.hpp"
#include "saltus/discretization/quadrature_nodes_internal.hpp"

namespace saltus::discretization {
namespace {

/// P_n and P_n' on [-1, 1].
struct Legendre {
  long double value = 1.0L;
  long double derivative = 0.0L;
};

/// Three-term recurrence; P_n' = P_(n-2)' + (2n - 1) P_(n-1), which stays exact at the ends.
Legendre legendre(int n, long double x) {
  Legendre before{0.0L, 0.0L};
  Legendre at{1.0L, 0.0L};
  for (int k = 1; k <= n; ++k) {
    const auto degree = static_cast<long double>(k);
    const Legendre next{((2 * degree - 1) * x * at.value - (degree - 1) * before.value) / degree,
                        before.derivative + (2 * degree - 1) * at.value};
    before = at;
    at = next;
  }
  return at;
}

/// The root of a function with simple roots nearest to x: Newton's method until it no longer moves.
template <class F>
long double root_near(long double x, F&& value_and_derivative) {
  for (int k = 0; k < 100; ++k) {
    const Legendre f = value_and_derivative(x);
    const long double next = x - f.value / f.derivative;
    if (std::abs(next - x) <= 1e-19L) return next;
    x = next;
  }
  return x;
}

long double to_unit_interval(long double x) { return 0.5L * (1.0L + x); }

constexpr long double pi = std::numbers::pi_v<long double>;

}  // namespace

std::vector<long double> gauss_nodes(int n) {
  std::vector<long double> nodes;
  for (int k = n; k >= 1; --k) {
    const long double guess = std::cos(pi * (k - 0.25L) / (n + 0.5L));
    nodes.push_back(to_unit_interval(root_near(guess, [n](long double x) { return legendre(n, x); })));
  }
  return nodes;
}

/// The roots of P_n - P_(n-1), one of which is 1.
std::vector<long double> radau_nodes(int n) {
  const auto f = [n](long double x) {
    const Legendre high = legendre(n, x);
    const Legendre low = legendre(n - 1, x);
    // Without the known root 1, where both the value and the derivative of the quotient are needed.
    const long double quotient = (high.value - low.value) / (x - 1.0L);
    return Legendre{quotient, (high.derivative - low.derivative - quotient) / (x - 1.0L)};
  };
  std::vector<long double> nodes;
  for (int k = n - 1; k >= 1; --k) {
    const long double guess = std::cos(2.0L * pi * k / (2.0L * n - 1.0L));
    nodes.push_back(to_unit_interval(root_near(guess, f)));
  }
  nodes.push_back(1.0L);
  return nodes;
}

/// The ends and the roots of P_(n-1)'.
std::vector<long double> lobatto_nodes(int n) {
  const int degree = n - 1;
  const auto f = [degree](long double x) {
    // (1 - x^2) P'' = 2 x P' - m (m + 1) P.
    const Legendre p = legendre(degree, x);
    return Legendre{p.derivative, (2.0L * x * p.derivative - degree * (degree + 1.0L) * p.value) / (1.0L - x * x)};
  };
  std::vector<long double> nodes{0.0L};
  for (int k = degree - 1; k >= 1; --k) {
    nodes.push_back(to_unit_interval(root_near(std::cos(pi * k / degree), f)));
  }
  nodes.push_back(1.0L);
  return nodes;
}

long double lagrange(const std::vector<long double>& nodes, int j, long double x) {
  long double product = 1.0L;
  const long double own = nodes[at(j)];
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (static_cast<int>(i) != j) product *= (x - nodes[i]) / (own - nodes[i]);
  }
  return product;
}

long double integral_of_lagrange(const std::vector<long double>& nodes, int j, long double x) {
  const int n = static_cast<int>(nodes.size() + 1) / 2;  // exact to degree 2n - 1 >= nodes.size() - 1
  long double sum = 0.0L;
  for (const long double node : gauss_nodes(n)) {
    // Weight of a Gauss node z on [-1, 1]: 2 / ((1 - z^2) P_n'(z)^2); half of it on [0, 1].
    const long double z = 2.0L * node - 1.0L;
    const long double slope = legendre(n, z).derivative;
    sum += lagrange(nodes, j, x * node) / ((1.0L - z * z) * slope * slope);
  }
  return x * sum;
}

}  // namespace saltus::discretization
