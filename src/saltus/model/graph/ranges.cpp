#include "saltus/model/graph/ranges.hpp"

#include <limits>

#include "saltus/model/graph/interpret.hpp"

namespace saltus::model {
namespace {

using casadi::SXElem;

Range product(const Range& a, const Range& b) {
  return {a.middle * b.middle, fabs(a.middle) * b.radius + (fabs(b.middle) + b.radius) * a.radius};
}

/// Nothing where b may be 0: its least size is then 0.
Range quotient(const Range& a, const Range& b) {
  const SXElem middle = a.middle / b.middle, size = fabs(b.middle);
  if (b.radius.is_zero()) return {middle, a.radius / size};
  const SXElem distance = size - b.radius, least = 0.5 * (distance + fabs(distance));
  return {middle, (a.radius + fabs(middle) * b.radius) / least};
}

/// What the operation makes of operands of which one varies.
Range operated_range(casadi_int operation, const Range& a, const Range& b) {
  const SXElem middle = operated(operation, a.middle, b.middle);
  switch (operation) {
    case casadi::OP_ASSIGN:
    case casadi::OP_NEG:
    case casadi::OP_FABS:
    case casadi::OP_ATAN:
    case casadi::OP_TANH:
    case casadi::OP_SIN:
    case casadi::OP_COS:
      return {middle, a.radius};
    case casadi::OP_ADD:
    case casadi::OP_SUB:
    case casadi::OP_FMIN:
    case casadi::OP_FMAX:
      return {middle, a.radius + b.radius};
    case casadi::OP_TWICE:
      return {middle, 2.0 * a.radius};
    case casadi::OP_SQ:
      return {middle, (2.0 * fabs(a.middle) + a.radius) * a.radius};
    case casadi::OP_MUL:
      return product(a, b);
    case casadi::OP_DIV:
      return quotient(a, b);
    case casadi::OP_INV:
      return quotient({1.0}, a);
    case casadi::OP_SQRT:  // not a number where an operand may be negative
      return {middle, a.radius / (middle + sqrt(a.middle - a.radius))};
    case casadi::OP_EXP:
      return {middle, middle * expm1(a.radius)};
    default:
      return {middle, std::numeric_limits<double>::infinity()};
  }
}

}  // namespace

std::vector<Range> ranges(const casadi::Function& function, FunctionRef<Range(casadi_int, casadi_int)> input) {
  return interpret<Range>(function, input, [](casadi_int, casadi_int operation, const Range& a, const Range& b) {
    const bool varies = !a.radius.is_zero() || !b.radius.is_zero();
    return varies ? operated_range(operation, a, b) : Range{operated(operation, a.middle, b.middle)};
  });
}

}  // namespace saltus::model
