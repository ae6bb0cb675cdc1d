#include "saltus/discretization/butcher_tableau.hpp"

#include <cstddef>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/discretization/quadrature_nodes_internal.hpp"

namespace saltus::discretization {
namespace {

struct FamilyFacts {
  TableauFamily family;
  std::string_view name;
  int fewest, most;
};

constexpr FamilyFacts families[] = {
    {TableauFamily::radau_iia, "radau_iia", 1, 9},       {TableauFamily::gauss_legendre, "gauss_legendre", 1, 9},
    {TableauFamily::lobatto_iiia, "lobatto_iiia", 2, 5}, {TableauFamily::lobatto_iiic, "lobatto_iiic", 2, 5},
    {TableauFamily::explicit_rk, "explicit", 1, 4},
};

const FamilyFacts& facts(TableauFamily family) { return families[static_cast<std::size_t>(family)]; }

using Nodes = std::vector<long double>;

linalg::Index index(int i) { return static_cast<linalg::Index>(i); }

/// a_ij = integral of the j-th Lagrange polynomial from 0 to c_i, b_j to 1.
ButcherTableau collocation(const Nodes& nodes) {
  const auto s = static_cast<linalg::Index>(nodes.size());
  ButcherTableau tableau{.A = linalg::Matrix(s, s), .b = linalg::Vector(s), .c = linalg::Vector(s)};
  for (int j = 0; j < static_cast<int>(s); ++j) {
    const auto integral = [&](long double x) { return static_cast<double>(integral_of_lagrange(nodes, j, x)); };
    for (int i = 0; i < static_cast<int>(s); ++i) {
      tableau.A(index(i), index(j)) = integral(nodes[at(i)]);
    }
    tableau.b[index(j)] = integral(1.0L);
    tableau.c[index(j)] = static_cast<double>(nodes[at(j)]);
  }
  return tableau;
}

/// a_i1 = b_1, and the others such that polynomials of degree s - 2 are integrated exactly: on the Lagrange polynomials
/// l_j of the nodes 2 to s that is a_ij = (integral of l_j from 0 to c_i) - b_1 l_j(0).
ButcherTableau lobatto_iiic(int stages) {
  const Nodes nodes = lobatto_nodes(stages);
  ButcherTableau tableau = collocation(nodes);
  const Nodes others(nodes.begin() + 1, nodes.end());
  const long double first = integral_of_lagrange(nodes, 0, 1.0L);
  for (int i = 0; i < stages; ++i) {
    tableau.A(index(i), 0) = static_cast<double>(first);
    for (int j = 1; j < stages; ++j) {
      const long double integral = integral_of_lagrange(others, j - 1, nodes[at(i)]);
      tableau.A(index(i), index(j)) = static_cast<double>(integral - first * lagrange(others, j - 1, 0.0L));
    }
  }
  tableau.A.row(stages - 1) = tableau.b;  // equal but for rounding
  return tableau;
}

ButcherTableau explicit_rk(int stages) {
  const linalg::Index s = stages;
  ButcherTableau tableau{.A = linalg::Matrix::zero(s, s), .b = linalg::Vector(s), .c = linalg::Vector(s)};
  switch (stages) {
    case 1:
      tableau.b = linalg::Vector{1.0};
      break;
    case 2:
      tableau.A(1, 0) = 0.5;
      tableau.b = linalg::Vector{0.0, 1.0};
      break;
    case 3:
      tableau.A(1, 0) = 0.5;
      tableau.A.row(2) = linalg::Vector{-1.0, 2.0, 0.0};
      tableau.b = linalg::Vector{1.0 / 6.0, 2.0 / 3.0, 1.0 / 6.0};
      break;
    default:
      tableau.A(1, 0) = tableau.A(2, 1) = 0.5;
      tableau.A(3, 2) = 1.0;
      tableau.b = linalg::Vector{1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0};
  }
  tableau.c = tableau.A.row_sums();
  return tableau;
}

}  // namespace

std::string_view name(TableauFamily family) { return facts(family).name; }

bool ButcherTableau::ends_at_last_stage() const {
  const linalg::Index last = b.size() - 1;
  return c[last] == 1.0 && A.row(last).transpose() == b;
}

bool ButcherTableau::is_collocation() const {
  return family == TableauFamily::radau_iia || family == TableauFamily::gauss_legendre ||
         family == TableauFamily::lobatto_iiia;
}

Expected<ButcherTableau> butcher_tableau(TableauFamily family, int stages) {
  const auto& [id, text, fewest, most] = facts(family);
  if (stages < fewest || stages > most) {
    Error error;
    error.code = ErrorCode::invalid_option;
    error.message = fmt::format("{} has {} to {} stages, not {}", text, fewest, most, stages);
    error.remedy = fmt::format("set `stages` to a number from {} to {}", fewest, most);
    return tl::unexpected(std::move(error));
  }
  ButcherTableau tableau;
  int order = 0;
  switch (family) {
    case TableauFamily::radau_iia:
      tableau = collocation(radau_nodes(stages));
      order = 2 * stages - 1;
      break;
    case TableauFamily::gauss_legendre:
      tableau = collocation(gauss_nodes(stages));
      order = 2 * stages;
      break;
    case TableauFamily::lobatto_iiia:
      tableau = collocation(lobatto_nodes(stages));
      order = 2 * stages - 2;
      break;
    case TableauFamily::lobatto_iiic:
      tableau = lobatto_iiic(stages);
      order = 2 * stages - 2;
      break;
    case TableauFamily::explicit_rk:
      tableau = explicit_rk(stages);
      order = stages;
      break;
  }
  tableau.family = family;
  tableau.order = order;
  return tableau;
}

}  // namespace saltus::discretization
