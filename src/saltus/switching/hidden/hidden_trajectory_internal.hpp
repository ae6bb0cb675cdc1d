// One trajectory of the hidden dynamics, from a start to its limit set.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>
#include <vector>

#include "saltus/ode/stepper.hpp"
#include "saltus/switching/hidden/hidden_dynamics.hpp"
#include "saltus/switching/hidden/hidden_face_internal.hpp"
#include "saltus/switching/hidden/hidden_recurrence_internal.hpp"
#include "saltus/switching/hidden/rest_point_internal.hpp"
#include "saltus/switching/table/matrix_stability.hpp"

namespace saltus::switching {

inline constexpr double infinite = std::numeric_limits<double>::infinity();

struct TrajectoryEnd {
  HiddenLimit limit = HiddenLimit::undecided;
  std::vector<int> mode;
  std::vector<double> alpha;
  bool nudged = false;    ///< it rested where it could have gone either way
  bool marginal = false;  ///< a final velocity vanishes, or no root explains the oscillation
  std::string_view reason;
};

struct TrajectoryOptions {
  int budget = 100000;
  double tolerance = 1e-9;       ///< of u, absolute and relative
  double tolerance_away = 1e-9;  ///< a layer's width away from the start; in between in proportion to the distance
  bool closed_forms = true;      ///< g is multi-affine
  ode::Method method = ode::Method::dopri5;  ///< where it is not stiff
};

class HiddenTrajectory {
 public:
  HiddenTrajectory(HiddenFace& face, const TrajectoryOptions& options);
  /// Follows the trajectory to its end.
  /// @param u  m numbers: the start
  TrajectoryEnd follow(const std::vector<double>& u);
  /// Returns whether all components rest at an unstable root inside the cube, close to u.
  [[nodiscard]] bool rests_near(const std::vector<double>& u);

 private:
  enum class Status { goes_on, ended };
  enum class Rest { none, settled, moved };

  /// Where a step ends early.
  struct StepEvent {
    enum class Kind { none, boundary, maximum } kind = Kind::none;
    int component = -1;
    double theta = 1.0;
  };

  class RungeKuttaStep;

  void enter_zones();
  Status cross_corner();
  Status cross_strip();
  Status cross_interior();
  [[nodiscard]] double tolerance_here() const;
  [[nodiscard]] bool may_cross(int j) const;
  [[nodiscard]] bool has_maximum(int j, const double* slope_new) const;
  StepEvent first_event(RungeKuttaStep& step);
  void look_for_boundary(int j, StepEvent& event);
  void look_for_maximum(int j, const RungeKuttaStep& step, StepEvent& event);
  void end_step(const StepEvent& event, double h, const double* u_new);
  std::optional<Status> look_for_rest_at(int step);
  Status at_boundary(int j);
  Status pass_section(std::uint64_t event);
  void perturb();

  Status settle(std::string_view reason, const double* limit_velocity);
  Rest look_for_rest();
  enum class RootPlace { inside, at_edge };
  [[nodiscard]] bool is_resting() const;
  [[nodiscard]] std::optional<RootPlace> find_root(bool resting);
  /// Of a saturated component to its boundary, while the free ones rest.
  struct Return {
    int component = -1;  ///< -1: none comes back
    double time = infinite;
  };
  [[nodiscard]] std::optional<Return> first_return() const;
  void rest_until(const Return& first);
  bool enclosed_root(const Turn& turn);
  [[nodiscard]] double boundary(int j) const;
  [[nodiscard]] std::uint64_t zone_number() const;

  HiddenFace& face_;
  TrajectoryOptions options_;
  int m_;
  int used_ = 0;
  int nudges_ = 0;
  std::vector<double> start_, u_, v_;
  std::vector<int> zone_;
  Recurrence recurrence_;
  std::optional<ode::Stepper> stepper_, stiff_stepper_;  ///< made when they are first needed
  ode::DenseStep dense_;
  struct Looks {
    int next = 0, pause = 0;  ///< of looks for rest, in steps within a zone
  };
  Looks looks_;
  bool stiff_ = false;
  double h_ = 0.0;  ///< proposed where the trajectory is still in the zone of its last step; else 0
  std::vector<double> low_, high_, point_, point_velocity_, derivatives_;
  RestPoint rest_;
  std::vector<double> samples_;  ///< of the dense output at the interpolation nodes, node by node
  TrajectoryEnd end_;
};

}  // namespace saltus::switching
