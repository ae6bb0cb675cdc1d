#include "saltus/model/graph/program_parts.hpp"

#include <algorithm>
#include <utility>

#include <casadi/core/sx_elem.hpp>

// Needs names that only the header above brings.
#include <casadi/core/calculus.hpp>

#include "saltus/base/at.hpp"

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
      if (output_.size() <= at(instruction.target)) output_.resize(at(instruction.target) + 1);
      auto& rows = output_[at(instruction.target)];
      if (rows.size() <= at(second)) rows.resize(at(second) + 1, nowhere);
      rows[at(second)] = static_cast<int>(k);
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
std::shared_ptr<const Program> ProgramParts::of(const Rows& rows) const {
  std::vector<int> needed;
  std::vector<bool> is_needed(first_.size(), false);
  const auto need = [&](int k) {
    if (k == nowhere || is_needed[at(k)]) return;
    is_needed[at(k)] = true;
    needed.push_back(k);
  };
  for (std::size_t result = 0; result < std::min(rows.size(), output_.size()); ++result) {
    for (const std::size_t row : rows[result]) need(row < output_[result].size() ? output_[result][row] : nowhere);
  }
  for (std::size_t k = 0; k < needed.size(); ++k) {
    for (const int operand : {first_[at(needed[k])], second_[at(needed[k])]}) need(operand);
  }
  auto part = std::make_shared<Program>();
  part->instructions_.reserve(needed.size());
  const auto take = [&](std::size_t k) { part->instructions_.push_back(whole_->instructions_[k]); };
  constexpr std::size_t as_fast_counted = 64;  // as sorted, where one of so many is needed
  if (needed.size() * as_fast_counted > is_needed.size()) {
    for (std::size_t k = 0; k < is_needed.size(); ++k) {
      if (is_needed[k]) take(k);
    }
  } else {
    std::sort(needed.begin(), needed.end());
    for (const int k : needed) take(at(k));
  }
  return part;
}

}  // namespace saltus::model
