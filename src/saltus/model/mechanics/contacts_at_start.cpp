#include "saltus/model/mechanics/contacts_at_start.hpp"

#include <cmath>
#include <numeric>

#include <casadi/core/function.hpp>
#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/model/system.hpp"

namespace saltus::model {
namespace {

using casadi::SX;
using Row = std::vector<double>;

Error error_at_start(const std::string& contact, std::string message, std::string remedy) {
  return {ErrorCode::invalid_model,
          std::move(message),
          std::move(remedy),
          {},
          {fmt::format("in [[contacts]] {}", contact)}};
}

double dot(const Row& a, const Row& b) { return std::inner_product(a.begin(), a.end(), b.begin(), 0.0); }

constexpr double dependent = 1e-12;  ///< of squares of angles

bool have_one_direction(const Row& a, const Row& b) {
  const double sizes = dot(a, a) * dot(b, b), mixed = dot(a, b);
  return sizes > 0.0 && sizes - mixed * mixed <= dependent * sizes;
}

/// The square of the volume that three rows of length 1 with these directions span.
double volume(const std::vector<Row>& rows) {
  const auto cosine = [&](std::size_t i, std::size_t k) {
    return dot(rows[i], rows[k]) / std::sqrt(dot(rows[i], rows[i]) * dot(rows[k], rows[k]));
  };
  const double a = cosine(0, 1), b = cosine(1, 2), c = cosine(2, 0);
  return 1.0 + 2.0 * a * b * c - a * a - b * b - c * c;
}

/// Values of expressions over t, x, p, and cells that depend on nothing else.
std::vector<casadi::DM> values_at_start(const System& system, double from, std::vector<SX> expressions) {
  std::vector<SX> symbols{system.t, system.x, system.p};
  std::vector<casadi::DM> values{from, system.initial_state, system.parameter_values};
  for (const auto& cell : system.cells) {
    const casadi::Function argument("saltus_cell_at_start", symbols, {cell.argument}, {{"allow_free", true}});
    if (argument.has_free()) continue;
    const double place = static_cast<double>(argument(values)[0]);
    std::vector<double> constants;
    for (int k = 0; k < cell.table->columns; ++k) constants.push_back(cell.table->constant(cell.table->cell(place), k));
    symbols.push_back(cell.symbols);
    values.emplace_back(constants);
  }
  return casadi::Function("saltus_contacts_at_start", symbols, expressions)(values);
}

}  // namespace

std::optional<Error> check_gap_at_start(const std::string& contact, double gap, const std::string& when) {
  constexpr double rounding = 1e-12;
  if (!std::isfinite(gap)) {
    return error_at_start(contact,
                          fmt::format("the gap of '{}' is {} at the start{}", contact,
                                      std::isnan(gap) ? "not a number" : "infinite", when),
                          "its expression has no value at the initial positions (a division by 0, a root of a negative "
                          "number): change them, or the expression");
  }
  if (gap >= -rounding) return std::nullopt;
  return error_at_start(contact, fmt::format("the gap of '{}' is {} at the start{}", contact, gap, when),
                        "bodies begin apart or in touch: the gap must not be negative; change the initial positions");
}

std::optional<Error> check_tangents_at_start(const std::string& contact, const std::vector<Row>& rows,
                                             const std::string& when) {
  const auto refused = [&](const std::string& message, std::string remedy) {
    return error_at_start(contact, fmt::format(fmt::runtime(message + " at the start{}"), contact, when),
                          std::move(remedy));
  };
  for (std::size_t k = 1; k < rows.size(); ++k) {
    const double size = dot(rows[k], rows[k]);
    if (!std::isfinite(size)) {
      return refused("the tangent of '{}' is not finite",
                     "its expressions have no value at the initial positions: change them, or the expressions");
    }
    if (size == 0.0) {
      return refused("the tangent of '{}' is 0", "write the direction in which it slips, as tangent = { x = 1 }");
    }
    if (have_one_direction(rows[k], rows[0])) {
      return refused("the tangent of '{}' has the direction in which its gap opens",
                     "a tangent lies along the surface: of a floor z = 0 it is { x = 1 }, not { z = 1 }");
    }
  }
  if (rows.size() < 3) return std::nullopt;
  if (have_one_direction(rows[1], rows[2])) {
    return refused("the tangents of '{}' have one direction",
                   "two tangents span the plane in which the contact slips; in one direction one is enough");
  }
  // A gap without a slope at the start has no direction.
  if (!(volume(rows) <= dependent)) return std::nullopt;
  return refused("the plane of the tangents of '{}' has the direction in which its gap opens",
                 "tangents lie along the surface: of a floor z = 0 they are { x = 1 } and { y = 1 }");
}

std::optional<Error> check_contacts_at_start(const System& system, double from) {
  const auto& contacts = system.contacts;
  if (contacts.empty() || !SX::depends_on(SX::vertcat({contacts.gap, SX::vec(contacts.rows)}), system.t))
    return std::nullopt;
  const auto values = values_at_start(system, from, {contacts.gap, contacts.rows});
  const std::string when = fmt::format(", t = {}", from);
  const auto m = static_cast<casadi_int>(contacts.contacts.size());
  for (casadi_int i = 0; i < m; ++i) {
    const auto& contact = contacts.contacts[at(i)];
    if (SX::depends_on(contacts.gap(i), system.t)) {
      if (auto error = check_gap_at_start(contact.name, static_cast<double>(values[0](i)), when)) return error;
    }
    if (!contact.has_gap || !contact.has_friction) continue;
    std::vector<Row> rows;
    bool moves = false;
    for (casadi_int row = i; row <= contact.tangents() * m + i; row += m) {
      moves = moves || SX::depends_on(contacts.rows(row, casadi::Slice()), system.t);
      rows.push_back(casadi::DM::densify(values[1](row, casadi::Slice())).nonzeros());
    }
    if (!moves) continue;
    if (auto error = check_tangents_at_start(contact.name, rows, when)) return error;
  }
  return std::nullopt;
}

}  // namespace saltus::model
