// A chain of finite elements with switch detection as a problem with complementarities.
#pragma once

#include <memory>
#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/discretization/butcher_tableau.hpp"
#include "saltus/discretization/fesd_options.hpp"
#include "saltus/discretization/variable_layout.hpp"
#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/linalg/matrix.hpp"
#include "saltus/mpcc/problem.hpp"

namespace saltus::reformulation {
struct Dcs;
}

namespace saltus::discretization {

/// Holds one complementarity of the system, a _|_ lambda: alpha_j with lambda_n,j; 1 - alpha_j with lambda_p,j; theta_i
/// with lambda_i.
struct SelectionPair {
  int selection = 0;
  bool complement = false;  ///< a = 1 - alpha_j
  bool is_region = false;   ///< a = theta_i
};

/// Holds one element and the boundary between two, compiled: symbolic work and derivatives are done here, once,
/// whatever the number of elements.
class FesdKernel {
 public:
  /// Fails in these ways:
  /// - invalid_option for weights and gamma_h outside their ranges;
  /// - not_available for Lobatto IIIA;
  /// - invalid_model if the symbolic layer refuses an expression;
  /// - as StageKernel if native code cannot be had.
  ///
  /// Cost: that of building second derivatives of n_s copies of the model.
  /// @param parameters  values of Dcs::p; controls are replaced by their inputs
  [[nodiscard]] static Expected<std::shared_ptr<FesdKernel>> compile(
      const reformulation::Dcs& dcs, std::vector<double> parameters, const ButcherTableau& tableau,
      const FesdOptions& options, evaluation::NativeCode native = evaluation::NativeCode::off);
  ~FesdKernel();

  [[nodiscard]] const FesdOptions& options() const;
  /// Returns all pairs, in the order of lambda: of step selection j first lambda_n,j, then lambda_p,j.
  [[nodiscard]] const std::vector<SelectionPair>& pairs() const;
  /// Returns the number of elementary operations of one evaluation of everything in an element and a boundary: it
  /// depends on the model and the scheme only.
  [[nodiscard]] long operations() const;

 private:
  friend class FesdProblem;
  struct Implementation;
  explicit FesdKernel(std::unique_ptr<Implementation> implementation);
  std::unique_ptr<Implementation> implementation_;
};

/// Says where a simulation step begins and what is constant in it.
struct StepData {
  double t = 0.0;
  double length = 0.0;       ///< T > 0
  std::vector<double> x;     ///< n_x
  std::vector<double> held;  ///< values of Dcs::held
};

/// Holds one element of a solution. Columns are stages.
struct SolvedElement {
  double t = 0.0;  ///< left end
  double h = 0.0;
  linalg::Matrix states;      ///< n_x by n_s
  linalg::Matrix selections;  ///< n_selections by n_s
  linalg::Matrix lambda;      ///< n_lambda by 1 + points: left end, stages, right end if that is no stage
  linalg::Vector end;         ///< n_x
};

/// States equations (47) of [nurkanovic2024] for N elements, T = sum h_n, as min f, g = 0, 0 <= G _|_ H >= 0:
/// Runge-Kutta equations, indicators, cross complementarities and step equilibration as the options of the kernel say.
/// State and lambda_(0,0) at the left end are constants, eq. (17). The objective is the method's own (step
/// equilibration) and nothing of a user's.
///
/// Building costs one pass over the entries of the sparse matrices. One problem per kernel and thread at a time:
/// problems use the work space of the kernel.
class FesdProblem final : public mpcc::Problem {
 public:
  FesdProblem(std::shared_ptr<FesdKernel> kernel, int elements);
  ~FesdProblem() override;

  void set_step(const StepData& step);
  /// Returns the state at the left end everywhere, selections in the middle, lambda as at the left end but not zero.
  [[nodiscard]] linalg::Vector first_guess() const;
  [[nodiscard]] std::vector<SolvedElement> read(mpcc::ConstVectorView w) const;
  [[nodiscard]] const VariableLayout& layout() const;

  [[nodiscard]] int variables() const override;
  [[nodiscard]] int constraints() const override;
  [[nodiscard]] int pairs() const override;
  [[nodiscard]] const mpcc::Bounds& variable_bounds() const override;
  [[nodiscard]] const mpcc::Bounds& constraint_bounds() const override;
  [[nodiscard]] const std::vector<mpcc::Sign>& signs() const override;
  [[nodiscard]] double objective(mpcc::ConstVectorView w) override;
  void objective_gradient(mpcc::ConstVectorView w, mpcc::VectorView gradient) override;
  void functions(mpcc::ConstVectorView w, mpcc::VectorView c) override;
  void jacobian(mpcc::ConstVectorView w, mpcc::VectorView values) override;
  void hessian(mpcc::ConstVectorView w, double objective_factor, mpcc::ConstVectorView y,
               mpcc::VectorView values) override;
  [[nodiscard]] const mpcc::Pattern& jacobian_pattern() const override;
  [[nodiscard]] const mpcc::Pattern& hessian_pattern() const override;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace saltus::discretization
