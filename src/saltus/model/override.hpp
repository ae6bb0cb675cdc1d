// One value of a model, replaced.
#pragma once

#include <string>

#include "saltus/expression/syntax_tree.hpp"

namespace saltus::model {

/// Holds `--set NAME=VALUE`: replaces a parameter, an initial value or a control's constant value; VALUE is an
/// expression of constants (numbers, pi, functions). Unknown names are errors with the nearest known ones.
struct Override {
  std::string name;
  expression::NodePtr value;
};

}  // namespace saltus::model
