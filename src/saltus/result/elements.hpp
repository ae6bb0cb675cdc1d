// What finite elements know at their points: the complementarities over time.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "saltus/result/table.hpp"

namespace saltus::result {

/// Says how a selection is written with complementarities.
enum class SelectionForm {
  step,     ///< psi = lambda_p - lambda_n, 0 <= lambda_n _|_ alpha >= 0, 0 <= lambda_p _|_ 1 - alpha >= 0
  stewart,  ///< 0 <= lambda_i = g_i - min g _|_ theta_i >= 0
};
[[nodiscard]] std::string_view name(SelectionForm form);
/// Returns the inverse of name; nullopt if there is none of that name.
[[nodiscard]] std::optional<SelectionForm> selection_form_named(std::string_view name);

struct ElementSelection {
  std::string name;  ///< of the surface, or of the region
  SelectionForm form = SelectionForm::step;
  bool operator==(const ElementSelection&) const = default;
};

/// Holds `points` rows for each element: its left end, its stages, its right end; columns are selections.
struct Elements {
  std::size_t points = 0;
  std::vector<ElementSelection> selections;
  std::vector<double> t;
  Table<double> lambda;     ///< step: psi, so lambda_p = max(psi, 0) and lambda_n = max(-psi, 0)
  Table<double> selection;  ///< alpha or theta; at the ends those of the projected field
};

}  // namespace saltus::result
