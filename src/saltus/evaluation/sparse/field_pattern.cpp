#include <cstddef>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/base/components.hpp"
#include "saltus/base/without_repeats.hpp"
#include "saltus/evaluation/sparse/field_pattern_internal.hpp"

namespace saltus::evaluation {
namespace {

/// Below this size, and with more entries than a share of all, dense matrices are faster. Measured with rods.
constexpr std::size_t fewest_states = 32;
constexpr std::size_t least_saving = 6;

}  // namespace

std::optional<ode::JacobianPattern> field_pattern(const FieldDependencies& dependencies) {
  const std::size_t n = dependencies.field_on_states.size();
  if (n < fewest_states) return std::nullopt;
  const std::size_t most = n * n / least_saving;
  std::vector<std::vector<int>> moved_by(dependencies.neighbours.size());  // components of f, by switching function
  std::vector<std::pair<std::size_t, std::size_t>> entries;
  for (std::size_t i = 0; i < n; ++i) {
    for (const int column : dependencies.field_on_states[i]) entries.emplace_back(i, at(column));
    for (const int j : dependencies.field_on_alpha[i]) moved_by[at(j)].push_back(static_cast<int>(i));
    if (entries.size() > most) return std::nullopt;
  }
  // Switching functions that influence each other, directly or through others.
  Components components(dependencies.neighbours.size());
  for (std::size_t j = 0; j < dependencies.neighbours.size(); ++j) {
    for (const int other : dependencies.neighbours[j]) components.join(j, at(other));
  }
  for (const auto& component : components.lists()) {
    std::vector<int> rows, columns;
    for (const std::size_t j : component) {
      const auto& states = dependencies.functions_on_states[j];
      rows.insert(rows.end(), moved_by[j].begin(), moved_by[j].end());
      rows.insert(rows.end(), states.begin(), states.end());
      columns.insert(columns.end(), states.begin(), states.end());
      for (const int state : states) {
        const auto& moving = dependencies.field_on_states[at(state)];
        columns.insert(columns.end(), moving.begin(), moving.end());
      }
    }
    drop_repeats(rows);
    drop_repeats(columns);
    if (entries.size() + rows.size() * columns.size() > most) return std::nullopt;
    for (const int row : rows) {
      for (const int column : columns) entries.emplace_back(at(row), at(column));
    }
  }
  return ode::pattern_of(n, std::move(entries));
}

}  // namespace saltus::evaluation
