// An optimal control problem by finite elements with switch detection, as a problem with complementarities.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/discretization/butcher_tableau.hpp"
#include "saltus/discretization/fesd_options.hpp"
#include "saltus/discretization/fesd_problem.hpp"
#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/linalg/matrix.hpp"
#include "saltus/mpcc/problem.hpp"
#include "saltus/result/optimization.hpp"

namespace saltus::model {
struct Ocp;
}

namespace saltus::reformulation {
struct Dcs;
}

namespace saltus::discretization {

/// Holds an element with what its interval shares, costs, constraints and boundaries, compiled.
class OcpKernel {
 public:
  struct Implementation;
  /// Fails (invalid_option, not_available, invalid_model) as FesdKernel::compile.
  /// Cost: symbolic derivatives of one element, whatever the number of intervals.
  /// @param ocp  whose system `dcs` is the reformulation of
  [[nodiscard]] static Expected<std::shared_ptr<OcpKernel>> compile(
      const model::Ocp& ocp, const reformulation::Dcs& dcs, const ButcherTableau& tableau, const FesdOptions& options,
      evaluation::NativeCode native = evaluation::NativeCode::off);
  ~OcpKernel();
  [[nodiscard]] Implementation& parts() { return *implementation_; }

 private:
  explicit OcpKernel(std::unique_ptr<Implementation> implementation);
  std::unique_ptr<Implementation> implementation_;
};

/// Holds what an optimisation begins with. Rows of `states` belong to OcpProblem::start_fractions().
struct OcpGuessValues {
  double horizon = 0.0;
  std::vector<double> parameters;             ///< all of System::p
  std::vector<std::vector<double>> controls;  ///< row per interval
  std::vector<double> initial_state;
  std::vector<std::vector<double>> states;
  /// Elements get the modes of these states: lengths, selections and multipliers, too.
  bool has_modes = false;
  bool simulated = false;  ///< selections and multipliers by the signs of psi at these states, else neutral
};

/// Holds a point of the problem in the user's quantities.
struct OcpSolution {
  double horizon = 0.0;
  std::vector<double> parameters;             ///< all of System::p
  std::vector<std::vector<double>> controls;  ///< row per interval, all controls
  std::vector<double> speed_of_time;          ///< per interval; 1 unless time is frozen by hand
  std::vector<double> initial_state;
  /// Per interval. Times are those of the right-hand side: physical, or numerical where time is frozen by hand.
  std::vector<std::vector<SolvedElement>> elements;
};

/// Holds the modes of a motion, one after the other in each interval.
struct MotionModes;
/// Returns how many there are in each interval.
[[nodiscard]] std::vector<int> elements_of(const MotionModes& modes);

/// States min f, g = 0, 0 <= G _|_ H >= 0 of fesd.md (Optimal control), [nurkanovic2024] eq. (45). Variables: horizon
/// and free parameters; free initial states and their multipliers; per interval controls, speed of time, lengths hhat
/// (h = hhat s T/N, sum hhat = 1), then its elements.
///
/// Building and one evaluation cost a multiple of the number of elements. One problem per kernel and thread at a time.
class OcpProblem final : public mpcc::Problem {
 public:
  /// @param elements  per interval, as many entries as intervals
  /// Fails (invalid_model) where a function of time breaks inside an interval, (not_available) where it breaks and the
  /// horizon is free.
  [[nodiscard]] static Expected<std::unique_ptr<OcpProblem>> make(std::shared_ptr<OcpKernel> kernel,
                                                                  const model::Ocp& ocp, const reformulation::Dcs& dcs,
                                                                  const std::vector<int>& elements);
  ~OcpProblem() override;

  /// Returns times of stages and ends of equal elements as fractions of the horizon, in the order of the elements.
  [[nodiscard]] std::vector<double> start_fractions() const;
  void set_start(const OcpGuessValues& guess);
  void set_start(linalg::Vector w);
  /// Adds one of other_starts(), if it is another point; returns it.
  linalg::Vector add_start(std::string name, const OcpGuessValues& guess);
  /// Takes a point of a problem of the same kernel with other intervals or elements: stretches of equal modes are cut
  /// where intervals end, and divided into as many elements as there are.
  void set_start(const OcpProblem& earlier, mpcc::ConstVectorView w);
  [[nodiscard]] OcpSolution read(mpcc::ConstVectorView w) const;
  /// Returns parts of the user's objective at w.
  [[nodiscard]] result::ObjectiveTerms objective_terms(mpcc::ConstVectorView w);
  /// Returns multipliers of path, terminal and boundary constraints from those of rows and bounds (upper minus lower),
  /// at times of the clock where there is one.
  [[nodiscard]] std::vector<result::ConstraintMultiplier> constraint_multipliers(mpcc::ConstVectorView w,
                                                                                 mpcc::ConstVectorView rows,
                                                                                 mpcc::ConstVectorView bounds) const;
  /// Returns the name of a cost or constraint that is not finite at w; empty if all are.
  [[nodiscard]] std::string not_finite(mpcc::ConstVectorView w);

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

  [[nodiscard]] linalg::Vector start() const override;
  [[nodiscard]] std::vector<mpcc::NamedStart> other_starts() const override;
  /// Gives elements that end where the motion switches; nothing where an interval has fewer elements than modes, or no
  /// mode goes on.
  [[nodiscard]] std::optional<mpcc::NamedStart> motion(mpcc::ConstVectorView w,
                                                       const std::function<bool()>& is_over) override;
  /// Returns the modes of that motion, however many elements it needs; null where there is none, or time is over.
  /// @param stays_near  it goes on from the states of w where both are in the same mode
  [[nodiscard]] std::shared_ptr<const MotionModes> motion_modes(mpcc::ConstVectorView w,
                                                                const std::function<bool()>& is_over,
                                                                bool stays_near = false) const;
  /// Gives the motion of the same controls in modes that are known, of a problem of the same kernel.
  [[nodiscard]] std::optional<mpcc::NamedStart> motion(mpcc::ConstVectorView w, const MotionModes& modes);
  [[nodiscard]] std::string name(int variable) const override;
  [[nodiscard]] std::string row_name(int row) const override;
  [[nodiscard]] const mpcc::Chain* chain() const override;
  [[nodiscard]] std::vector<int> elimination_blocks() const override;
  void with_method_terms(mpcc::ConstVectorView w) override;
  void without_method_terms() override;
  void relaxed_by(double part) override;
  [[nodiscard]] int pair_group(int pair) const override;
  [[nodiscard]] mpcc::BranchClosure close_branch(const std::vector<mpcc::ActiveSide>& sides) const override;
  void complete(mpcc::VectorView w) override;
  /// Gives mode sequences that differ by a move, with prices where multipliers say them. Insertion: elements of length
  /// zero in modes that meet at a boundary. Removal of one of length zero. Shift of what happens at a control node to
  /// one side of it. Split of what is as long as it may be. Flip of what is held on a surface to its sides.
  /// Surfaces that are slid on are left to the side that w is on, others are slid on or crossed.
  [[nodiscard]] std::vector<mpcc::ActiveSide> freed(const std::vector<mpcc::ActiveSide>& sides, mpcc::ConstVectorView w,
                                                    double paid) override;
  [[nodiscard]] std::vector<mpcc::BranchMove> neighbours(const std::vector<mpcc::ActiveSide>& sides,
                                                         mpcc::ConstVectorView w,
                                                         const mpcc::Multipliers& multipliers) override;
  /// Returns intervals whose number of elements holds the objective up: one presses against its largest length, or the
  /// last neighbours() have found a motion for which there is none left.
  /// @param upper  multipliers of upper bounds at w
  [[nodiscard]] std::vector<int> crowded_intervals(mpcc::ConstVectorView w, const linalg::Vector& upper,
                                                   double tolerance) const;
  /// Bounds switching functions at points of a solution that only touches their surfaces: it stays beside them between
  /// its stages, too. So do selections where it slides at the edge of that. A bound that is there is doubled if the
  /// interval still switches. Returns the largest one that has changed, 0 without any.
  /// @param missed_in  the interval in which the motion itself switches
  double keep_off_touched(const std::vector<mpcc::ActiveSide>& sides, mpcc::ConstVectorView w, int missed_in);

 private:
  struct Implementation;
  explicit OcpProblem(std::unique_ptr<Implementation> implementation);
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace saltus::discretization
