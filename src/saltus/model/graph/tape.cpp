#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include <casadi/core/sx_elem.hpp>

// Needs names that only the header above brings.
#include <casadi/core/calculus.hpp>

#include "saltus/base/at.hpp"
#include "saltus/base/contracts.hpp"
#include "saltus/model/graph/finite_operations.hpp"
#include "saltus/model/graph/tape_internal.hpp"

namespace saltus::model {
namespace {

/// Operations that make polynomials of polynomials; the comparisons are those of selections in guarded branches.
bool is_polynomial_operation(int operation) {
  switch (operation) {
    case casadi::OP_CONST:
    case casadi::OP_PARAMETER:
    case casadi::OP_ADD:
    case casadi::OP_SUB:
    case casadi::OP_MUL:
    case casadi::OP_NEG:
    case casadi::OP_SQ:
    case casadi::OP_TWICE:
    case casadi::OP_NE:
    case casadi::OP_EQ:
    case casadi::OP_IF_ELSE_ZERO:
      return true;
    default:
      return false;
  }
}

std::uint64_t hash_of(const TapeNode& node) {
  constexpr std::uint64_t a = 0x9e3779b97f4a7c15, b = 0xbf58476d1ce4e5b9, c = 0x94d049bb133111eb;
  const std::uint64_t hash =
      (static_cast<std::uint64_t>(node.operation) * a) ^ (static_cast<std::uint64_t>(node.left + 2) * b) ^
      (static_cast<std::uint64_t>(node.right + 2) * c) ^ (std::bit_cast<std::uint64_t>(node.constant) * a);
  return hash ^ (hash >> 29U);
}

bool same_operation(const TapeNode& a, const TapeNode& b) {
  return a.operation == b.operation && a.left == b.left && a.right == b.right && a.variable < 0 && b.variable < 0 &&
         std::bit_cast<std::uint64_t>(a.constant) == std::bit_cast<std::uint64_t>(b.constant);
}

double operand(const TapeValues& values, int node) { return node < 0 ? 0.0 : values.value[at(node)]; }

double leaf_value(const TapeNode& node, const Point& point, const TapeValues& values) {
  if (node.variable < 0) return node.constant;
  const double given = point[at(node.variable)];
  return node.psi >= 0 && std::isnan(given) ? step_value(operand(values, node.psi)) : given;
}

bool is_leaf(const TapeNode& node) {
  return node.operation == casadi::OP_CONST || node.operation == casadi::OP_PARAMETER;
}

/// The constant of a cell that the point holds; NaN where it is to be looked up.
double held_constant(const TapeNode& node, const Point& point) {
  if (node.operation != cell_operation) return std::numeric_limits<double>::quiet_NaN();
  return point[at(node.variable)];
}

/// |d| b. A derivative that does not exist (of a negative base with respect to the exponent) has no share.
double share(double derivative, double bound) {
  return bound == 0.0 || std::isnan(derivative) ? 0.0 : std::abs(derivative) * bound;
}

}  // namespace

int Tape::append(TapeNode node) {
  if (node.variable < 0) {
    make_room();
    std::size_t place = hash_of(node) & (places_.size() - 1);
    while (places_[place] >= 0) {
      if (same_operation((*this)[places_[place]], node)) return places_[place];
      place = (place + 1) & (places_.size() - 1);
    }
    places_[place] = size();
  }
  node.number = size();
  set_kinds(node);
  nodes_.push_back(node);
  return size() - 1;
}

/// Keeps half of the places free, so that few are looked at.
void Tape::make_room() {
  if (2 * at(size() + 1) <= places_.size()) return;
  places_.assign(std::bit_ceil(4 * at(size() + 1)), -1);
  for (int number = 0; number < size(); ++number) {
    if ((*this)[number].variable >= 0) continue;
    std::size_t place = hash_of((*this)[number]) & (places_.size() - 1);
    while (places_[place] >= 0) place = (place + 1) & (places_.size() - 1);
    places_[place] = number;
  }
}

int Tape::constant(double value) {
  return append({.operation = casadi::OP_CONST, .constant = value, .may_be_nonfinite = !std::isfinite(value)});
}

int Tape::variable(const Variable& variable) {
  SALTUS_ASSERT(variable.kind != VariableKind::alpha);
  variables_.push_back(variable);
  variables_.back().number = static_cast<int>(variables_.size()) - 1;
  return append({.operation = casadi::OP_PARAMETER, .variable = static_cast<int>(variables_.size()) - 1});
}

int Tape::alpha(int index, int psi) {
  const auto number = static_cast<int>(variables_.size());
  variables_.push_back({VariableKind::alpha, index, std::numeric_limits<double>::quiet_NaN(), number});
  return append({.operation = casadi::OP_PARAMETER, .variable = static_cast<int>(variables_.size()) - 1, .psi = psi});
}

int Tape::operation(int operation, int left, int right) {
  TapeNode node{.operation = operation, .left = left, .right = right};
  node.may_be_nonfinite = !stays_finite(operation);
  for (const int child : {left, right}) {
    if (child < 0) continue;
    node.may_be_nonfinite = node.may_be_nonfinite || (*this)[child].may_be_nonfinite;
  }
  return append(node);
}

int Tape::cell(int argument, const std::shared_ptr<const CellTable>& table, int column) {
  const TapeNode& operand = (*this)[argument];
  const auto index = static_cast<int>(cells_.size());
  cells_.push_back({table, column});
  const auto number = static_cast<int>(variables_.size());
  variables_.push_back({VariableKind::cell, index, std::numeric_limits<double>::quiet_NaN(), number});
  return append({.operation = cell_operation,
                 .left = argument,
                 .variable = static_cast<int>(variables_.size()) - 1,
                 .may_be_nonfinite = operand.may_be_nonfinite});
}

void Tape::set_kinds(TapeNode& node) const {
  node.written = node.reached = 0;
  node.polynomial = true;
  if (node.operation == cell_operation) {
    const auto& [table, column] = cells_[at(variables_[at(node.variable)].index)];
    const TapeNode& operand = (*this)[node.left];
    // A constant that jumps is like a discrete state: it does not move between its jumps.
    const bool jumps = table->change == CellTable::Change::jump && (operand.reached & changing_kinds) != 0;
    node.written = jumps ? kind_bit(VariableKind::cell) : operand.written;
    node.reached = jumps ? kind_bit(VariableKind::cell) : operand.reached;
    node.polynomial = (node.written & changing_kinds) == 0;
    return;
  }
  if (node.variable >= 0) node.written = node.reached = kind_bit(variables_[at(node.variable)].kind);
  if (node.psi >= 0) node.reached |= (*this)[node.psi].reached;
  for (const int child : {node.left, node.right}) {
    if (child < 0) continue;
    node.written |= (*this)[child].written;
    node.reached |= (*this)[child].reached;
    node.polynomial = node.polynomial && (*this)[child].polynomial;
  }
  if ((node.written & changing_kinds) == 0) return;
  const bool by_a_constant = node.operation == casadi::OP_DIV && ((*this)[node.right].written & changing_kinds) == 0;
  node.polynomial = node.polynomial && (is_polynomial_operation(node.operation) || by_a_constant);
}

void Tape::restate_as_state(int variable, int index) {
  variables_[at(variable)].kind = VariableKind::state;
  variables_[at(variable)].index = index;
  for (TapeNode& node : nodes_) set_kinds(node);
}

double Tape::operate(const TapeNode& node, double left, double right) const {
  if (node.operation == cell_operation) {
    if (std::isnan(left)) return left;
    const auto& variable = variables_[at(node.variable)];
    const auto& [table, column] = cells_[at(variable.index)];
    return table->constant(table->cell(left), column);
  }
  double value = 0.0;
  casadi::casadi_math<double>::fun(static_cast<unsigned char>(node.operation), left, right, value);
  return value;
}

namespace {

/// Which nodes of a tape a walk has met: a mark for each, used again by the next walk.
class Met {
 public:
  explicit Met(int size) {
    if (marks_.size() < at(size)) marks_.resize(at(size), 0);
    if (++walk_ != 0) return;
    std::fill(marks_.begin(), marks_.end(), 0U);  // the numbers of walks begin anew
    walk_ = 1;
  }
  /// Returns whether this is the first time.
  bool meet(int node) { return std::exchange(marks_[at(node)], walk_) != walk_; }

 private:
  inline static thread_local std::vector<unsigned> marks_;
  inline static thread_local unsigned walk_ = 0;
};

}  // namespace

std::vector<int> Tape::cone(std::span<const int> roots, Links links) const {
  std::vector<int> nodes;
  Met met(size());
  std::vector<int> open(roots.begin(), roots.end());
  while (!open.empty()) {
    const int current = open.back();
    open.pop_back();
    if (current < 0 || !met.meet(current)) continue;
    nodes.push_back(current);
    const TapeNode& node = (*this)[current];
    open.push_back(node.left);
    open.push_back(node.right);
    if (links == Links::through_alpha) open.push_back(node.psi);
  }
  std::sort(nodes.begin(), nodes.end());
  walked_ += nodes.size();
  return nodes;
}

Tape Tape::part(std::span<const int> roots) const {
  Tape result;
  // Links go to smaller numbers of the cone, whose places are written by then; others are never read.
  thread_local std::vector<int> places;
  if (places.size() < at(size())) places.resize(at(size()));
  for (const int number : cone(roots, Links::through_alpha)) {
    TapeNode node = (*this)[number];
    places[at(number)] = result.size();
    for (int* link : {&node.left, &node.right, &node.psi}) {
      if (*link >= 0) *link = places[at(*link)];
    }
    if (node.variable >= 0) {
      Variable variable = variables_[at(node.variable)];
      if (node.operation == cell_operation) {
        result.cells_.push_back(cells_[at(variable.index)]);
        variable.index = static_cast<int>(result.cells_.size()) - 1;
      }
      node.variable = static_cast<int>(result.variables_.size());
      result.variables_.push_back(variable);
    }
    result.nodes_.push_back(node);
  }
  return result;
}

int Tape::place_of(int number) const {
  const auto place = std::lower_bound(nodes_.begin(), nodes_.end(), number,
                                      [](const TapeNode& node, int wanted) { return node.number < wanted; });
  return place != nodes_.end() && place->number == number ? static_cast<int>(place - nodes_.begin()) : -1;
}

void Tape::renumber() {
  for (int place = 0; place < size(); ++place) nodes_[at(place)].number = place;
}

Point blank_point(const Tape& tape) {
  Point point;
  point.reserve(tape.variables().size());
  for (const auto& variable : tape.variables()) {
    switch (variable.kind) {
      case VariableKind::parameter:
        point.push_back(variable.value);
        break;
      case VariableKind::alpha:
      case VariableKind::cell:
        point.push_back(std::numeric_limits<double>::quiet_NaN());
        break;
      case VariableKind::time:
      case VariableKind::state:
      case VariableKind::discrete:
      case VariableKind::control:
      case VariableKind::sampled_control:
      case VariableKind::activity:
      case VariableKind::force:
        point.push_back(0.0);
        break;
    }
  }
  return point;
}

double step_value(double psi) {
  if (std::isnan(psi)) return psi;
  return psi > 0.0 ? 1.0 : (psi < 0.0 ? 0.0 : 0.5);
}

void evaluate(const Tape& tape, std::span<const int> cone, const Point& point, TapeValues& values) {
  values.value.resize(static_cast<std::size_t>(tape.size()));
  for (const int current : cone) {
    const TapeNode& node = tape[current];
    double& value = values.value[at(current)];
    if (is_leaf(node)) {
      value = leaf_value(node, point, values);
    } else if (const double held = held_constant(node, point); !std::isnan(held)) {
      value = held;
    } else {
      value = tape.operate(node, operand(values, node.left), operand(values, node.right));
    }
  }
}

void evaluate_with_bounds(const Tape& tape, std::span<const int> cone, const Point& point,
                          std::span<const double> scale, double local, TapeValues& values) {
  values.value.resize(static_cast<std::size_t>(tape.size()));
  values.bound.resize(static_cast<std::size_t>(tape.size()));
  for (const int current : cone) {
    const TapeNode& node = tape[current];
    double& value = values.value[at(current)];
    double& bound = values.bound[at(current)];
    if (is_leaf(node)) {
      value = leaf_value(node, point, values);
      const bool moves = node.variable >= 0 && !scale.empty() && node.psi < 0;
      bound = node.psi < 0 ? local * std::abs(value) : 0.0;
      if (moves) bound += scale[at(node.variable)];
      continue;
    }
    if (node.operation == cell_operation) {
      const double held = held_constant(node, point);
      value = std::isnan(held) ? tape.operate(node, operand(values, node.left), 0.0) : held;
      bound = local * std::abs(value);
      continue;
    }
    double derivative[2] = {0.0, 0.0};
    casadi::casadi_math<double>::derF(static_cast<unsigned char>(node.operation), operand(values, node.left),
                                      operand(values, node.right), value, derivative);
    bound = share(derivative[0], values.bound[at(node.left)]) + local * std::abs(value);
    if (node.right >= 0) bound += share(derivative[1], values.bound[at(node.right)]);
  }
}

std::vector<double> gradient(const Tape& tape, const TapeValues& values, int root) {
  std::vector<double> result(tape.variables().size(), 0.0);
  const auto cone = tape.cone(std::span(&root, 1), Links::written);
  std::unordered_map<int, double> adjoint{{root, 1.0}};
  for (auto it = cone.rbegin(); it != cone.rend(); ++it) {
    const TapeNode& node = tape[*it];
    const double seed = adjoint[*it];
    if (is_leaf(node)) {
      if (node.variable >= 0) result[at(node.variable)] = seed;
      continue;
    }
    if (node.operation == cell_operation) continue;  // constant where it has a derivative
    if (seed == 0.0) continue;                       // 0 times an infinite slope of a branch not taken must stay 0
    double derivative[2] = {0.0, 0.0};
    casadi::casadi_math<double>::der(static_cast<unsigned char>(node.operation), operand(values, node.left),
                                     operand(values, node.right), values.value[at(*it)], derivative);
    adjoint[node.left] += seed * derivative[0];
    if (node.right >= 0) adjoint[node.right] += seed * derivative[1];
  }
  return result;
}

}  // namespace saltus::model
