#include "saltus/model/graph/program_parts.hpp"

#include <utility>

#include <casadi/core/sx_elem.hpp>

// Needs names that only the header above brings.
#include <casadi/core/calculus.hpp>

#include "saltus/base/at.hpp"
#include "saltus/base/without_repeats.hpp"

namespace saltus::model {

ProgramParts::ProgramParts(std::shared_ptr<const Program> whole)
    : whole_(std::move(whole)),
      first_(whole_->instructions_.size(), nowhere),
      second_(whole_->instructions_.size(), nowhere) {
  std::vector<int> made_by;  // by place in the work space
  const auto maker = [&](int place) { return at(place) < made_by.size() ? made_by[at(place)] : nowhere; };
  for (std::size_t k = 0; k < whole_->instructions_.size(); ++k) {
    const auto& instruction = whole_->instructions_[k];
    const auto& [first, second] = instruction.operands;
    if (instruction.operation == casadi::OP_OUTPUT) {
      first_[k] = maker(first);
      if (instruction.target != 0) continue;
      if (output_.size() <= at(second)) output_.resize(at(second) + 1, nowhere);
      output_[at(second)] = static_cast<int>(k);
      continue;
    }
    if (instruction.operation != casadi::OP_CONST && instruction.operation != casadi::OP_INPUT) {
      first_[k] = maker(first);
      second_[k] = maker(second);
    }
    if (made_by.size() <= at(instruction.target)) made_by.resize(at(instruction.target) + 1, nowhere);
    made_by[at(instruction.target)] = static_cast<int>(k);
  }
}

/// In their order, at their places: what is left out cannot have been in between.
std::shared_ptr<const Program> ProgramParts::of(const std::vector<std::size_t>& rows) const {
  std::vector<int> needed;
  for (const std::size_t row : rows) {
    if (row < output_.size() && output_[row] != nowhere) needed.push_back(output_[row]);
  }
  for (std::size_t k = 0; k < needed.size(); ++k) {
    for (const int operand : {first_[at(needed[k])], second_[at(needed[k])]}) {
      if (operand != nowhere) needed.push_back(operand);
    }
  }
  drop_repeats(needed);
  auto part = std::make_shared<Program>();
  for (const int k : needed) part->instructions_.push_back(whole_->instructions_[at(k)]);
  return part;
}

}  // namespace saltus::model
