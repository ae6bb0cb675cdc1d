// Tasks that need a problem and solvers, in several threads.
#pragma once

#include <functional>

#include "saltus/base/function_ref.hpp"
#include "saltus/solver/solve.hpp"

namespace saltus::solver {

/// Refers to what one thread solves with.
struct Place {
  mpcc::Problem& problem;
  NlpSolver& nlp;
  LpccSolver& lpcc;
  std::function<bool()> is_interrupted{};  ///< for SolveOptions
};

/// Does tasks 0 ... count - 1, each once, in up to SolveOptions::threads threads: this one at its own place, the others
/// at those that SolveOptions::make_workplace makes. What a task leaves may not depend on its place. Only this thread
/// asks SolveOptions::is_interrupted; the others hear of it.
/// @param task  called by all threads at a time
void share_out(const Place& own, const SolveOptions& options, int count, FunctionRef<void(int, const Place&)> task);

}  // namespace saltus::solver
