// Barrier parameters that whoever states the problem chooses while Ipopt's loop runs.
#pragma once

#include <IpLineSearch.hpp>
#include <IpMuUpdate.hpp>

#include "saltus/adapters/ipopt/ipopt_program_internal.hpp"
#include "saltus/solver/nlp_solver.hpp"

namespace saltus::adapters {

/// Says what a loop is told, and how it has ended. Outlives the loop.
struct BarrierLoop {
  double first_mu = 0.1;
  const solver::AskNextBarrier& next;
  IpoptProgram& program;
  bool is_ended = false;  ///< by `next`
};

/// Asks for the next barrier parameter where E_mu <= 10 mu, or where steps are tiny. Where the problem has changed, the
/// filter is reset, and the iterate copied: Ipopt keeps values of functions by the tags of its vectors.
class BarrierUpdate final : public Ipopt::MuUpdate {
 public:
  BarrierUpdate(Ipopt::SmartPtr<Ipopt::LineSearch> line_search, BarrierLoop& loop);
  bool InitializeImpl(const Ipopt::OptionsList& options, const std::string& prefix) override;
  bool UpdateBarrierParameter() override;

 private:
  void set_mu(double mu);
  void renew_iterate();

  Ipopt::SmartPtr<Ipopt::LineSearch> line_search_;
  BarrierLoop& loop_;
};

}  // namespace saltus::adapters
