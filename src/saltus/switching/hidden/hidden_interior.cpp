// Where two or more selections vary: Runge-Kutta steps that end on the boundaries of zones.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "saltus/base/at.hpp"
#include "saltus/base/stop.hpp"
#include "saltus/ode/bernstein.hpp"
#include "saltus/ode/step_control.hpp"
#include "saltus/switching/hidden/hidden_trajectory_internal.hpp"

namespace saltus::switching {
namespace {

/// Steps between two looks for a state of rest: each costs some of them, and says nothing on a long way.
constexpr int shortest_pause = 4;
constexpr int longest_pause = 32;

}  // namespace

/// A step of a Runge-Kutta method, its dense output made when it is first needed.
class HiddenTrajectory::RungeKuttaStep {
 public:
  RungeKuttaStep(const HiddenFace& face, ode::Stepper& stepper, ode::DenseStep& dense)
      : face_(face), stepper_(stepper), dense_(dense) {}
  [[nodiscard]] const double* slope_new() const { return stepper_.slope_new(); }
  void bounds(double* low, double* high) {
    if (stepper_.bounds(low, high)) return;
    make_dense();
    dense_.bounds(low, high);
  }
  void make_dense() {
    const auto f = [this](double /*t*/, const double* u, double* v) { face_.velocity(u, v); };
    if (!is_dense_) is_dense_ = stepper_.dense(f, dense_) == ode::Attempt::finite;
  }
  void evaluate(double theta, double* u) const { dense_.evaluate(theta, u); }

 private:
  const HiddenFace& face_;
  ode::Stepper& stepper_;
  ode::DenseStep& dense_;
  bool is_dense_ = false;
};

HiddenTrajectory::Status HiddenTrajectory::cross_interior() {
  const auto f = [this](double /*t*/, const double* u, double* v) { face_.velocity(u, v); };
  double fastest = 0.0;
  for (int j = 0; j < m_; ++j) fastest = std::max(fastest, face_.speed(j));
  if (!(fastest > 0.0)) return settle("no velocity depends on the selections", v_.data());
  looks_ = {0, shortest_pause};
  double h = h_ > 0.0 ? h_ : 0.05 / fastest;
  h_ = 0.0;
  ode::StiffnessWatch watch;
  ode::StepControl control(stiff_ ? ode::Method::radau5 : options_.method);
  if (stiff_stepper_) stiff_stepper_->restart();
  for (int steps = 0; used_ < options_.budget; ++steps, ++used_) {
    heed_stop();
    if (const auto status = look_for_rest_at(steps)) return *status;
    auto& made = stiff_ ? stiff_stepper_ : stepper_;
    if (!made) made.emplace(stiff_ ? ode::Method::radau5 : options_.method, m_);
    ode::Stepper& stepper = *made;
    const double tolerance = tolerance_here();
    const ode::Tolerances tolerances{tolerance, tolerance};
    if (stepper.attempt(f, 0.0, u_.data(), v_.data(), h, tolerances) != ode::Attempt::finite) {
      h *= 0.25;
      continue;
    }
    if (stepper.error_norm() > 1.0) {
      h *= control.rejected(stepper.error_norm());
      continue;
    }
    RungeKuttaStep step(face_, stepper, dense_);
    const StepEvent event = first_event(step);
    end_step(event, h, stepper.x_new());
    if (event.kind == StepEvent::Kind::boundary) return at_boundary(event.component);
    if (event.kind == StepEvent::Kind::maximum) {
      h_ = h * control.accepted(stepper.error_norm());
      return pass_section(static_cast<std::uint64_t>(2 * m_ + event.component));
    }
    std::copy_n(stepper.slope_new(), m_, v_.begin());
    h *= control.accepted(stepper.error_norm());
    if (!stiff_ && watch.looks_stiff(stepper, tolerances)) {
      stiff_ = true;
      control = ode::StepControl(ode::Method::radau5);
    }
  }
  return Status::goes_on;
}

/// Looks for rest where it is time to; what the trajectory does then.
std::optional<HiddenTrajectory::Status> HiddenTrajectory::look_for_rest_at(int step) {
  if (step != looks_.next) return std::nullopt;
  const Rest rest = look_for_rest();
  looks_.next += looks_.pause;
  looks_.pause = std::min(2 * looks_.pause, longest_pause);
  if (rest == Rest::settled) return settle("the hidden dynamics comes to rest: sliding", rest_.velocity().data());
  if (rest == Rest::moved) return Status::goes_on;
  return std::nullopt;
}

/// Goes to the end of a step, which is its event if it has one; there with the velocity.
void HiddenTrajectory::end_step(const StepEvent& event, double h, const double* u_new) {
  const double* next = event.kind == StepEvent::Kind::none ? u_new : point_.data();
  const double duration = event.theta * h;
  recurrence_.add_time(duration);
  for (int j = 0; j < m_; ++j) {
    recurrence_.add_selection(j, 0.5 * duration * (std::clamp(u_[at(j)], 0.0, 1.0) + std::clamp(next[j], 0.0, 1.0)));
    u_[at(j)] = next[j];
  }
  if (event.kind != StepEvent::Kind::none) face_.velocity(u_.data(), v_.data());
}

double HiddenTrajectory::tolerance_here() const {
  double distance = 0.0;
  for (int j = 0; j < m_; ++j) distance = std::max(distance, std::abs(u_[at(j)] - start_[at(j)]));
  return std::clamp(distance * options_.tolerance_away, options_.tolerance, options_.tolerance_away);
}

/// Whether a component may reach a boundary of its zone within the step whose bounds are low_ and high_.
bool HiddenTrajectory::may_cross(int j) const {
  const int z = zone_[at(j)];
  return z == 0 ? low_[at(j)] < 0.0 || high_[at(j)] > 1.0 : z < 0 ? high_[at(j)] > 0.0 : low_[at(j)] < 1.0;
}

/// Whether a component has a maximum within a step. Of two that cycle within the square either one has them.
bool HiddenTrajectory::has_maximum(int j, const double* slope_new) const {
  const bool is_asked = j == 0 || m_ != 2 || face_.free().size() != 2;
  return is_asked && zone_[at(j)] == 0 && v_[at(j)] > 0.0 && slope_new[j] < 0.0 &&
         v_[at(j)] - slope_new[j] > 1e-7 * face_.speed(j);  // else it has come to rest
}

/// The first boundary or maximum within an accepted step, with point_ there.
HiddenTrajectory::StepEvent HiddenTrajectory::first_event(RungeKuttaStep& step) {
  StepEvent event;
  step.bounds(low_.data(), high_.data());
  const double* slope_new = step.slope_new();
  bool any = false;
  bool any_may_cross = false;
  for (int j = 0; j < m_; ++j) {
    any_may_cross = any_may_cross || may_cross(j);
    any = any || has_maximum(j, slope_new);
  }
  if (!any && !any_may_cross) return event;
  step.make_dense();
  for (std::size_t node = 0; any_may_cross && node < ode::event_nodes; ++node) {
    step.evaluate(ode::interpolation_nodes()[node], samples_.data() + node * at(m_));
  }
  for (int j = 0; j < m_; ++j) {
    if (may_cross(j)) look_for_boundary(j, event);
  }
  for (int j = 0; j < m_; ++j) {
    if (has_maximum(j, slope_new)) look_for_maximum(j, step, event);
  }
  if (event.kind == StepEvent::Kind::none) return event;
  step.evaluate(event.theta, point_.data());
  if (event.kind == StepEvent::Kind::boundary) {
    // at_boundary tells the ends of [0, 1] apart by where the component is.
    point_[at(event.component)] = point_[at(event.component)] > 0.5 ? 1.0 : 0.0;
  }
  return event;
}

void HiddenTrajectory::look_for_boundary(int j, StepEvent& event) {
  const int z = zone_[at(j)];
  for (const double limit : {0.0, 1.0}) {
    if ((z < 0 && limit > 0.0) || (z > 0 && limit < 1.0)) continue;
    // Positive on this side of the boundary.
    const double side = (limit == 0.0) == (z == 0) ? 1.0 : -1.0;
    std::array<double, ode::event_nodes> values{};
    for (std::size_t node = 0; node < values.size(); ++node) {
      values[node] = side * (samples_[node * at(m_) + at(j)] - limit);
    }
    const double noise = 1e-15 * (1.0 + std::abs(u_[at(j)]));
    const int zero_order = values[0] == 0.0 ? 1 : 0;
    const auto change = ode::first_sign_change(ode::to_bernstein(values), 1, zero_order, noise);
    if (change && change->upper < event.theta) event = {StepEvent::Kind::boundary, j, change->upper};
    if (change && change->upper == event.theta && event.kind != StepEvent::Kind::boundary) {
      event = {StepEvent::Kind::boundary, j, change->upper};
    }
  }
}

/// v_j passes from + to -: located on the velocity at the dense output, whose own derivative is less accurate. Regula
/// falsi with halved ends (Illinois); the end at which v_j is not positive any more.
void HiddenTrajectory::look_for_maximum(int j, const RungeKuttaStep& step, StepEvent& event) {
  constexpr double resolution = 0x1p-44;
  double low = 0.0;
  double high = 1.0;
  double at_low = v_[at(j)];
  double at_high = step.slope_new()[j];
  int kept = 0;  // > 0: the lower end was, < 0: the upper one
  for (int i = 0; i < 44 && high - low > resolution; ++i) {
    double middle = low + (high - low) * (at_low / (at_low - at_high));
    // At least a little beyond an end that is as good as the zero.
    middle = std::clamp(middle, low + 0.5 * resolution, high - 0.5 * resolution);
    step.evaluate(middle, point_.data());
    face_.velocity(point_.data(), point_velocity_.data());
    const double value = point_velocity_[at(j)];
    if (value > 0.0) {
      low = middle;
      at_low = value;
      if (kept < 0) at_high *= 0.5;
      kept = -1;
    } else {
      high = middle;
      at_high = value;
      if (kept > 0) at_low *= 0.5;
      kept = 1;
    }
    if (value == 0.0) break;
  }
  if (high < event.theta) event = {StepEvent::Kind::maximum, j, high};
}

}  // namespace saltus::switching
