#include "saltus/event_integrator/contact/impact_orders.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "saltus/base/at.hpp"
#include "saltus/base/contains.hpp"
#include "saltus/event_integrator/contact/impact.hpp"

namespace saltus::event_integrator {
namespace {

using linalg::Vector;

constexpr double same = 1e-9;        ///< relative, of velocities
constexpr double settled = 1e-12;    ///< likewise, of what a sequence leaves
constexpr double uncoupled = 1e-14;  ///< relative, of what an impulse of one contact does to another one

/// Impacts one behind the other, of contacts that are numbered anew: those that touch, and nothing else.
class Orders {
 public:
  Orders(const ContactPoint& point, const std::vector<int>& touching) {
    point_ = point_of(point, touching);
    has_friction_ = std::any_of(point_.friction.begin(), point_.friction.end(), [](double mu) { return mu > 0.0; });
    start_ = point_.velocity;
    size_ = start_.max_abs();
    find_involved();
  }

  /// Contacts that close, and those that they may close.
  [[nodiscard]] const std::vector<int>& involved() const { return involved_; }
  [[nodiscard]] bool closes(int i) const { return start_(i) < -settled * size_; }
  [[nodiscard]] bool is_same(const Vector& velocity, const Vector& other) const {
    return (velocity - other).max_abs() <= same * size_;
  }

  /// Whether all orders end alike, as the signs of what contacts do to each other say. Without restitution, and where
  /// no impulse opens another contact, there are least impulses that leave nothing closing. Every process adds impulses
  /// up to them, and none beyond.
  [[nodiscard]] bool agree_by_signs() const {
    if (involved_.size() < 2) return true;
    if (has_friction_) return false;
    const auto holds_for_all = [&](auto condition) {
      return std::all_of(involved_.begin(), involved_.end(), condition);
    };
    const bool inelastic = holds_for_all([&](int i) { return point_.restitution[at(i)] == 0.0; });
    return holds_for_all([&](int i) {
      return holds_for_all([&](int k) {
        return i == k || std::abs(coupling(i, k)) <= uncoupled || (inelastic && coupling(i, k) < 0.0);
      });
    });
  }

  /// Velocities behind all impacts; nothing where they have no end.
  [[nodiscard]] std::optional<Vector> follow(const std::vector<int>& order) {
    constexpr int most_rounds = 400;
    sequence_.clear();
    Vector& velocity = point_.velocity;
    velocity = start_;
    Vector before = start_, change, change_before, limit, limit_before;
    for (int round = 0; round < most_rounds; ++round) {
      bool any = false;
      for (const int i : order) {
        if (velocity(i) >= -settled * size_) continue;
        if (budget_ <= 0.0 || !push(i)) return std::nullopt;
        any = true;
      }
      if (!any) return velocity;
      change = velocity - before;
      before = velocity;
      if (round > 0) {
        const double ratio = change.dot(change_before) / change_before.squared_norm();
        limit = velocity + ratio / (1.0 - ratio) * change;
        const bool stays = round > 2 && ratio > 0.0 && ratio < 1.0 && is_within(settled, limit, limit_before);
        if (stays && limit.head(index(point_.friction.size())).min() >= -same * size_) return limit;
      }
      std::swap(limit, limit_before);
      std::swap(change, change_before);
    }
    return std::nullopt;
  }

  /// Contacts of the impacts that were followed last.
  [[nodiscard]] const std::vector<int>& sequence() const { return sequence_; }

 private:
  [[nodiscard]] bool is_within(double tolerance, const Vector& a, const Vector& b) const {
    return (a - b).max_abs() <= tolerance * size_;
  }

  [[nodiscard]] double coupling(int i, int k) const {
    return point_.influence(i, k) / std::sqrt(point_.influence(i, i) * point_.influence(k, k));
  }

  void find_involved() {
    const int m = point_.contacts();
    for (int i = 0; i < m; ++i) {
      if (closes(i)) involved_.push_back(i);
    }
    for (std::size_t k = 0; k < involved_.size(); ++k) {
      for (int i = 0; i < m; ++i) {
        const bool may_close =
            point_.influence(i, i) > 0.0 && (has_friction_ || coupling(i, involved_[k]) < -uncoupled);
        if (may_close && !contains(involved_, i)) involved_.push_back(i);
      }
    }
    std::sort(involved_.begin(), involved_.end());
  }

  /// One impact of one contact.
  bool push(int i) {
    sequence_.push_back(i);
    const double restitution = point_.restitution[at(i)];
    Vector& velocity = point_.velocity;
    if (point_.friction[at(i)] == 0.0) {
      budget_ -= 1.0;
      const double speed = velocity(i);
      velocity -= (1.0 + restitution) * speed / point_.influence(i, i) * point_.influence.col(i);
      velocity(i) = -restitution * speed;
      return true;
    }
    budget_ -= point_.in_plane(i) ? 250.0 : 20.0;
    alone_.assign(1, i);
    const auto impulses = impact(point_, alone_);
    if (!impulses) return false;
    velocity += point_.influence * *impulses;
    return true;
  }

  ContactPoint point_;
  Vector start_;
  double size_ = 0.0;
  bool has_friction_ = false;
  std::vector<int> involved_, sequence_, alone_;
  double budget_ = 1e4;  ///< of work, in impacts without friction
};

/// All of up to three contacts, else those that begin with each one that closes.
std::vector<std::vector<int>> orders_of(const Orders& orders) {
  std::vector<std::vector<int>> result;
  auto order = orders.involved();
  if (order.size() <= 3) {
    do result.push_back(order);
    while (std::next_permutation(order.begin(), order.end()));
  } else {
    for (std::size_t k = 0; k < order.size(); ++k) {
      if (orders.closes(order.front())) result.push_back(order);
      std::rotate(order.begin(), order.begin() + 1, order.end());
    }
  }
  return result;
}

}  // namespace

std::optional<OtherEnd> find_other_end(const ContactPoint& point, const std::vector<int>& touching,
                                       const Vector& impulses) {
  if (touching.size() < 2) return std::nullopt;
  Orders orders(point, touching);
  if (orders.agree_by_signs()) return std::nullopt;
  const Vector together = (point.velocity + point.influence * impulses).selected_rows(rows_of(point, touching));
  for (const auto& order : orders_of(orders)) {
    const auto velocity = orders.follow(order);
    if (!velocity || orders.is_same(*velocity, together)) continue;
    const linalg::Index row = (*velocity - together).abs().index_of_max();
    constexpr std::size_t most_named = 4;
    OtherEnd end;
    for (const int i : orders.sequence()) {
      if (end.order.size() < most_named) end.order.push_back(touching[at(i)]);
    }
    end.are_more = orders.sequence().size() > most_named;
    const auto m = index(touching.size());
    end.contact = touching[at(row % m)];
    if (row >= m) end.tangent = static_cast<int>(row / m) - 1;
    end.velocity = (*velocity)(row);
    end.together = together(row);
    return end;
  }
  return std::nullopt;
}

}  // namespace saltus::event_integrator
