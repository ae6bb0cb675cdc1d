#include "saltus/model/graph/program.hpp"

#include <casadi/core/sx_elem.hpp>

// Needs names that only the header above brings.
#include <casadi/core/calculus.hpp>

#include "saltus/base/at.hpp"
#include "saltus/base/without_repeats.hpp"

namespace saltus::model {

std::shared_ptr<const Program> Program::of(const casadi::Function& function) {
  if (!function.is_a("SXFunction")) return nullptr;
  auto program = std::make_shared<Program>();
  const casadi_int count = function.n_instructions();
  program->instructions_.reserve(at(count));
  for (casadi_int k = 0; k < count; ++k) {
    const auto operation = static_cast<int>(function.instruction_id(k));
    if (operation == casadi::OP_CALL || operation == casadi::OP_PARAMETER) return nullptr;
    Instruction instruction{operation, 0, {{0, 0}}};
    const auto out = function.instruction_output(k);
    instruction.target = static_cast<int>(out.at(0));
    if (operation == casadi::OP_CONST) {
      instruction.constant = function.instruction_constant(k);
    } else {
      const auto in = function.instruction_input(k);
      instruction.operands.first = static_cast<int>(in.at(0));
      // Of a result its place, of one operand that operand again, as CasADi has it.
      const casadi_int second = operation == casadi::OP_OUTPUT ? out.at(1) : in.back();
      instruction.operands.second = static_cast<int>(second);
    }
    program->instructions_.push_back(instruction);
  }
  return program;
}

std::vector<std::size_t> Program::inputs(int argument) const {
  std::vector<std::size_t> places;
  for (const auto& instruction : instructions_) {
    const bool is_it = instruction.operation == casadi::OP_INPUT && instruction.operands.first == argument;
    if (is_it) places.push_back(at(instruction.operands.second));
  }
  drop_repeats(places);
  return places;
}

/// The usual operations here, the others by CasADi's function: a call costs as much as several of them.
void Program::operator()(const double* const* arguments, double* const* results, double* work) const {
  for (const Instruction& instruction : instructions_) {
    const auto [first, second] = instruction.operands;
    switch (instruction.operation) {
      case casadi::OP_CONST:
        work[instruction.target] = instruction.constant;
        break;
      case casadi::OP_INPUT:
        work[instruction.target] = arguments[first] == nullptr ? 0.0 : arguments[first][second];
        break;
      case casadi::OP_OUTPUT:
        if (results[instruction.target] != nullptr) results[instruction.target][second] = work[first];
        break;
      case casadi::OP_ADD:
        work[instruction.target] = work[first] + work[second];
        break;
      case casadi::OP_SUB:
        work[instruction.target] = work[first] - work[second];
        break;
      case casadi::OP_MUL:
        work[instruction.target] = work[first] * work[second];
        break;
      case casadi::OP_DIV:
        work[instruction.target] = work[first] / work[second];
        break;
      case casadi::OP_NEG:
        work[instruction.target] = -work[first];
        break;
      case casadi::OP_SQ:
        work[instruction.target] = work[first] * work[first];
        break;
      default:
        casadi::casadi_math<double>::fun(static_cast<unsigned char>(instruction.operation), work[first], work[second],
                                         work[instruction.target]);
    }
  }
}

}  // namespace saltus::model
