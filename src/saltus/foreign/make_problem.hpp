// From what a file states to a problem with its derivatives.
#pragma once

#include <memory>

#include "saltus/foreign/problem.hpp"
#include "saltus/foreign/statement.hpp"

namespace saltus::foreign {

/// Throws what CasADi throws.
[[nodiscard]] std::unique_ptr<Problem> make_problem(Statement statement);

}  // namespace saltus::foreign
