// Other results of a model, laid over the one that a page shows.
#pragma once

#include <string>

#include "saltus/base/error.hpp"
#include "saltus/result/result.hpp"

namespace saltus::report {

/// Holds a result, and what it is called in the page (the name of its file).
struct Overlay {
  std::string label;
  result::Result result;
};

/// Checks whether `other` is of the same model as `first`: the name of the model, its equations and the names of its
/// states agree (parameters, methods and outputs may differ).
[[nodiscard]] Expected<void> check_overlay(const result::Result& first, const Overlay& other);

}  // namespace saltus::report
