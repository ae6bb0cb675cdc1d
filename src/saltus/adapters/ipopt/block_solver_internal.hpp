// linalg::BlockLdl as a linear solver of Ipopt.
#pragma once

#include <IpSparseSymLinearSolverInterface.hpp>
#include <vector>

#include "saltus/adapters/ipopt/ipopt_program_internal.hpp"
#include "saltus/linalg/block_ldl.hpp"

namespace saltus::adapters {

/// Factorises Ipopt's augmented systems in the order in which a problem wants its variables eliminated. Where it wants
/// none, the order is one of few new entries. Their rows are the free variables, slacks of inequalities, equations,
/// inequalities, each in the order of the program.
class BlockSolver final : public Ipopt::SparseSymLinearSolverInterface {
 public:
  /// @param program  says which order; lives as long as this
  explicit BlockSolver(const IpoptProgram& program) : program_(program) {}

  bool InitializeImpl(const Ipopt::OptionsList& options, const std::string& prefix) override;
  Ipopt::ESymSolverStatus InitializeStructure(Ipopt::Index size, Ipopt::Index entries, const Ipopt::Index* row,
                                              const Ipopt::Index* column) override;
  double* GetValuesArrayPtr() override { return values_.data(); }
  Ipopt::ESymSolverStatus MultiSolve(bool is_new, const Ipopt::Index* row, const Ipopt::Index* column,
                                     Ipopt::Index right_sides, double* right, bool checks_negative,
                                     Ipopt::Index expected_negative) override;
  [[nodiscard]] Ipopt::Index NumberOfNegEVals() const override { return inertia_.negative; }
  bool IncreaseQuality() override;
  [[nodiscard]] bool ProvidesInertia() const override { return true; }
  [[nodiscard]] EMatrixFormat MatrixFormat() const override { return Triplet_Format; }

 private:
  const IpoptProgram& program_;
  linalg::BlockLdl factors_;
  std::vector<int> rows_, columns_, blocks_;  ///< those that were analysed last
  std::vector<double> values_;
  linalg::Inertia inertia_;
  double tolerance_ = linalg::BlockLdl::usual_tolerance;
  bool is_out_of_date_ = true;  ///< the factors are of other values or another tolerance
};

}  // namespace saltus::adapters
