// Ipopt's algorithm with parts of our own.
#pragma once

#include <IpAlgBuilder.hpp>
#include <IpTSymLinearSolver.hpp>

#include "saltus/adapters/ipopt/barrier_update_internal.hpp"
#include "saltus/adapters/ipopt/block_solver_internal.hpp"
#include "saltus/adapters/ipopt/ipopt_solver.hpp"

namespace saltus::adapters {

/// Builds the algorithm as Ipopt does, but for the linear solver, and for the barrier parameters of a loop.
class AlgorithmBuilder final : public Ipopt::AlgorithmBuilder {
 public:
  /// @param program, loop  live as long as the algorithm
  AlgorithmBuilder(LinearSolver with, const IpoptProgram& program, BarrierLoop* loop = nullptr)
      : linear_solver_(with), program_(program), loop_(loop) {}

  Ipopt::SmartPtr<Ipopt::SymLinearSolver> SymLinearSolverFactory(const Ipopt::Journalist& journalist,
                                                                 const Ipopt::OptionsList& options,
                                                                 const std::string& prefix) override {
    if (linear_solver_ == LinearSolver::mumps) {
      return Ipopt::AlgorithmBuilder::SymLinearSolverFactory(journalist, options, prefix);
    }
    return new Ipopt::TSymLinearSolver(new BlockSolver(program_), nullptr);
  }

  Ipopt::SmartPtr<Ipopt::LineSearch> BuildLineSearch(const Ipopt::Journalist& journalist,
                                                     const Ipopt::OptionsList& options,
                                                     const std::string& prefix) override {
    line_search_ = Ipopt::AlgorithmBuilder::BuildLineSearch(journalist, options, prefix);
    return line_search_;
  }

  Ipopt::SmartPtr<Ipopt::MuUpdate> BuildMuUpdate(const Ipopt::Journalist& journalist, const Ipopt::OptionsList& options,
                                                 const std::string& prefix) override {
    if (loop_ == nullptr) return Ipopt::AlgorithmBuilder::BuildMuUpdate(journalist, options, prefix);
    return new BarrierUpdate(line_search_, *loop_);
  }

 private:
  LinearSolver linear_solver_;
  const IpoptProgram& program_;
  BarrierLoop* loop_;
  Ipopt::SmartPtr<Ipopt::LineSearch> line_search_;
};

}  // namespace saltus::adapters
