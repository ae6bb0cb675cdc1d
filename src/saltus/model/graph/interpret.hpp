// A function of scalars, operation by operation, on values of any kind.
#pragma once

#include <vector>

#include <casadi/core/function.hpp>
#include <casadi/core/sx_elem.hpp>

// Needs names that only the header above brings.
#include <casadi/core/calculus.hpp>

#include "saltus/base/at.hpp"

namespace saltus::model {

/// @param input    entry `k` of argument `i`: input(i, k)
/// @param operate  what instruction `k` makes of its operands, of one operand that twice: operate(k, operation, a, b)
/// @return the entries of the first result; constants are Value{number}
template <class Value, class Input, class Operate>
std::vector<Value> interpret(const casadi::Function& function, Input input, Operate operate) {
  std::vector<Value> work(function.sz_w()), result(at(function.nnz_out(0)));
  for (casadi_int k = 0; k < function.n_instructions(); ++k) {
    const casadi_int operation = function.instruction_id(k);
    const auto in = function.instruction_input(k);
    const auto out = function.instruction_output(k);
    if (operation == casadi::OP_OUTPUT) {
      result[at(out[1])] = work[at(in[0])];
    } else if (operation == casadi::OP_CONST) {
      work[at(out[0])] = Value{function.instruction_constant(k)};
    } else if (operation == casadi::OP_INPUT) {
      work[at(out[0])] = input(in[0], in[1]);
    } else {
      work[at(out[0])] = operate(k, operation, work[at(in.front())], work[at(in.back())]);
    }
  }
  return result;
}

/// Returns the value of one operation.
template <class Value>
Value operated(casadi_int operation, const Value& first, const Value& second) {
  Value value{};
  casadi::casadi_math<Value>::fun(static_cast<unsigned char>(operation), first, second, value);
  return value;
}

}  // namespace saltus::model
