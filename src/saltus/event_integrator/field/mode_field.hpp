// The vector field of a mode: the region's own, or the sliding field with its selections.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/event_integrator/field/higher_order.hpp"
#include "saltus/event_integrator/field/linear_motion.hpp"
#include "saltus/event_integrator/field/sliding_groups.hpp"
#include "saltus/event_integrator/mode/mode_change.hpp"
#include "saltus/event_integrator/mode/mode_state.hpp"
#include "saltus/event_integrator/sliding/exit_rows.hpp"
#include "saltus/event_integrator/sliding/surface_rows.hpp"
#include "saltus/ode/stepper.hpp"
#include "saltus/switching/table/projected_field.hpp"

namespace saltus::event_integrator {

/// Says how the selections of the sliding surfaces follow from grad psi_I . f(alpha) + d psi_I/dt = 0.
enum class SlidingSolve {
  none,          ///< no sliding
  decoupled,     ///< each normal component depends on its own selection only: closed form
  coupled,       ///< multi-affine in several selections: closed form for pairs, otherwise Newton from the mode's ones
  nonaffine,     ///< decoupled, but not affine (Aizerman-Pyatnitskii): secant from the mode's selections
  higher_order,  ///< on derivatives of psi, too: HigherOrderField
};

/// Holds the exit functions of one sliding surface; the mode ends where one changes its sign.
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

/// Evaluates the right-hand side of the index-2 DAE of a mode turned into an ODE ([guglielmi2022], section 6):
///   xdot = f(t, x, alpha) - J^+ (J f + d psi_I/dt),  J = grad psi_I,
/// with alpha_I from the m equations J f + d psi_I/dt = 0. The correction is of rounding size; for a surface that is a
/// coordinate it makes the component exactly constant.
/// Owns the work space; allocates where modes begin only.
class ModeField {
 public:
  ModeField(const evaluation::ModelKernel& kernel, bool affine_in_alpha);

  void enter(const ModeState& state);
  /// Begins the mode behind a change. Where one surface changes, other selections than those of the change are as they
  /// were. Then it allocates only where another surface is slid on than last time.
  void begin(const ModeChange& change);
  /// Makes constants of a region that its change did not know; returns whether there were such. Has to be called before
  /// anything slides, or again in each evaluation before that.
  bool prepare();
  /// Returns, while one surface is slid on, from the last evaluation the normal components of the fields of both sides.
  [[nodiscard]] const ExitValues& sides() const { return exits_.front(); }
  /// Returns the same of all surfaces that are slid on, where they do not influence each other.
  [[nodiscard]] const std::vector<ExitValues>& all_sides() const { return exits_; }
  /// Returns the fields themselves.
  [[nodiscard]] const std::vector<double>& field_of(Region side) const { return f_[side == Region::below ? 0 : 1]; }
  /// Evaluates the field of a side while one surface is slid on, with f affine in its selection.
  void of_side(Region side, double t, const double* x, double* xdot) const {
    kernel_.prepared_field(t, x, constants_[side == Region::below ? 0 : 1], xdot);
  }
  [[nodiscard]] SlidingSolve solve() const { return solve_; }
  /// Returns the selections from which those of sliding surfaces are found: of the mode's beginning, or as followed.
  [[nodiscard]] const std::vector<double>& start() const { return start_alpha_; }

  /// Returns, behind an evaluation, the sliding surfaces whose gradients are taken to be independent: all, but for
  /// regions by `indicator` whose weights are those of switching::RegionWeights.
  [[nodiscard]] std::vector<int> independent() const;

  /// Evaluates xdot (n_x); not finite where the model or the sliding selection is undefined.
  void operator()(double t, const double* x, double* xdot) {
    if (solve_ != SlidingSolve::none) return slide(t, x, xdot);
    kernel_.prepared_field(t, x, constants_[0], xdot);
  }
  /// Does Stepper::attempt along this field, by native stages where there are some, or by its linear part. Behind an
  /// evaluation in the mode.
  ode::Attempt attempt(ode::Stepper& stepper, double t, const double* x, const double* slope, double h,
                       const ode::Tolerances& tolerances);
  /// Lets attempts from its beginning follow this polynomial from now on, until the mode changes. Null: none.
  void follow_known(const ode::DenseStep* known) { known_ = known; }
  [[nodiscard]] const ode::DenseStep* known() const { return known_; }
  /// Returns the selections of the last evaluation (those of attempts do not count), n_psi.
  [[nodiscard]] const std::vector<double>& alpha() const { return alpha_; }
  /// Evaluates the exit functions at a point, one per sliding surface.
  void exits(double t, const double* x, ExitValues* values);
  /// Returns, behind exits(), one of the exit functions of a surface as a row; x is any point of the mode. It has to be
  /// affine in t and in all states but the one that sliding keeps constant; nullptr otherwise. The row is valid until
  /// the next call.
  [[nodiscard]] const evaluation::AffineRow* exit_row(std::size_t row, Region region, const double* x);
  /// Returns the state that sliding on a surface keeps constant, if there is one.
  [[nodiscard]] evaluation::FixedState kept_state(std::size_t row, const double* x) const {
    const int only = rows_.coordinate[row];
    if (only < 0 || rows_.rates[static_cast<linalg::Index>(row)] != 0.0) return {};
    return {only, x[only]};
  }
  /// Returns, behind exits(), the size of the terms whose sum an exit function of a sliding surface is, which bounds
  /// its rounding.
  [[nodiscard]] double normal_terms(std::size_t row) const;
  /// Returns the smallest |det G| of the groups of coupled surfaces, relative to the size of g: how far their roots are
  /// from meeting others. 1 where there are no such groups.
  [[nodiscard]] double root_distance(double t, const double* x);
  /// Returns whether `loss` and `stability` of a sliding surface mean something.
  [[nodiscard]] bool has_loss(std::size_t row) const;
  [[nodiscard]] bool has_stability(std::size_t row) const;
  /// Notes, behind an accepted step to (t, x), the selections from which the next ones are found where more than two
  /// coupled surfaces are slid on.
  void follow(double t, const double* x);
  /// Takes Newton steps onto psi_I(t, x) = 0 along the normals; returns whether x changed.
  bool project(double t, double* x);

 private:
  [[nodiscard]] ode::RightHandSideStages native_stages() const;
  [[nodiscard]] const ode::LinearField* linear_field();
  [[nodiscard]] bool is_single() const { return solve_ == SlidingSolve::decoupled && sliding_.size() == 1; }
  void resize_rows();
  void prepare_corners();
  void take_row(std::size_t row);
  void find_rooted_rows();
  void refer_to_constants();
  void begin_sliding(const ModeChange& change);
  void begin_across(const ModeChange& change);
  void select(double t, const double* x);  ///< alpha_I, exits and f(alpha) into f_[0]; not for one affine surface
  void gradients(double t, const double* x);
  void evaluate_corners(double t, const double* x);
  void slide(double t, const double* x, double* xdot);
  void slide_on_one(double t, const double* x, double* xdot);
  void find_groups();
  [[nodiscard]] bool is_alone(std::size_t row) const;
  [[nodiscard]] std::vector<std::size_t> group_around(std::size_t row);
  void find_moved();
  void evaluate_alone(double t, const double* x);
  void evaluate_groups(double t, const double* x);
  void evaluate_pairs(double t, const double* x);
  void solve_pair(const std::array<std::size_t, 2>& rows, const switching::PairCorners& g);
  template <class Newton>
  void evaluate_many(double t, const double* x, const std::vector<std::size_t>& rows, Newton& newton);
  void find_large_groups();
  void find_parts(const std::vector<std::size_t>& group);
  [[nodiscard]] bool is_in_large(std::size_t row) const {
    return groups_.large && std::binary_search(groups_.large->rows.begin(), groups_.large->rows.end(), row);
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

  const evaluation::ModelKernel& kernel_;
  bool affine_in_alpha_;
  SlidingSolve solve_ = SlidingSolve::none;
  std::optional<HigherOrderField> higher_order_;
  std::vector<int> sliding_;
  std::vector<double> start_alpha_;          ///< of the mode
  std::vector<double> alpha_;                ///< of the last evaluation
  std::vector<double> corner_[2];            ///< selections of two regions, of several surfaces with all at 0 and at 1
  std::vector<std::size_t> between_;         ///< where these differ: the sliding surface and functions nested around it
  evaluation::FieldConstants constants_[2];  ///< of the mode's field; of the two regions
  std::vector<double> trial_;                ///< n_psi
  std::vector<double> f_[2];                 ///< n_x each
  std::vector<double> values_;               ///< all event functions
  std::vector<ExitValues> exits_;            ///< of the last evaluation
  SurfaceRows rows_;                         ///< J
  SlidingGroups groups_;
  SlidingTies ties_;
  ExitRows exit_rows_;
  int single_ = -1;                                 ///< the surface that rows and groups are of, if it is one
  std::vector<std::size_t> rooted_rows_;            ///< of functions around a root of one whose sign they hold
  std::vector<double> jump_;                        ///< n_x
  evaluation::SlidingConstants sliding_constants_;  ///< of one surface with a constant gradient
  LinearMotion linear_motion_;
  const ode::DenseStep* known_ = nullptr;
};

}  // namespace saltus::event_integrator
