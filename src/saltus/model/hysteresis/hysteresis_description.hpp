// [[hysteresis]] as it is written.
#pragma once

#include <string>

#include "saltus/base/error.hpp"
#include "saltus/expression/syntax_tree.hpp"

namespace saltus::model {

/// Holds one of [[hysteresis]]: a name that is 0 or 1. With on > off it becomes 1 where the input rises through `on`
/// and 0 where it falls through `off`; with on < off the other way round.
struct HysteresisDescription {
  std::string name;
  expression::NodePtr input;    ///< over states and parameters
  expression::NodePtr on, off;  ///< numbers or expressions of parameters and t
  expression::NodePtr initial;  ///< 0 or 1; null means 0
  SourceLocation location;
};

}  // namespace saltus::model
