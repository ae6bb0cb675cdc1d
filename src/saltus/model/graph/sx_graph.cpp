#include <optional>

#include "saltus/base/at.hpp"
#include "saltus/base/contracts.hpp"
#include "saltus/model/graph/sx_graph_internal.hpp"

namespace saltus::model {
namespace {

/// What to use instead of a nonsmooth CasADi operation; empty for smooth ones.
std::string builder_function_for(int operation) {
  switch (operation) {
    case casadi::OP_SIGN:
      return "sign";
    case casadi::OP_FABS:
      return "abs";
    case casadi::OP_FMIN:
      return "min";
    case casadi::OP_FMAX:
      return "max";
    case casadi::OP_COPYSIGN:
      return "abs and sign";
    case casadi::OP_LT:
    case casadi::OP_LE:
    case casadi::OP_EQ:
    case casadi::OP_NE:
    case casadi::OP_NOT:
    case casadi::OP_AND:
    case casadi::OP_OR:
    case casadi::OP_IF_ELSE_ZERO:
      return "if_ (with greater, less, &&, ||, !) or step";
    case casadi::OP_FLOOR:
    case casadi::OP_CEIL:
    case casadi::OP_FMOD:
    case casadi::OP_REMAINDER:
      return "floor and mod";
    default:
      return "";
  }
}

/// The guard of a blend: selection != 0 or selection != 1, which only this module writes.
bool is_blend_guard(const Tape& tape, int node) {
  return tape[node].operation == casadi::OP_NE && tape[node].written == kind_bit(VariableKind::alpha);
}

bool is_ours(const Tape& tape, int operation, int left, int right) {
  if (operation == casadi::OP_IF_ELSE_ZERO) return is_blend_guard(tape, left);
  if (operation != casadi::OP_NE) return false;
  return (tape[left].written | tape[right].written) == kind_bit(VariableKind::alpha);
}

Error foreign_symbol(const std::string& name) {
  return {ErrorCode::unknown_name,
          "the symbol '" + name + "' was not made by this builder",
          "use the symbols that state, parameter, control and time return",
          {},
          {}};
}

Error nonsmooth_operation(const std::string& text, const std::string& instead) {
  return {ErrorCode::invalid_model,
          "a nonsmooth CasADi operation in an expression: " + text.substr(0, 80),
          "its switch would stay unseen; use the builder's " + instead,
          {},
          {}};
}

}  // namespace

SXElem with_operands(const SXElem& expression, const KnownExpressions& known) {
  if (expression.is_constant() || expression.is_symbolic()) return expression;
  std::vector<SXElem> operands;
  bool same = true;
  for (casadi_int i = 0; i < expression.n_dep(); ++i) {
    operands.push_back(known.at(expression.dep(i).get()));
    same = same && operands.back().get() == expression.dep(i).get();
  }
  if (same) return expression;
  const auto operation = static_cast<int>(expression.op());
  return operands.size() == 1 ? SXElem::unary(operation, operands[0])
                              : SXElem::binary(operation, operands[0], operands[1]);
}

int SxGraph::remember(const SXElem& expression, int node) {
  if (static_cast<std::size_t>(node) == expressions_.size()) expressions_.push_back(expression);
  if (numbers_.emplace(expression.get(), node).second) keep_alive_.push_back(expression);
  return node;
}

SXElem SxGraph::symbol(const std::string& name, const Variable& variable) {
  SXElem result = SXElem::sym(name);
  remember(result, tape_.variable(variable));
  return result;
}

SXElem SxGraph::alpha_symbol(const std::string& name, int index, int psi) {
  SXElem result = SXElem::sym(name);
  remember(result, tape_.alpha(index, psi));
  return result;
}

const CellUse& SxGraph::cell(const SXElem& argument, const std::shared_ptr<const CellTable>& table,
                             const std::string& name) {
  const int node = this->node(argument);
  for (const auto& known : cells_) {
    if (known.table == table && tape_[known.nodes.front()].left == node) return known;
  }
  CellUse use{.name = name, .argument = argument, .symbols = {}, .nodes = {}, .table = table};
  for (int column = 0; column < table->columns; ++column) {
    use.nodes.push_back(tape_.cell(node, table, column));
    use.symbols.push_back(SXElem::sym(name + "_" + std::to_string(column)));
    remember(use.symbols.back(), use.nodes.back());
  }
  cells_.push_back(std::move(use));
  return cells_.back();
}

Expected<int> SxGraph::add_one(const SXElem& expression) {
  if (expression.is_constant()) return remember(expression, tape_.constant(static_cast<double>(expression)));
  if (expression.is_symbolic()) return tl::unexpected(foreign_symbol(expression.name()));
  if (expression.is_call() || expression.is_output()) {
    return tl::unexpected(Error{ErrorCode::invalid_model,
                                "a CasADi function call inside an SX expression",
                                "expand the function first (Function::expand)",
                                {},
                                {}});
  }
  const auto operation = static_cast<int>(expression.op());
  const int left = numbers_.at(expression.dep(0).get());
  if (operation == casadi::OP_ASSIGN) return remember(expression, left);
  const int right = expression.n_dep() == 2 ? numbers_.at(expression.dep(1).get()) : -1;
  if (const auto instead = builder_function_for(operation);
      !instead.empty() && !is_ours(tape_, operation, left, right)) {
    return tl::unexpected(nonsmooth_operation(casadi::SX(expression).get_str(), instead));
  }
  return remember(expression, tape_.operation(operation, left, right));
}

Expected<int> SxGraph::add(const SXElem& expression) {
  // Explicit stack: a sum of 10^5 terms is 10^5 levels deep.
  std::vector<SXElem> open{expression};
  while (!open.empty()) {
    const SXElem current = open.back();
    if (numbers_.contains(current.get())) {
      open.pop_back();
      continue;
    }
    bool ready = true;
    const bool leaf = current.is_constant() || current.is_symbolic() || current.is_call() || current.is_output();
    for (casadi_int i = 0; !leaf && i < current.n_dep(); ++i) {
      if (numbers_.contains(current.dep(i).get())) continue;
      open.push_back(current.dep(i));
      ready = false;
    }
    if (!ready) continue;
    if (auto added = add_one(current); !added) return added;
    open.pop_back();
  }
  return numbers_.at(expression.get());
}

int SxGraph::node(const SXElem& expression) {
  const auto added = add(expression);
  SALTUS_ASSERT(added.has_value());
  return *added;
}

SXElem SxGraph::marked(const SXElem& expression) {
  const SXElem mark = SXElem::unary(casadi::OP_ASSIGN, expression);
  remember(mark, node(expression));
  has_marks_ = true;
  return mark;
}

void SxGraph::drop_marks(casadi::SX& expressions, KnownExpressions& known) const {
  if (!has_marks_) return;
  for (SXElem& expression : expressions.nonzeros()) {
    std::vector<SXElem> open{expression};
    while (!open.empty()) {
      const SXElem current = open.back();
      const auto before = open.size();
      const bool leaf = current.is_constant() || current.is_symbolic();
      for (casadi_int i = 0; !leaf && !known.contains(current.get()) && i < current.n_dep(); ++i) {
        if (!known.contains(current.dep(i).get())) open.push_back(current.dep(i));
      }
      if (open.size() > before) continue;
      open.pop_back();
      const bool mark = !leaf && current.op() == casadi::OP_ASSIGN;
      known.emplace(current.get(), mark ? known.at(current.dep(0).get()) : with_operands(current, known));
    }
    expression = known.at(expression.get());
  }
}

SXElem SxGraph::with_alphas(int root, const std::map<int, double>& fixed) {
  std::unordered_map<int, SXElem> rebuilt;
  for (const int current : tape_.cone(std::span(&root, 1), Links::written)) {
    const TapeNode& node = tape_[current];
    if (const auto it = fixed.find(current); it != fixed.end()) {
      rebuilt.emplace(current, SXElem(it->second));
    } else if (node.left < 0 || node.operation == cell_operation) {
      rebuilt.emplace(current, expression(current));  // arguments of cells are free of alphas
    } else if (node.operation == casadi::OP_IF_ELSE_ZERO && rebuilt.at(node.left).is_one()) {
      rebuilt.emplace(current, rebuilt.at(node.right));  // an open guard, which CasADi would leave standing
    } else if (node.right < 0) {
      rebuilt.emplace(current, SXElem::unary(node.operation, rebuilt.at(node.left)));
    } else {
      rebuilt.emplace(current, SXElem::binary(node.operation, rebuilt.at(node.left), rebuilt.at(node.right)));
    }
  }
  return rebuilt.at(root);
}

SXElem SxGraph::weighted(const SXElem& weight, const SXElem& branch) {
  if (weight.is_zero() || branch.is_zero()) return SXElem(0.0);
  if (weight.is_one()) return branch;
  if (!tape_[node(branch)].may_be_nonfinite) return weight * branch;
  const SXElem taken = SXElem::binary(casadi::OP_NE, weight, SXElem(0.0));
  return SXElem::binary(casadi::OP_IF_ELSE_ZERO, taken, weight * branch);
}

SXElem SxGraph::blend(const SXElem& c, const SXElem& a, const SXElem& b) {
  if (c.is_one() || node(a) == node(b)) return a;
  if (c.is_zero()) return b;
  return weighted(c, a) + weighted(1.0 - c, b);
}

SXElem SxGraph::polynomial(const TruthDiagram& diagram, Truth truth, const std::vector<SXElem>& literals) {
  std::map<Truth, SXElem> values{{TruthDiagram::constant_false(), SXElem(0.0)},
                                 {TruthDiagram::constant_true(), SXElem(1.0)}};
  // Children have smaller numbers than their parents, so one ascending pass over the nodes below `truth` is enough.
  std::vector<Truth> open{truth};
  std::map<Truth, bool> below;
  while (!open.empty()) {
    const Truth current = open.back();
    open.pop_back();
    if (current <= 1 || !below.emplace(current, true).second) continue;
    open.push_back(diagram[current].low);
    open.push_back(diagram[current].high);
  }
  for (const auto& [current, unused] : below) {
    const auto& [literal, low, high] = diagram[current];
    const SXElem& alpha = literals[at(literal)];
    values.emplace(current, alpha * values.at(high) + (1.0 - alpha) * values.at(low));
  }
  return values.at(truth);
}

SXElem SxGraph::interpolation(const std::vector<SXElem>& alphas, const std::vector<double>& values) {
  std::vector<SXElem> corners(values.begin(), values.end());
  for (const SXElem& alpha : alphas) {
    std::vector<SXElem> halved;
    for (std::size_t i = 0; i + 1 < corners.size(); i += 2) {
      const bool equal = SXElem::is_equal(corners[i], corners[i + 1], 2);
      halved.push_back(equal ? corners[i] : alpha * corners[i + 1] + (1.0 - alpha) * corners[i]);
    }
    corners = std::move(halved);
  }
  return corners.front();
}

std::optional<SXElem> scalar(const casadi::SX& expression) {
  if (!expression.is_scalar()) return std::nullopt;
  return expression.nnz() == 0 ? SXElem(0.0) : expression.nonzeros().front();
}

casadi::SX column(const std::vector<SXElem>& entries) { return casadi::SX(entries); }

}  // namespace saltus::model
