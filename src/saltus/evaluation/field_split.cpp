#include <cstddef>
#include <string>
#include <vector>

#include <casadi/core/function.hpp>
#include <casadi/core/sx.hpp>
#include <casadi/core/sx_elem.hpp>

#include "saltus/evaluation/field_split_internal.hpp"

// Needs names that only the headers above bring.
#include <casadi/core/calculus.hpp>

#include "saltus/base/at.hpp"

namespace saltus::evaluation {
namespace {

using casadi::SX;
using casadi::SXElem;

/// A value of the tape: an expression over (p, alpha), or over (t, x, constants).
struct SplitValue {
  SXElem expression = 0.0;
  bool varies = false;
  int constant = -1;  ///< its number, once it is one
};

class Splitter {
 public:
  Splitter(const SX& f, const ModelSymbols& symbols)
      : tape_("tape", {symbols.t, symbols.x, symbols.p, symbols.alpha}, {SX::densify(f)}), work_(tape_.sz_w()) {
    inputs_ = {symbols.t, symbols.x, symbols.p, symbols.alpha};
    results_.resize(at(f.numel()), SXElem(0.0));
  }

  /// False where the tape has an operation that is not one of scalars.
  bool run() {
    for (casadi_int k = 0; k < tape_.n_instructions(); ++k) {
      if (!take(k)) return false;
    }
    return true;
  }

  [[nodiscard]] FieldSplit split() const {
    const auto column = [](const std::vector<SXElem>& entries) {
      return entries.empty() ? SX(0, 1) : SX(std::vector<SXElem>(entries));
    };
    return {column(constants_), column(symbols_), column(results_)};
  }

 private:
  bool take(casadi_int k) {
    const auto operation = tape_.instruction_id(k);
    const auto in = tape_.instruction_input(k);
    const auto out = tape_.instruction_output(k);
    switch (operation) {
      case casadi::OP_CALL:
        return false;
      case casadi::OP_CONST:
        work_[at(out[0])] = {tape_.instruction_constant(k)};
        return true;
      case casadi::OP_INPUT:
        work_[at(out[0])] = {inputs_[at(in[0])].nonzeros()[at(in[1])], in[0] <= 1};
        return true;
      case casadi::OP_OUTPUT:
        results_[at(out[1])] = operand(work_[at(in[0])]);
        return true;
      default:
        break;
    }
    if (in.empty() || in.size() > 2) return false;
    SplitValue& first = work_[at(in.front())];
    SplitValue& second = work_[at(in.back())];
    const bool varies = first.varies || second.varies;
    const SXElem a = varies ? operand(first) : first.expression;
    const SXElem b = varies ? operand(second) : second.expression;
    const bool binary = in.size() == 2;
    work_[at(out[0])] = {binary ? SXElem::binary(operation, a, b) : SXElem::unary(operation, a), varies};
    return true;
  }

  /// The value as it occurs in the varying part: numbers stay, everything else that does not vary gets a symbol.
  SXElem operand(SplitValue& value) {
    if (value.varies || value.expression.is_constant()) return value.expression;
    if (value.constant < 0) {
      value.constant = static_cast<int>(constants_.size());
      constants_.push_back(value.expression);
      symbols_.push_back(SXElem::sym("c" + std::to_string(value.constant)));
    }
    return symbols_[at(value.constant)];
  }

  casadi::Function tape_;
  std::vector<SX> inputs_;
  std::vector<SplitValue> work_;
  std::vector<SXElem> constants_, symbols_, results_;
};

}  // namespace

FieldSplit split_field(const SX& f, const ModelSymbols& symbols) {
  Splitter splitter(f, symbols);
  if (splitter.run()) return splitter.split();
  const SX given = SX::vertcat({symbols.p, symbols.alpha});
  const SX stand_in = SX::sym("c", given.numel());
  return {given, stand_in, SX::substitute(f, given, stand_in)};
}

}  // namespace saltus::evaluation
