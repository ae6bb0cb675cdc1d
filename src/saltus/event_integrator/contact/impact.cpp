#include "saltus/event_integrator/contact/impact.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "saltus/base/rounding_unit.hpp"
#include "saltus/event_integrator/contact/contact_forces.hpp"
#include "saltus/ode/stepper.hpp"
#include "saltus/switching/point/point_solver.hpp"

namespace saltus::event_integrator {
namespace {

using linalg::Vector;
using switching::Face;

constexpr double process_rounding = 1e-11;  ///< relative, of sums of products over many pieces
constexpr double share_rounding = 1e-9;     ///< of rates of impulses, which are 1 where a contact closes
constexpr double largest_impulse = 1e6;     ///< relative to that of one contact alone: bodies in a wedge jam

class Process {
 public:
  Process(const ContactPoint& point, const std::vector<int>& touching)
      : point_(point),
        touching_(touching),
        m_(point.contacts()),
        velocity_(point.velocity),
        impulse_(Vector::zero(velocity_.size())),
        stored_(touching.size(), 0.0),
        releasing_(touching.size(), false),
        none_(Vector::zero(velocity_.size())),
        problem_{problem_of(point, touching).blocks, point.influence, none_, point.influence.max_abs()} {
    for (const int i : touching) {
      size_ = std::max({size_, std::abs(velocity_(i)), slip(i).norm()});
      strength_ = std::max(strength_, point.influence(i, i));
    }
    note_closing();
  }

  [[nodiscard]] std::optional<Vector> run(std::optional<int> pushed) {
    forced_ = pushed;
    constexpr int most_pieces = 2000;
    for (int piece = 0; piece < most_pieces; ++piece) {
      round();
      if (!forced_ && !closes() && !release()) return impulse_;
      if (!choose()) return std::nullopt;
      forced_.reset();
      if (turns()) {
        advance_turning();
        continue;
      }
      const double length = piece_length();
      if (!(length <= largest_impulse * size_ / strength_)) {
        // Friction that holds everything at rest keeps the work back that is left to give.
        const bool at_rest = !closes() && rates_.y.max_abs() <= process_rounding * strength_;
        return at_rest ? std::optional(impulse_) : std::nullopt;
      }
      advance(length);
    }
    return std::nullopt;
  }

 private:
  [[nodiscard]] double friction(int i) const { return point_.friction[static_cast<std::size_t>(i)]; }

  [[nodiscard]] Vector slip(int i) const { return point_.along(velocity_, i); }
  [[nodiscard]] int tangents(int i) const { return point_.tangents[static_cast<std::size_t>(i)]; }

  void stop_slip(int i) {
    for (int tangent = 0; tangent < tangents(i); ++tangent) velocity_(point_.tangent_row(i, tangent)) = 0.0;
  }

  void note_closing() {
    for (const int i : touching_) closing_ = std::max(closing_, std::abs(velocity_(i)));
  }

  /// All impulses are of the size of normal velocities, however fast a slip is: so are their roundings.
  void round() {
    note_closing();
    const double none = std::max(process_rounding * closing_, 64.0 * rounding_unit * size_);
    for (const int i : touching_) {
      if (std::abs(velocity_(i)) <= none) velocity_(i) = 0.0;
      if (slip(i).norm() <= slip_rounding * size_) stop_slip(i);
    }
  }

  [[nodiscard]] bool closes() const {
    return std::any_of(touching_.begin(), touching_.end(), [&](int i) { return velocity_(i) < 0.0; });
  }

  /// Contacts with work to give back push; returns whether there are any.
  bool release() {
    bool any = false;
    for (std::size_t k = 0; k < touching_.size(); ++k) {
      releasing_[k] = stored_[k] > process_rounding * closing_ * closing_ / strength_;
      any = any || releasing_[k];
    }
    return any;
  }

  [[nodiscard]] bool pushes(std::size_t k) const {
    return velocity_(touching_[k]) < 0.0 || releasing_[k] || forced_ == touching_[k];
  }

  [[nodiscard]] Face face(std::size_t k) const { return rates_.faces[static_cast<std::size_t>(touching_[k])]; }
  [[nodiscard]] bool is_open(std::size_t k) const { return face(k) == Face::open; }
  [[nodiscard]] bool sticks(std::size_t k) const { return without_push(face(k)) == Face::stick; }
  [[nodiscard]] bool slips(std::size_t k) const { return friction(touching_[k]) > 0.0 && !is_open(k) && !sticks(k); }
  [[nodiscard]] bool is_pushed(std::size_t k) const { return block(k).is_given || switching::is_pushed(face(k)); }
  [[nodiscard]] bool is_held(std::size_t k) const { return !is_open(k) && !is_pushed(k); }
  [[nodiscard]] switching::Block& block(std::size_t k) {
    return problem_.blocks[static_cast<std::size_t>(touching_[k])];
  }
  [[nodiscard]] const switching::Block& block(std::size_t k) const {
    return problem_.blocks[static_cast<std::size_t>(touching_[k])];
  }

  void set_slip(std::size_t k, const Vector& velocity) {
    const Vector along = point_.along(velocity, touching_[k]);
    block(k).velocity = {along[0], along[1]};
  }

  /// The rates of impulses from here on: 1 of contacts that push, in [0, 1] of those that are at rest, 0 of those that
  /// leave; with friction against the slip.
  bool choose() {
    for (std::size_t k = 0; k < touching_.size(); ++k) {
      const int i = touching_[k];
      using Kind = switching::Block::Kind;
      const bool leaves = !pushes(k) && velocity_(i) > 0.0;
      block(k).kind = leaves ? Kind::absent : friction(i) > 0.0 ? Kind::friction : Kind::half_line;
      block(k).is_given = pushes(k);
      block(k).is_bounded = !pushes(k);
      set_slip(k, velocity_);
    }
    // Its own push presses it on, against what it does to all others: else it would open by work from nowhere.
    const auto presses_on = [&](const switching::PointSolution& rates) {
      return !forced_ || rates.y(*forced_) < -share_rounding * strength_;
    };
    auto found = switching::first_solution(problem_, presses_on);
    if (found) rates_ = std::move(*found);
    return found.has_value();
  }

  /// Up to the next change of a sign, or to where all stored work is given back.
  [[nodiscard]] double piece_length() const {
    double length = std::numeric_limits<double>::infinity();
    const auto zero = [&](int row) {
      const double p = -velocity_(row) / rates_.y(row);
      if (p > 0.0) length = std::min(length, p);
    };
    for (std::size_t k = 0; k < touching_.size(); ++k) {
      const int i = touching_[k];
      zero(i);
      if (friction(i) > 0.0 && !is_open(k)) length = std::min(length, slip_length(i));
      if (releasing_[k]) length = std::min(length, release_length(k));
    }
    return length;
  }

  /// Up to where a slip that does not turn ends.
  [[nodiscard]] double slip_length(int i) const {
    const Vector along = slip(i), change = point_.along(rates_.y, i);
    const double closing = -along.dot(change);
    return closing > 0.0 ? along.squared_norm() / closing : std::numeric_limits<double>::infinity();
  }

  /// (v + v' p/2) p = work.
  [[nodiscard]] double release_length(std::size_t k) const {
    const double v = velocity_(touching_[k]), rate = rates_.y(touching_[k]);
    const double root = v * v + 2.0 * rate * stored_[k];
    return root >= 0.0 && v + std::sqrt(root) > 0.0 ? 2.0 * stored_[k] / (v + std::sqrt(root))
                                                    : std::numeric_limits<double>::infinity();
  }

  /// Whether a slip in a plane turns: its direction, and with it the rates, change along the piece.
  [[nodiscard]] bool turns() const {
    for (std::size_t k = 0; k < touching_.size(); ++k) {
      const int i = touching_[k];
      if (is_open(k) || !point_.in_plane(i)) continue;
      const Vector along = slip(i), change = point_.along(rates_.y, i);
      const double across = along[0] * change[1] - along[1] * change[0];
      if (std::abs(across) > 1e-14 * strength_ * along.norm()) return true;
    }
    return false;
  }

  void advance(double length) {
    for (std::size_t k = 0; k < touching_.size(); ++k) {
      const int i = touching_[k];
      if (!is_pushed(k)) continue;
      const double work = (velocity_(i) + 0.5 * rates_.y(i) * length) * length;
      const double e = point_.restitution[static_cast<std::size_t>(i)];
      const bool ends = releasing_[k] && release_length(k) <= length;
      stored_[k] -= work > 0.0 ? work : e * e * work;
      if (ends) stored_[k] = 0.0;
      if (!(stored_[k] > 0.0)) stored_[k] = 0.0;
    }
    velocity_.add_scaled(length, rates_.y);
    impulse_.add_scaled(length, rates_.z);
    keep_at_rest();
  }

  /// Velocities that are held are 0.
  void keep_at_rest() {
    for (std::size_t k = 0; k < touching_.size(); ++k) {
      if (stored_[k] == 0.0) releasing_[k] = false;
      const int i = touching_[k];
      if (is_held(k)) velocity_(i) = 0.0;
      if (sticks(k)) stop_slip(i);
    }
  }

  /// Velocities, impulses and stored work as states over p.
  [[nodiscard]] std::vector<double> states() const {
    std::vector<double> y(velocity_.begin(), velocity_.end());
    y.insert(y.end(), impulse_.begin(), impulse_.end());
    y.insert(y.end(), stored_.begin(), stored_.end());
    return y;
  }

  void take(const double* y) {
    const auto n = velocity_.size();
    velocity_ = linalg::ConstView(y, n);
    impulse_ = linalg::ConstView(y + n, n);
    std::copy_n(y + 2 * n, stored_.size(), stored_.begin());
  }

  /// Their rates on these faces, with the directions of slip there.
  void differentiate(const double* y, double* rate) {
    const auto n = velocity_.size();
    const Vector velocity = linalg::ConstView(y, n);
    for (std::size_t k = 0; k < touching_.size(); ++k) {
      if (slips(k) && point_.in_plane(touching_[k])) set_slip(k, velocity);
    }
    const bool solved = switching::solve_least(problem_, rates_.faces, there_);
    const double undefined = std::numeric_limits<double>::quiet_NaN();
    for (linalg::Index row = 0; row < n; ++row) {
      rate[row] = solved ? there_.y(row) : undefined;
      rate[n + row] = solved ? there_.z(row) : undefined;
    }
    for (std::size_t k = 0; k < touching_.size(); ++k) {
      const double e = point_.restitution[static_cast<std::size_t>(touching_[k])];
      const double speed = is_pushed(k) ? y[touching_[k]] : 0.0;
      rate[2 * n + static_cast<linalg::Index>(k)] = speed > 0.0 ? -speed : -e * e * speed;
    }
  }

  /// What is above 0 as long as a piece in which slip turns goes on, on its faces: from states and their rates.
  [[nodiscard]] double left(const double* y, const double* rate) const {
    double least = std::numeric_limits<double>::infinity();
    const auto n = velocity_.size();
    const Vector impulses = linalg::ConstView(rate + n, n);
    for (std::size_t k = 0; k < touching_.size(); ++k) {
      const int i = touching_[k];
      const auto note = [&](double now, double then) {
        if (now != 0.0) least = std::min(least, then / now);
      };
      if (!is_held(k)) note(velocity_(i), y[i]);
      if (is_held(k)) least = std::min({least, impulses(i) + share_rounding, 1.0 + share_rounding - impulses(i)});
      if (sticks(k)) {
        least = std::min(least, friction(i) * impulses(i) + share_rounding - point_.along(impulses, i).norm());
      }
      if (releasing_[k]) note(stored_[k], y[2 * n + static_cast<linalg::Index>(k)]);
      if (slips(k) && tangents(i) == 1) note(velocity_(m_ + i), y[m_ + i]);
    }
    return least;
  }

  /// One step in p, no further than to the end of the faces; directions are followed by an eighth of their turn or
  /// less.
  void advance_turning() {
    const auto field = [&](double, const double* y, double* rate) { differentiate(y, rate); };
    const auto y = states();
    std::vector<double> slope(y.size());
    differentiate(y.data(), slope.data());
    double length = size_ / strength_;
    for (const int i : touching_) {
      const double speed = slip(i).norm(), change = point_.along(rates_.y, i).norm();
      if (point_.in_plane(i) && speed > 0.0 && change > 0.0) length = std::min(length, speed / (8.0 * change));
    }
    ode::Stepper stepper(ode::Method::dop853, static_cast<int>(y.size()));
    const ode::Tolerances tolerances{1e-13, 1e-13 * closing_ * (closing_ / size_)};
    const auto try_length = [&](double h) {
      return stepper.attempt(field, 0.0, y.data(), slope.data(), h, tolerances) == ode::Attempt::finite;
    };
    while (!try_length(length) || stepper.error_norm() > 1.0) length *= 0.5;
    if (left(stepper.x_new(), stepper.slope_new()) < 0.0) {
      double low = 0.0, high = length;
      for (int halving = 0; halving < 60; ++halving) {
        const double middle = 0.5 * (low + high);
        if (!try_length(middle)) break;
        (left(stepper.x_new(), stepper.slope_new()) < 0.0 ? high : low) = middle;
      }
      static_cast<void>(try_length(high));
      end_faces(stepper.x_new());
    } else {
      take(stepper.x_new());
    }
    keep_at_rest();
  }

  /// What has changed its sign there is 0.
  void end_faces(const double* y) {
    const Vector before = velocity_;
    take(y);
    for (const int i : touching_) {
      for (const int row : {i, m_ + i}) {
        const bool one_tangent = row == i || tangents(i) == 1;
        if (one_tangent && before(row) * velocity_(row) < 0.0) velocity_(row) = 0.0;
      }
    }
    for (double& work : stored_) work = std::max(work, 0.0);
  }

  const ContactPoint& point_;
  const std::vector<int>& touching_;
  int m_;
  Vector velocity_, impulse_;
  std::vector<double> stored_;  ///< by touching contact: work to give back
  std::vector<bool> releasing_;
  Vector none_;  ///< nothing acts but the impulses
  switching::PointProblem problem_;
  switching::PointSolution rates_, there_;  ///< of impulses (z) and velocities (y): in the piece, and along it
  std::optional<int> forced_;
  double size_ = 0.0, strength_ = 0.0;  ///< of velocities; of the influence of a normal impulse
  double closing_ = 0.0;                ///< of normal velocities up to here
};

}  // namespace

std::optional<Vector> impact(const ContactPoint& point, const std::vector<int>& touching, std::optional<int> pushed) {
  if (touching.size() == 1 && point.friction[static_cast<std::size_t>(touching.front())] == 0.0) {
    const int i = touching.front();
    Vector impulse = Vector::zero(point.velocity.size());
    impulse(i) = -(1.0 + point.restitution[static_cast<std::size_t>(i)]) * point.velocity(i) / point.influence(i, i);
    return impulse;
  }
  return Process(point, touching).run(pushed);
}

}  // namespace saltus::event_integrator
