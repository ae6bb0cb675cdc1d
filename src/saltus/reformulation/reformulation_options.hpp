// How a system is written with complementarities.
#pragma once

#include <optional>

namespace saltus::reformulation {

/// Says how a set-valued selection is written with complementarities.
enum class Form {
  step,     ///< of a step function: (22) of [nurkanovic2024]
  stewart,  ///< of the smallest of several indicators: (28) of [nurkanovic2024], [stewart1990]
};

struct ReformulationOptions {
  Form reformulation = Form::step;
  /// Most factors per product of the step form (n_d >= 2), longer ones get lifted variables; none: no lifting.
  std::optional<int> lifting = 2;
};

}  // namespace saltus::reformulation
