// A Problem without pairs as Ipopt sees it.
#pragma once

#include <IpTNLP.hpp>
#include <functional>
#include <vector>

#include "saltus/solver/nlp_solver.hpp"

namespace saltus::adapters {

/// Hands every question on to the problem, and keeps the point that Ipopt ends with.
class IpoptProgram final : public Ipopt::TNLP {
 public:
  /// Sets what the next solution is about; both outlive it.
  void set(mpcc::Problem& problem, solver::NlpPoint& point, const solver::NlpOptions& options);
  /// Returns whether the last problem was stopped because its point did not move any more.
  [[nodiscard]] bool stands_still() const;
  /// Returns whether it was stopped because its objective did not, at a point that is acceptable.
  [[nodiscard]] bool is_exhausted() const;
  /// Returns whether it was stopped because it was about to end above NlpOptions::objective_cutoff.
  [[nodiscard]] bool is_cut_off() const { return is_cut_off_; }
  [[nodiscard]] double objective() const { return objective_; }
  [[nodiscard]] const solver::NlpPoint& point() const { return *point_; }
  /// Stops only behind that many iterations, those of restoration phases among them, without take_iterate(): a loop
  /// over barrier problems has its own rules.
  void let_it_run(int longest) { pace_.longest = longest; }
  [[nodiscard]] bool is_too_long() const { return pace_.longest > 0 && pace_.untaken > pace_.longest; }
  /// Makes the current iterate the point.
  void take_iterate(const Ipopt::IpoptData* data, Ipopt::IpoptCalculatedQuantities* quantities);
  /// Returns the block of each row of Ipopt's augmented system of this size (Problem::elimination_blocks); empty where
  /// the problem has no order, or Ipopt has made another program of it.
  [[nodiscard]] std::vector<int> elimination_blocks(int size) const;
  /// Returns how many rows Ipopt sees.
  [[nodiscard]] int rows() const { return static_cast<int>(rows_.size()); }
  [[nodiscard]] double evaluation_seconds() const { return evaluation_seconds_; }

  bool get_nlp_info(Ipopt::Index& n, Ipopt::Index& m, Ipopt::Index& jacobian_entries, Ipopt::Index& hessian_entries,
                    IndexStyleEnum& index_style) override;
  bool get_bounds_info(Ipopt::Index n, double* w_lower, double* w_upper, Ipopt::Index m, double* g_lower,
                       double* g_upper) override;
  bool get_starting_point(Ipopt::Index n, bool wants_w, double* w, bool wants_z, double* z_lower, double* z_upper,
                          Ipopt::Index m, bool wants_y, double* y) override;
  bool eval_f(Ipopt::Index n, const double* w, bool is_new, double& value) override;
  bool eval_grad_f(Ipopt::Index n, const double* w, bool is_new, double* gradient) override;
  bool eval_g(Ipopt::Index n, const double* w, bool is_new, Ipopt::Index m, double* g) override;
  bool eval_jac_g(Ipopt::Index n, const double* w, bool is_new, Ipopt::Index m, Ipopt::Index entries, Ipopt::Index* row,
                  Ipopt::Index* column, double* values) override;
  bool eval_h(Ipopt::Index n, const double* w, bool is_new, double objective_factor, Ipopt::Index m, const double* y,
              bool is_new_y, Ipopt::Index entries, Ipopt::Index* row, Ipopt::Index* column, double* values) override;
  bool intermediate_callback(Ipopt::AlgorithmMode mode, Ipopt::Index iteration, double objective,
                             double primal_infeasibility, double dual_infeasibility, double mu, double step_norm,
                             double regularisation, double dual_step, double primal_step, Ipopt::Index trials,
                             const Ipopt::IpoptData* data, Ipopt::IpoptCalculatedQuantities* quantities) override;
  void finalize_solution(Ipopt::SolverReturn status, Ipopt::Index n, const double* w, const double* z_lower,
                         const double* z_upper, Ipopt::Index m, const double* g, const double* y, double objective,
                         const Ipopt::IpoptData* data, Ipopt::IpoptCalculatedQuantities* quantities) override;

 private:
  /// Rows without bounds are no constraints: Ipopt does not see them.
  void find_rows();
  /// Gives the current iterate; false if Ipopt has none.
  bool read_iterate(const Ipopt::IpoptData* data, Ipopt::IpoptCalculatedQuantities* quantities,
                    solver::NlpPoint& point);
  /// Counts iterations that change nothing, keeps the best of them.
  void watch(double objective, double primal_infeasibility, double dual_infeasibility, double mu,
             const Ipopt::IpoptData* data, Ipopt::IpoptCalculatedQuantities* quantities);

  std::vector<int> rows_;     ///< of the problem that Ipopt sees
  std::vector<int> entries_;  ///< of the problem's Jacobian
  mpcc::Pattern jacobian_pattern_;
  linalg::Vector c_, y_, jacobian_;
  mpcc::Problem* problem_ = nullptr;
  solver::NlpPoint* point_ = nullptr;
  std::function<bool()> is_interrupted_;
  double objective_ = 0.0;
  double evaluation_seconds_ = 0.0;
  int standing_ = 0;  ///< iterations in a row without a step
  int equal_ = 0;     ///< without a change of the objective
  double last_objective_ = 0.0;
  double acceptable_ = 0.0, feasible_ = 0.0;
  double cutoff_ = 0.0;
  bool is_cut_off_ = false;
  std::optional<double> curved_below_;  ///< NlpOptions, until it is reached
  struct Pace {
    int longest = 0;  ///< iterations between two iterates that are taken; 0: none is
    int untaken = 0;  ///< since the last one
  } pace_;
  bool is_near_ = false;   ///< the last iterate is feasible, with a small barrier
  solver::NlpPoint best_;  ///< of such iterates the one with the least dual infeasibility; also where a limit ends it
  double best_error_ = 0.0;
};

}  // namespace saltus::adapters
