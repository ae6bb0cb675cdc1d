#include <algorithm>
#include <array>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/evaluation/field_rows_internal.hpp"
#include "saltus/model/graph/program_parts.hpp"

namespace saltus::evaluation {

std::shared_ptr<const FieldRows> FieldRows::of(const model::ModelFunction& field,
                                               const model::ModelFunction& constants) {
  if (!field.program() || !constants.program()) return nullptr;
  auto rows = std::make_shared<FieldRows>();
  const auto n = at(field.function().numel_out(0));
  rows->constants_ = at(constants.function().numel_out(0));
  rows->registers_ = std::max(field.function().sz_w(), constants.function().sz_w());
  rows->structure_.states.resize(n);
  rows->structure_.selections.resize(n);
  rows->structure_.rows_of_state.resize(n);
  rows->structure_.rows_of_selection.resize(at(constants.function().numel_in(1)));
  const model::ProgramParts of_field(field.program()), of_constants(constants.program());
  for (std::size_t row = 0; row < n; ++row) {
    Row parts;
    parts.field = of_field.of({{row}});
    parts.constants = of_constants.of({parts.field->inputs(2)});
    rows->note(row, parts.field->inputs(1), parts.constants->inputs(1));
    rows->rows_.push_back(std::move(parts));
  }
  return rows;
}

void FieldRows::note(std::size_t row, std::vector<std::size_t> states, std::vector<std::size_t> selections) {
  for (const std::size_t state : states) structure_.rows_of_state[state].push_back(row);
  for (const std::size_t j : selections) structure_.rows_of_selection[j].push_back(row);
  structure_.states[row] = std::move(states);
  structure_.selections[row] = std::move(selections);
}

FieldRows::Work FieldRows::work() const {
  return {std::vector<double>(constants_), std::vector<double>(rows_.size()), std::vector<double>(registers_)};
}

double FieldRows::operator()(std::size_t row, double t, const double* x, const double* p, const double* alpha,
                             Work& work) const {
  const auto& [constants, field] = rows_[row];
  (*constants)(std::array<const double*, 2>{p, alpha}.data(), std::array<double*, 1>{work.constants.data()}.data(),
               work.registers.data());
  (*field)(std::array<const double*, 3>{&t, x, work.constants.data()}.data(),
           std::array<double*, 1>{work.results.data()}.data(), work.registers.data());
  return work.results[row];
}

}  // namespace saltus::evaluation
