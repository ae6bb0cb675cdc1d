// Ipopt's algorithm with parts of our own.
#pragma once

#include <IpAlgBuilder.hpp>
#include <IpTSymLinearSolver.hpp>

#include "saltus/adapters/ipopt/block_solver_internal.hpp"
#include "saltus/adapters/ipopt/ipopt_solver.hpp"

namespace saltus::adapters {

/// Builds the algorithm as Ipopt does, but for the linear solver.
class AlgorithmBuilder final : public Ipopt::AlgorithmBuilder {
 public:
  /// @param program  lives as long as the algorithm
  AlgorithmBuilder(LinearSolver with, const IpoptProgram& program) : linear_solver_(with), program_(program) {}

  Ipopt::SmartPtr<Ipopt::SymLinearSolver> SymLinearSolverFactory(const Ipopt::Journalist& journalist,
                                                                 const Ipopt::OptionsList& options,
                                                                 const std::string& prefix) override {
    if (linear_solver_ == LinearSolver::mumps) {
      return Ipopt::AlgorithmBuilder::SymLinearSolverFactory(journalist, options, prefix);
    }
    return new Ipopt::TSymLinearSolver(new BlockSolver(program_), nullptr);
  }

 private:
  LinearSolver linear_solver_;
  const IpoptProgram& program_;
};

}  // namespace saltus::adapters
