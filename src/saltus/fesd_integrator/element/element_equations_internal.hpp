// The equations of one finite element, and Newton steps for them.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "saltus/base/at.hpp"
#include "saltus/fesd_integrator/element/element.hpp"
#include "saltus/fesd_integrator/element/newton_system_internal.hpp"
#include "saltus/fesd_integrator/element/root_unknowns_internal.hpp"
#include "saltus/fesd_integrator/element/sliding_matrices_internal.hpp"
#include "saltus/linalg/matrix.hpp"

namespace saltus::fesd_integrator {

/// Writes down what ElementSolver solves, for one element after the other. The unknowns are the states of the stages
/// and, times h, the selections that slide there. Owns the work space.
class ElementEquations {
 public:
  ElementEquations(const discretization::StageKernel& kernel, const discretization::ButcherTableau& tableau);

  /// Sizes the element and fills in the guess; its t, h, x and size are set.
  void begin(const Point& left, double h, std::span<const ActiveSet> sets, const double* held,
             ElementSolver::Guess guess, Element& element);
  /// Says which matrix a Newton step takes.
  enum class Matrix { its_own, of_the_step_before };
  /// Takes one Newton step; nullopt if the system has no finite solution, else the largest change of a state, relative
  /// to the largest state (of a root to that).
  [[nodiscard]] std::optional<double> step(const double* held, Matrix matrix, Element& element);
  /// Returns whether the matrix of the last step may serve once more.
  [[nodiscard]] bool keeps_matrix() const { return system_.is_factorised() && roots_.empty() && !at_end_; }
  /// Returns whether factors are kept. Of large systems they cost more than steps: they serve as long as steps shrink,
  /// also for the next element in the same sets if its length is near.
  [[nodiscard]] bool saves_factors() const { return system_.is_sparse(); }
  [[nodiscard]] Matrix first_matrix(double h) const;
  void forget_matrix() { sparse_.sets.clear(); }
  /// Returns the relative change of states that may be no more than the rounding of a step.
  [[nodiscard]] double rounding() const { return roots_.empty() ? 1e-12 : 1e-9; }
  /// Finds the slopes of the stages and the right end; false if that cannot be put on the surfaces.
  [[nodiscard]] bool finish(const double* held, Element& element);

  /// Returns the directions in which the unknowns of the last step may move without changing any equation.
  [[nodiscard]] linalg::Matrix free_directions() const { return system_.null_space(); }
  /// Returns where the unknowns of a stage begin; the states come first.
  [[nodiscard]] linalg::Index place(linalg::Index stage) const { return offset_[at(stage)]; }
  /// Returns whether the selections of a stage are known: taken from the left end.
  [[nodiscard]] bool known(linalg::Index stage) const { return left_limit_ && stage == 0; }
  [[nodiscard]] bool explicit_method() const { return explicit_method_; }

 private:
  enum class Parts { everything, values };
  void set_warp(const TimeWarp& wanted);
  void set_guess(std::size_t stage, const Point& left, ElementSolver::Guess guess, Element& element);
  void guess_by_euler(const Point& left, const double* held, Element& element);
  [[nodiscard]] const ActiveSet& set(linalg::Index stage) const { return *sets_[at(stage)]; }
  [[nodiscard]] linalg::Index unknowns(linalg::Index stage) const {
    return known(stage) ? 0 : static_cast<linalg::Index>(set(stage).sliding().size());
  }
  void find_directions(linalg::Index stage, const discretization::StageValues& at);
  [[nodiscard]] auto directions_of(linalg::Index stage) {
    return directions_.middle_cols(stage * n_psi_, unknowns(stage));
  }
  void surface_row(const ActiveSet& active, std::size_t k, const discretization::StageValues& at);
  [[nodiscard]] double size(const Element& element) const;
  [[nodiscard]] double negligible(const Element& element) const { return 1e-13 * size(element); }
  [[nodiscard]] linalg::Index point_of(linalg::Index stage) const;
  void evaluate(const Element& element, const double* held, Parts parts);
  void evaluate_end(const Element& element, const double* held);
  void assemble_matrix(const Element& element);
  void assemble_entries(const Element& element);
  void assemble_surface_entries(const Element& element, linalg::Index stage);
  void assemble_right(const Element& element);
  [[nodiscard]] double update(Element& element);
  [[nodiscard]] bool project(double t, const double* held, Element& element);
  [[nodiscard]] std::optional<double> move_onto_surfaces(const ActiveSet& active, Element& element);
  [[nodiscard]] std::optional<double> move_onto_surfaces_by_entries(const ActiveSet& active, Element& element);

  const discretization::StageKernel& kernel_;
  const discretization::ButcherTableau& tableau_;
  linalg::Index n_x_, n_s_, n_psi_;
  bool explicit_method_, left_limit_;
  bool one_set_ = true, slides_ = false;
  bool at_end_ = false;  ///< the surfaces of an explicit method vanish at the right end

  NewtonSystem system_, projection_;
  std::vector<discretization::StageValues> values_;  ///< of the stages; one more for the end
  linalg::Matrix directions_;                        ///< n_x by n_psi per stage: f_alpha of what slides
  /// The same where systems are sparse, and what the matrix of the last step was made for.
  struct Sparse {
    std::vector<SparseColumns> directions;
    std::vector<ActiveSet> sets;
    double h = 0.0;
  } sparse_;
  std::vector<linalg::Index> offset_;  ///< of the unknowns of each stage
  std::vector<const ActiveSet*> sets_;
  linalg::Vector end_, row_, mu_;
  RootUnknowns roots_;
  linalg::Matrix A_;  ///< of the tableau, with the factors of the element's warp
  linalg::Vector b_, c_;
  TimeWarp warp_;
};

}  // namespace saltus::fesd_integrator
