// The vector field of a mode: the region's own, or the sliding field with its selections.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "saltus/base/function_ref.hpp"
#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/event_integrator/field/higher_order.hpp"
#include "saltus/event_integrator/field/large_group.hpp"
#include "saltus/event_integrator/field/linear_motion.hpp"
#include "saltus/event_integrator/mode/mode_state.hpp"
#include "saltus/event_integrator/mode/region_ties.hpp"
#include "saltus/event_integrator/sliding/exit_rows.hpp"
#include "saltus/event_integrator/sliding/normal_rows.hpp"
#include "saltus/ode/stepper.hpp"
#include "saltus/switching/plane/bilinear_root.hpp"
#include "saltus/switching/regions/region_weights.hpp"
#include "saltus/switching/selections/selection_newton.hpp"

namespace saltus::event_integrator {

/// How the selections of the sliding surfaces follow from grad psi_I . f(alpha) + d psi_I/dt = 0.
enum class SlidingSolve {
  none,          ///< no sliding
  decoupled,     ///< each normal component depends on its own selection only: closed form
  coupled,       ///< multi-affine in several selections: closed form for pairs, otherwise Newton from the mode's ones
  nonaffine,     ///< decoupled, but not affine (Aizerman-Pyatnitskii): secant from the mode's selections
  higher_order,  ///< on derivatives of psi, too: HigherOrderField
};

/// Exit functions of one sliding surface; the mode ends where one changes its sign.
struct ExitValues {
  /// > 0 while sliding: the lower region's field still arrives (alpha > 0). Of regions by `indicator` that depend on
  /// each other `below` and -`above` are sums of weights, in no order: what the facets of their polytope leave.
  double below = 0.0;
  double above = 0.0;  ///< < 0 while sliding: the upper region's field still arrives (alpha < 1)
  /// Keeps its sign while the root exists. Not affine: d g / d alpha. First of a group of coupled surfaces: det G
  /// squared for two, det G for more, relative to the size of g.
  double loss = 0.0;
  double stability = 0.0;  ///< first of a group of coupled surfaces: > 0 while (4.12) of [guglielmi2022] holds, or for
                           ///< more than two while a scaling is known that makes the root stable
};

enum class Region { below, above };

/// Right-hand side of the index-2 DAE of a mode turned into an ODE ([guglielmi2022], section 6):
///   xdot = f(t, x, alpha) - J^+ (J f + d psi_I/dt),  J = grad psi_I,
/// with alpha_I from the m equations J f + d psi_I/dt = 0. The correction is of rounding size; for a surface that is a
/// coordinate it makes the component exactly constant.
/// Owns the work space; allocates in enter() only.
class ModeField {
 public:
  ModeField(const evaluation::ModelKernel& kernel, bool affine_in_alpha);

  void enter(const ModeState& state);
  /// The same where nothing is nested, there are no groups of regions and f is affine in the selections, without
  /// looking at any selection but that of `surface`; constants are those of the other region. Allocates nothing but
  /// where a surface is not the one that was slid on last.
  /// From one region to the other one:
  void cross(std::size_t surface, const evaluation::FieldConstants& other);
  /// From a region onto its border with the other one, which is `side` of the surface:
  void slide_from_region(std::size_t surface, double selection, Region side, const evaluation::FieldConstants& other);
  /// From the only surface that is slid on to one of its sides:
  void leave_to(Region side);
  /// Along the only surface that is slid on, whose selection is `selection` behind, across another one, where that is
  /// `alpha`; `constants_of` gives those of the region that belongs to selections, valid until it is called again.
  void pass(std::size_t surface, double alpha, double selection,
            FunctionRef<const evaluation::FieldConstants&(const std::vector<double>&)> constants_of);
  /// Of the last evaluation, while one surface is slid on: normal components of the fields of both sides.
  [[nodiscard]] const ExitValues& sides() const { return exits_.front(); }
  /// The fields themselves.
  [[nodiscard]] const std::vector<double>& field_of(Region side) const { return f_[side == Region::below ? 0 : 1]; }
  /// While one surface is slid on, f affine in its selection: the field of a side.
  void of_side(Region side, double t, const double* x, double* xdot) const {
    kernel_.prepared_field(t, x, constants_[side == Region::below ? 0 : 1], xdot);
  }
  [[nodiscard]] SlidingSolve solve() const { return solve_; }
  [[nodiscard]] int codimension() const { return static_cast<int>(sliding_.size()); }

  /// Behind an evaluation: the sliding surfaces whose gradients are taken to be independent: all, but for regions by
  /// `indicator` whose weights are those of switching::RegionWeights.
  [[nodiscard]] std::vector<int> independent() const;

  /// xdot (n_x); not finite where the model or the sliding selection is undefined.
  void operator()(double t, const double* x, double* xdot) {
    if (solve_ != SlidingSolve::none) return slide(t, x, xdot);
    kernel_.prepared_field(t, x, constants_[0], xdot);
  }
  /// Stepper::attempt along this field, by native stages where there are some, or by its linear part. Behind an
  /// evaluation in the mode.
  ode::Attempt attempt(ode::Stepper& stepper, double t, const double* x, const double* slope, double h,
                       const ode::Tolerances& tolerances);
  /// Selections of the last evaluation (those of attempts do not count), n_psi.
  [[nodiscard]] const std::vector<double>& alpha() const { return alpha_; }
  /// Exit functions at a point, one per sliding surface.
  void exits(double t, const double* x, ExitValues* values);
  /// Behind exits(): one of the exit functions of a surface as a row, if it is affine in t and in all states but the
  /// one that sliding keeps constant, nullptr otherwise; x is any point of the mode. Valid until the next call.
  [[nodiscard]] const evaluation::AffineRow* exit_row(std::size_t row, Region region, const double* x);
  /// Behind exits(): size of the terms whose sum an exit function of a sliding surface is, which bounds its rounding.
  [[nodiscard]] double normal_terms(std::size_t row) const;
  /// Smallest |det G| of the groups of coupled surfaces, relative to the size of g: how far their roots are from
  /// meeting others. 1 where there are no such groups.
  [[nodiscard]] double root_distance(double t, const double* x);
  /// Whether `loss` and `stability` of a sliding surface mean something.
  [[nodiscard]] bool has_loss(std::size_t row) const;
  [[nodiscard]] bool has_stability(std::size_t row) const;
  /// Behind an accepted step to (t, x): where more than two coupled surfaces are slid on, the selections from which the
  /// next ones are found.
  void follow(double t, const double* x);
  /// Newton steps onto psi_I(t, x) = 0 along the normals; returns whether x changed.
  bool project(double t, double* x);

 private:
  /// Regions of a group by `indicator` that slide, as rows, and the reference they are measured against.
  struct SlidingRegions {
    int reference = 0;
    std::vector<std::size_t> rows;
    /// Where the gradients of `rows` depend on each other.
    std::optional<switching::RegionWeights> tie = {};
    RegionBasis basis = {};
    Eigen::MatrixXd gradients = {};  ///< that the tie was made of
    bool constant = false;           ///< gradients of all rows
  };

  [[nodiscard]] ode::RightHandSideStages native_stages() const;
  [[nodiscard]] const ode::LinearField* linear_field();
  [[nodiscard]] bool is_single() const { return solve_ == SlidingSolve::decoupled && sliding_.size() == 1; }
  void resize_rows();
  [[nodiscard]] bool keeps_rows() const;
  [[nodiscard]] bool take_known_row(std::size_t row);
  void take_row(std::size_t row);
  void find_rooted_rows();
  void refer_to_constants();
  void select(double t, const double* x);  ///< alpha_I, exits and f(alpha) into f_[0]; not for one affine surface
  void gradients(double t, const double* x);
  [[nodiscard]] double normal_velocity(std::size_t row, const std::vector<double>& f) const;
  void evaluate_corners(double t, const double* x);
  void slide(double t, const double* x, double* xdot);
  void slide_on_one(double t, const double* x, double* xdot);
  void find_groups();
  void evaluate_alone(double t, const double* x);
  void evaluate_groups(double t, const double* x);
  void evaluate_pair(double t, const double* x, const std::vector<std::size_t>& rows);
  void evaluate_many(double t, const double* x, const std::vector<std::size_t>& rows);
  void evaluate_large(double t, const double* x, LargeGroup& group);
  void find_large_groups();
  void find_parts(const std::vector<std::size_t>& group);
  [[nodiscard]] bool is_in_large(std::size_t row) const {
    return large_ && std::binary_search(large_->rows.begin(), large_->rows.end(), row);
  }
  void find_speeds(switching::ProjectedField velocities, const std::vector<std::size_t>& rows);
  void find_stability();
  [[nodiscard]] bool several_regions(std::size_t row) const;
  [[nodiscard]] bool on_other_surface(std::size_t row) const;
  void find_regions(const ModeState& state);
  void find_ties();
  void find_independent_rows();
  [[nodiscard]] const SlidingRegions* tie_of(std::size_t row) const;
  void evaluate_tie(double t, const double* x, SlidingRegions& regions);
  void weigh_references();
  void evaluate_nonaffine(double t, const double* x);
  double selected_velocity(double t, const double* x, std::size_t row, double selection);
  void balance_beside_roots(double t, const double* x);
  void remove_normal_part(double* xdot);
  void evaluate_higher_order(double t, const double* x);
  [[nodiscard]] bool solve_normal_equations();
  [[nodiscard]] bool solve_independent_equations();

  const evaluation::ModelKernel& kernel_;
  bool affine_in_alpha_;
  SlidingSolve solve_ = SlidingSolve::none;
  std::optional<HigherOrderField> higher_order_;
  std::vector<int> sliding_;
  std::vector<double> start_alpha_;          ///< of the mode
  std::vector<double> alpha_;                ///< of the last evaluation
  std::vector<double> corner_[2];            ///< selections of the two regions (one sliding surface)
  std::vector<std::size_t> between_;         ///< where these differ: the sliding surface and functions nested around it
  evaluation::FieldConstants constants_[2];  ///< of the mode's field; of the two regions (one sliding surface)
  std::vector<double> trial_;                ///< n_psi
  std::vector<double> f_[2];                 ///< n_x each
  std::vector<double> values_;               ///< all event functions
  std::vector<ExitValues> exits_;            ///< of the last evaluation
  std::vector<std::vector<std::size_t>> groups_;  ///< rows that influence each other, connected and ascending
  std::vector<std::size_t> group_size_;           ///< by row, 0 behind the first of a group
  std::vector<std::optional<switching::RootKind>>
      kind_;  ///< by row, for the first of a pair: known once it was evaluated
  std::vector<SlidingRegions> regions_;
  bool ties_known_ = false;                ///< of this mode: once gradients are
  std::vector<Eigen::Index> independent_;  ///< of ties: rows whose gradients are; empty = all
  Eigen::MatrixXd tie_rows_, tie_rates_, base_rows_;
  Eigen::VectorXd base_residual_;
  std::vector<double> theta_;
  std::vector<std::optional<switching::SelectionNewton>> newton_;  ///< by row, for the first of a larger group
  std::optional<LargeGroup> large_;
  std::vector<double> selections_;  ///< of the group at hand
  std::vector<double> speed_;       ///< by row: in groups of more than two
  std::vector<double> scaled_;      ///< G of such a group, rows over their speeds
  std::vector<double> condition_;   ///< by row: of a coupled selection
  /// Forms of exits that were asked for: solutions come back to their modes.
  struct ExitRow {
    const void* motion = nullptr;  ///< of the kernel
    int surface = 0;
    evaluation::FixedState fixed;
    std::vector<double> alpha;
    evaluation::AffineRow form;
  };
  std::array<ExitRow, 8> exit_rows_;  ///< the last ones
  ExitRows several_exits_;            ///< the same where several surfaces are slid on
  std::size_t next_exit_row_ = 0;
  evaluation::AffineRow exit_form_;                 ///< of a row that is not kept
  int single_ = -1;                                 ///< the surface that rows and groups are of, if it is one
  std::vector<std::size_t> rooted_rows_;            ///< of functions around a root of one whose sign they hold
  std::vector<double> jump_;                        ///< n_x
  std::vector<bool> constant_row_;                  ///< gradient known once and for all in this mode
  std::vector<int> coordinate_;                     ///< the only nonzero column of a row, or -1
  evaluation::SlidingConstants sliding_constants_;  ///< of one surface with a constant gradient
  LinearMotion linear_motion_;
  NormalRows normal_;               ///< J
  std::vector<double> correction_;  ///< n_x
  /// Gradients that no mode changes, by surface, with d psi/dt.
  struct KnownRow {
    bool known = false;
    SparseRow row = {};
    double rate = 0.0;
  };
  std::vector<KnownRow> known_rows_;
  std::vector<int> row_of_;           ///< by surface while groups are found, -1 = it is not slid on
  Eigen::MatrixXd rows_;              ///< J, m x n_x; of one sliding surface, and where there are regions
  double row_square_ = 0.0;           ///< |J|^2 of one sliding surface
  Eigen::VectorXd rates_, residual_;  ///< d psi_I/dt, m
  Eigen::MatrixXd normal_matrix_;     ///< J J^T
  Eigen::LLT<Eigen::MatrixXd> cholesky_;
};

}  // namespace saltus::event_integrator
