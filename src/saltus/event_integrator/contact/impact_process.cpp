#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "saltus/base/rounding_unit.hpp"
#include "saltus/event_integrator/contact/contact_forces.hpp"
#include "saltus/event_integrator/contact/impact.hpp"
#include "saltus/event_integrator/contact/impact_process_internal.hpp"
#include "saltus/ode/stepper.hpp"

namespace saltus::event_integrator {
namespace {

using linalg::Vector;

/// What a contact does in a piece of the process.
struct Branch {
  enum class Normal { open, held, pushed } normal = Normal::open;
  bool sticks = false;
  /// Of slip: a unit vector over the tangents, 0 without; not known yet where a slip in a plane begins.
  Vector direction = Vector::zero(2);
  bool begins = false;
};

constexpr double process_rounding = 1e-11;  ///< relative, of sums of products over many pieces
constexpr double share_rounding = 1e-9;     ///< of rates of impulses, which are 1 where a contact closes
constexpr double vertex_rounding = 1e-6;    ///< likewise, of those at a vertex: pivots shift what they start from
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
        options_(touching.size()),
        branches_(touching.size()),
        problem_(problem_of(point, touching)),
        rows_(velocity_.size()),
        none_(Vector::zero(velocity_.size())) {
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
        const bool at_rest = !closes() && change_.max_abs() <= process_rounding * strength_;
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

  void note_options(std::size_t k) {
    using Normal = Branch::Normal;
    const int i = touching_[k];
    const Vector along = slip(i);
    const bool slips = !along.is_zero();
    auto& options = options_[k];
    options.clear();
    const auto note = [&](Normal normal) {
      if (normal == Normal::open || friction(i) == 0.0) {
        options.push_back({normal});
      } else if (slips) {
        options.push_back({normal, false, along.normalized()});
      } else {
        options.push_back({normal, true});
        if (point_.in_plane(i)) {
          options.push_back({normal, false, Vector::zero(2), true});
        } else {
          for (const double sign : {1.0, -1.0}) options.push_back({normal, false, Vector{sign, 0.0}});
        }
      }
    };
    const bool pushed = pushes(k);
    if (!pushed && velocity_(i) == 0.0) note(Normal::held);
    if (!pushed) note(Normal::open);
    if (pushed || velocity_(i) == 0.0) note(Normal::pushed);
  }

  /// The rates of all impulses in these branches, and those of the velocities.
  bool rates(std::vector<Branch>& branches) {
    std::vector<int> beginning;
    for (std::size_t k = 0; k < touching_.size(); ++k) {
      if (branches[k].begins) beginning.push_back(touching_[k]);
    }
    if (beginning.empty()) return solve_impulses(branches);
    // Against the impulses that would keep them from slipping.
    auto sticking = branches;
    for (auto& branch : sticking) branch.sticks = branch.sticks || branch.begins;
    const bool solved = solve_impulses(sticking);
    std::vector<Vector> directions(static_cast<std::size_t>(m_), Vector::zero(2));
    for (const int i : beginning) {
      const Vector needed = solved ? Vector(-point_.along(rate_, i)) : Vector::zero(2);
      directions[static_cast<std::size_t>(i)] = needed.norm() > 0.0 ? Vector(needed.normalized()) : Vector{1.0, 0.0};
    }
    return switching::find_directions(problem_, beginning, directions, rate_, change_, [&] {
      for (std::size_t k = 0; k < touching_.size(); ++k) {
        if (branches[k].begins) branches[k].direction = directions[static_cast<std::size_t>(touching_[k])];
      }
      return solve_rates(branches);
    });
  }

  bool solve_impulses(const std::vector<Branch>& branches) {
    rows_.clear();
    for (std::size_t k = 0; k < touching_.size(); ++k) {
      const int i = touching_[k];
      const auto& branch = branches[k];
      if (branch.normal == Branch::Normal::open) continue;
      const bool pushed = branch.normal == Branch::Normal::pushed;
      if (pushed) rows_.give(i, 1.0);
      const int normal = pushed ? -1 : rows_.hold(i);
      for (int tangent = 0; tangent < tangents(i); ++tangent) {
        const int row = point_.tangent_row(i, tangent);
        if (branch.sticks) {
          rows_.hold(row);
        } else {
          rows_.share(row, normal, -friction(i) * branch.direction(tangent));
        }
      }
    }
    return rows_.solve(point_.influence, none_, rate_) != switching::HeldRows::Solution::none;
  }

  void find_change() {
    change_.resize(rate_.size());
    linalg::multiply(point_.influence, rate_, change_);
  }

  bool solve_rates(const std::vector<Branch>& branches) {
    if (!solve_impulses(branches)) return false;
    find_change();
    return true;
  }

  /// Whether what is held is held by impulses that contacts can have.
  [[nodiscard]] bool has_possible_impulses(const std::vector<Branch>& branches, double rounding) const {
    for (std::size_t k = 0; k < touching_.size(); ++k) {
      const int i = touching_[k];
      const double normal = rate_(i), largest = friction(i) * normal + rounding;
      const bool held = branches[k].normal == Branch::Normal::held;
      if (held && !(normal >= -rounding && normal <= 1.0 + rounding)) return false;
      if (branches[k].sticks && point_.along(rate_, i).norm() > largest) return false;
    }
    return true;
  }

  [[nodiscard]] bool admits(std::vector<Branch>& branches) { return rates(branches) && fits(branches, share_rounding); }

  /// Whether branches are those of the rates that have been found.
  [[nodiscard]] bool fits(const std::vector<Branch>& branches, double rounding) {
    if (!has_possible_impulses(branches, rounding)) return false;
    find_change();
    const double slow = rounding * strength_;
    for (std::size_t k = 0; k < touching_.size(); ++k) {
      const int i = touching_[k];
      const auto& branch = branches[k];
      const bool at_rest = velocity_(i) == 0.0 && !pushes(k);
      if (branch.normal == Branch::Normal::open && at_rest && change_(i) < -slow) return false;
      if (branch.normal == Branch::Normal::pushed && at_rest && change_(i) > slow) return false;
      // Its own push presses it on, against what it does to all others: else it would open by work from nowhere.
      if (forced_ == i && !(change_(i) < -slow)) return false;
      const bool from_rest = branch.normal != Branch::Normal::open && friction(i) > 0.0 && !branch.sticks;
      if (from_rest && slip(i).is_zero() && branch.direction.dot(point_.along(change_, i)) < -slow) return false;
    }
    return true;
  }

  /// The branches that hold from here on: the first admissible ones of all combinations where these are few.
  bool choose() {
    constexpr double most = 20000.0;
    double combinations = 1.0;
    for (std::size_t k = 0; k < options_.size(); ++k) {
      note_options(k);
      combinations *= static_cast<double>(options_[k].size());
    }
    if (combinations > most) return choose_by_pivots();
    numbers_.assign(options_.size(), 0);
    for (;;) {
      for (std::size_t k = 0; k < options_.size(); ++k) branches_[k] = options_[k][numbers_[k]];
      if (admits(branches_)) return true;
      std::size_t k = 0;
      while (k < options_.size() && ++numbers_[k] == options_[k].size()) numbers_[k++] = 0;
      if (k == options_.size()) return false;
    }
  }

  bool choose_by_pivots() {
    std::vector<bool> pushing(static_cast<std::size_t>(m_), false);
    for (std::size_t k = 0; k < touching_.size(); ++k) pushing[static_cast<std::size_t>(touching_[k])] = pushes(k);
    const auto vertex = rates_by_pivots(point_, touching_, velocity_, pushing);
    if (!vertex) return false;
    for (std::size_t k = 0; k < touching_.size(); ++k) branches_[k] = branch_of(k, *vertex);
    if (std::any_of(branches_.begin(), branches_.end(), [](const Branch& branch) { return branch.begins; }))
      return admits(branches_);
    // Where rows depend on each other these branches leave more rates open than the vertex.
    rate_ = vertex->z;
    return fits(branches_, vertex_rounding);
  }

  [[nodiscard]] Branch branch_of(std::size_t k, const switching::PointVertex& vertex) const {
    using switching::Face;
    const int i = touching_[k];
    const Face face = vertex.faces[static_cast<std::size_t>(i)];
    const bool is_pushed = pushes(k) || vertex.at_upper[static_cast<std::size_t>(i)];
    Branch branch{face == Face::open && !is_pushed ? Branch::Normal::open
                  : is_pushed                      ? Branch::Normal::pushed
                                                   : Branch::Normal::held};
    if (friction(i) == 0.0 || branch.normal == Branch::Normal::open) return branch;
    const Vector along = slip(i);
    branch.sticks = face == Face::stick && along.is_zero();
    branch.begins = face == Face::slip && along.is_zero();
    if (!along.is_zero()) {
      branch.direction = along.normalized();
    } else if (face == Face::slip_up || face == Face::slip_down) {
      branch.direction = Vector{face == Face::slip_up ? 1.0 : -1.0, 0.0};
    }
    return branch;
  }

  /// Up to the next change of a sign, or to where all stored work is given back.
  [[nodiscard]] double piece_length() const {
    double length = std::numeric_limits<double>::infinity();
    const auto zero = [&](int row) {
      const double p = -velocity_(row) / change_(row);
      if (p > 0.0) length = std::min(length, p);
    };
    for (std::size_t k = 0; k < touching_.size(); ++k) {
      const int i = touching_[k];
      zero(i);
      if (friction(i) > 0.0 && branches_[k].normal != Branch::Normal::open) length = std::min(length, slip_length(i));
      if (releasing_[k]) length = std::min(length, release_length(k));
    }
    return length;
  }

  /// Up to where a slip that does not turn ends.
  [[nodiscard]] double slip_length(int i) const {
    const Vector along = slip(i), change = point_.along(change_, i);
    const double closing = -along.dot(change);
    return closing > 0.0 ? along.squared_norm() / closing : std::numeric_limits<double>::infinity();
  }

  /// (v + v' p/2) p = work.
  [[nodiscard]] double release_length(std::size_t k) const {
    const double v = velocity_(touching_[k]), rate = change_(touching_[k]);
    const double root = v * v + 2.0 * rate * stored_[k];
    return root >= 0.0 && v + std::sqrt(root) > 0.0 ? 2.0 * stored_[k] / (v + std::sqrt(root))
                                                    : std::numeric_limits<double>::infinity();
  }

  /// Whether a slip in a plane turns: its direction, and with it the rates, change along the piece.
  [[nodiscard]] bool turns() const {
    for (std::size_t k = 0; k < touching_.size(); ++k) {
      const int i = touching_[k];
      if (branches_[k].normal == Branch::Normal::open || !point_.in_plane(i)) continue;
      const Vector along = slip(i), change = point_.along(change_, i);
      const double across = along[0] * change[1] - along[1] * change[0];
      if (std::abs(across) > 1e-14 * strength_ * along.norm()) return true;
    }
    return false;
  }

  void advance(double length) {
    for (std::size_t k = 0; k < touching_.size(); ++k) {
      const int i = touching_[k];
      if (branches_[k].normal != Branch::Normal::pushed) continue;
      const double work = (velocity_(i) + 0.5 * change_(i) * length) * length;
      const double e = point_.restitution[static_cast<std::size_t>(i)];
      const bool ends = releasing_[k] && release_length(k) <= length;
      stored_[k] -= work > 0.0 ? work : e * e * work;
      if (ends) stored_[k] = 0.0;
      if (!(stored_[k] > 0.0)) stored_[k] = 0.0;
    }
    velocity_.add_scaled(length, change_);
    impulse_.add_scaled(length, rate_);
    keep_at_rest();
  }

  /// Velocities that are held are 0.
  void keep_at_rest() {
    for (std::size_t k = 0; k < touching_.size(); ++k) {
      if (stored_[k] == 0.0) releasing_[k] = false;
      const int i = touching_[k];
      if (branches_[k].normal == Branch::Normal::held) velocity_(i) = 0.0;
      if (branches_[k].normal != Branch::Normal::open && branches_[k].sticks) stop_slip(i);
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

  /// Their rates in these branches, with the directions of slip there.
  void differentiate(const double* y, double* rate) {
    const auto n = velocity_.size();
    const Vector velocity = linalg::ConstView(y, n);
    auto branches = branches_;
    for (std::size_t k = 0; k < touching_.size(); ++k) {
      const Vector along = point_.along(velocity, touching_[k]);
      if (!branches[k].sticks && point_.in_plane(touching_[k]) && !along.is_zero())
        branches[k].direction = along.normalized();
    }
    const bool solved = solve_rates(branches);
    const double undefined = std::numeric_limits<double>::quiet_NaN();
    for (linalg::Index row = 0; row < n; ++row) {
      rate[row] = solved ? change_(row) : undefined;
      rate[n + row] = rate_(row);
    }
    for (std::size_t k = 0; k < touching_.size(); ++k) {
      const double e = point_.restitution[static_cast<std::size_t>(touching_[k])];
      const double speed = branches[k].normal == Branch::Normal::pushed ? y[touching_[k]] : 0.0;
      rate[2 * n + static_cast<linalg::Index>(k)] = speed > 0.0 ? -speed : -e * e * speed;
    }
  }

  /// What is above 0 as long as a piece in which slip turns goes on, in its branches: from states and their rates.
  [[nodiscard]] double left(const double* y, const double* rate) const {
    double least = std::numeric_limits<double>::infinity();
    const auto n = velocity_.size();
    const Vector impulses = linalg::ConstView(rate + n, n);
    for (std::size_t k = 0; k < touching_.size(); ++k) {
      const int i = touching_[k];
      const auto note = [&](double now, double then) {
        if (now != 0.0) least = std::min(least, then / now);
      };
      const bool is_held = branches_[k].normal == Branch::Normal::held;
      if (!is_held) note(velocity_(i), y[i]);
      if (is_held) least = std::min({least, impulses(i) + share_rounding, 1.0 + share_rounding - impulses(i)});
      if (branches_[k].sticks) {
        least = std::min(least, friction(i) * impulses(i) + share_rounding - point_.along(impulses, i).norm());
      }
      if (releasing_[k]) note(stored_[k], y[2 * n + static_cast<linalg::Index>(k)]);
      const bool slips = branches_[k].normal != Branch::Normal::open && tangents(i) == 1 && !branches_[k].sticks;
      if (slips) note(velocity_(m_ + i), y[m_ + i]);
    }
    return least;
  }

  /// One step in p, no further than to the end of the branches; directions are followed by an eighth of their turn or
  /// less.
  void advance_turning() {
    const auto field = [&](double, const double* y, double* rate) { differentiate(y, rate); };
    const auto y = states();
    std::vector<double> slope(y.size());
    differentiate(y.data(), slope.data());
    double length = size_ / strength_;
    for (const int i : touching_) {
      const double speed = slip(i).norm(), change = point_.along(change_, i).norm();
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
      end_branches(stepper.x_new());
    } else {
      take(stepper.x_new());
    }
    keep_at_rest();
  }

  /// What has changed its sign there is 0.
  void end_branches(const double* y) {
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
  Vector rate_, change_;        ///< of impulses and velocities in the piece
  std::vector<double> stored_;  ///< by touching contact: work to give back
  std::vector<bool> releasing_;
  std::vector<std::vector<Branch>> options_;  ///< by touching contact
  std::vector<std::size_t> numbers_;          ///< of those that are tried
  std::vector<Branch> branches_;
  switching::PointProblem problem_;
  switching::HeldRows rows_;
  Vector none_;  ///< nothing is given but the impulses
  std::optional<int> forced_;
  double size_ = 0.0, strength_ = 0.0;  ///< of velocities; of the influence of a normal impulse
  double closing_ = 0.0;                ///< of normal velocities up to here
};

}  // namespace

std::optional<Vector> impact_of_all(const ContactPoint& point, std::optional<int> pushed) {
  std::vector<int> all(static_cast<std::size_t>(point.contacts()));
  std::iota(all.begin(), all.end(), 0);
  return Process(point, all).run(pushed);
}

}  // namespace saltus::event_integrator
