#include "saltus/discretization/variable_layout.hpp"

#include <utility>

#include <fmt/format.h>

#include "saltus/base/contracts.hpp"

namespace saltus::discretization {

std::string VariableLayout::name(int variable) const {
  SALTUS_ASSERT(variable >= 0 && variable < size());
  const int in_elements = elements * element.size;
  if (variable >= in_elements) {
    const int rest = variable - in_elements;
    return fmt::format("boundary[{}]({})", rest / boundary_size + 1, rest % boundary_size);
  }
  const int n = variable / element.size;
  const int local = variable % element.size;
  if (local == element.h) return fmt::format("h[{}]", n);
  const std::pair<const char*, const VariableBlock*> blocks[] = {
      {"stage", &element.stage},   {"selection", &element.selection},  {"lifted", &element.lifted},
      {"lambda", &element.lambda}, {"mu", &element.simplex},           {"end", &element.end_state},
      {"time", &element.end_time}, {"correction", &element.correction}};
  for (const auto& [what, block] : blocks) {
    if (local < block->first || local >= block->end()) continue;
    const int rest = local - block->first;
    return fmt::format("{}[{},{}]({})", what, n, rest / block->size, rest % block->size);
  }
  return {};
}

}  // namespace saltus::discretization
