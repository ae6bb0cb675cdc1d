// What a compiled kernel holds; no symbols any more.
#pragma once

#include <vector>

#include "saltus/discretization/element_expressions_internal.hpp"
#include "saltus/discretization/fesd_problem.hpp"

namespace saltus::discretization {

struct FesdKernel::Implementation {
  ButcherTableau tableau;
  FesdOptions options;
  std::vector<double> parameters;  ///< of the model
  int states = 0;
  int held = 0;
  ElementLayout layout;
  bool depends_on_time = false;
  std::vector<SelectionPair> pairs;
  /// Of every simplex: first selection (an indicator each) and count.
  std::vector<std::pair<int, int>> simplices;
  LocalFunction element;
  LocalFunction boundary;
  mpcc::Bounds boundary_bounds;
  model::ModelFunction indicators;  ///< (t, x, parameters) -> indicators
  evaluation::NativeFunctions native;

  [[nodiscard]] int left_size() const { return states + (depends_on_time ? 1 : 0) + static_cast<int>(pairs.size()); }
};

}  // namespace saltus::discretization
