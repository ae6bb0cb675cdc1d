// What depends on what in a right-hand side, by its operations.
#pragma once

#include <cstddef>
#include <vector>

namespace saltus::evaluation {

/// Lists, each ascending, which states and selections the rows of f are made of, and the reverse.
struct FieldStructure {
  std::vector<std::vector<std::size_t>> states;             ///< by row
  std::vector<std::vector<std::size_t>> selections;         ///< by row
  std::vector<std::vector<std::size_t>> rows_of_state;      ///< by state
  std::vector<std::vector<std::size_t>> rows_of_selection;  ///< by switching function
};

}  // namespace saltus::evaluation
