#include "saltus/event_integrator/contact/impact.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace saltus::event_integrator {
namespace {

using Eigen::VectorXd;

/// What a contact does in a piece of the process.
struct Branch {
  enum class Normal { open, held, pushed } normal = Normal::open;
  int slip = 0;  ///< sign of the tangential velocity; 0: sticks, or has no friction
};

constexpr double process_rounding = 1e-11;  ///< relative, of sums of products over many pieces
constexpr double largest_impulse = 1e6;     ///< relative to that of one contact alone: bodies in a wedge jam

class Process {
 public:
  Process(const ContactPoint& point, const std::vector<int>& touching)
      : point_(point),
        touching_(touching),
        m_(point.contacts()),
        velocity_(point.velocity),
        impulse_(VectorXd::Zero(2 * m_)),
        stored_(touching.size(), 0.0),
        releasing_(touching.size(), false) {
    for (const int i : touching) {
      size_ = std::max({size_, std::abs(velocity_(i)), std::abs(velocity_(m_ + i))});
      strength_ = std::max(strength_, point.influence(i, i));
    }
  }

  [[nodiscard]] std::optional<VectorXd> run(std::optional<int> pushed) {
    forced_ = pushed;
    constexpr int most_pieces = 2000;
    for (int piece = 0; piece < most_pieces; ++piece) {
      round();
      if (!forced_ && !closes() && !release()) return impulse_;
      if (!choose()) return std::nullopt;
      forced_.reset();
      const double length = piece_length();
      if (!(length <= largest_impulse * size_ / strength_)) return std::nullopt;
      advance(length);
    }
    return std::nullopt;
  }

 private:
  [[nodiscard]] double friction(int i) const { return point_.friction[static_cast<std::size_t>(i)]; }

  void round() {
    for (const int i : touching_) {
      for (const int row : {i, m_ + i}) {
        if (std::abs(velocity_(row)) <= process_rounding * size_) velocity_(row) = 0.0;
      }
    }
  }

  [[nodiscard]] bool closes() const {
    return std::any_of(touching_.begin(), touching_.end(), [&](int i) { return velocity_(i) < 0.0; });
  }

  /// Contacts with work to give back push; returns whether there are any.
  bool release() {
    bool any = false;
    for (std::size_t k = 0; k < touching_.size(); ++k) {
      releasing_[k] = stored_[k] > process_rounding * size_ * size_ / strength_;
      any = any || releasing_[k];
    }
    return any;
  }

  [[nodiscard]] bool pushes(std::size_t k) const {
    return velocity_(touching_[k]) < 0.0 || releasing_[k] || forced_ == touching_[k];
  }

  [[nodiscard]] std::vector<Branch> options(std::size_t k) const {
    const int i = touching_[k];
    std::vector<Branch::Normal> normals;
    if (pushes(k)) {
      normals = {Branch::Normal::pushed};
    } else if (velocity_(i) > 0.0) {
      normals = {Branch::Normal::open};
    } else {
      normals = {Branch::Normal::held, Branch::Normal::open, Branch::Normal::pushed};
    }
    std::vector<Branch> result;
    for (const auto normal : normals) {
      const double slip = velocity_(m_ + i);
      if (normal == Branch::Normal::open || friction(i) == 0.0) {
        result.push_back({normal, 0});
      } else if (slip != 0.0) {
        result.push_back({normal, slip > 0.0 ? 1 : -1});
      } else {
        for (const int sign : {0, 1, -1}) result.push_back({normal, sign});
      }
    }
    return result;
  }

  /// The rates of all impulses in these branches, and those of the velocities.
  bool rates(const std::vector<Branch>& branches) {
    HeldRows rows(m_);
    for (std::size_t k = 0; k < touching_.size(); ++k) {
      const int i = touching_[k];
      const auto& branch = branches[k];
      if (branch.normal == Branch::Normal::open) continue;
      const double along = -friction(i) * branch.slip;
      if (branch.normal == Branch::Normal::pushed) {
        rows.given(i) = 1.0;
        rows.given(m_ + i) = along;
      } else {
        rows.columns(m_ + i, rows.hold(i)) = along;
      }
      if (friction(i) > 0.0 && branch.slip == 0) rows.hold(m_ + i);
    }
    if (!rows.solve(point_.influence, VectorXd::Zero(2 * m_), rate_)) return false;
    change_ = point_.influence * rate_;
    return true;
  }

  [[nodiscard]] bool admits(const std::vector<Branch>& branches) {
    if (!rates(branches)) return false;
    const double least = 1e-9, slow = least * strength_;
    for (std::size_t k = 0; k < touching_.size(); ++k) {
      const int i = touching_[k];
      const auto& branch = branches[k];
      const double normal = rate_(i), tangential = rate_(m_ + i);
      const bool at_rest = velocity_(i) == 0.0 && !pushes(k);
      if (branch.normal == Branch::Normal::held && !(normal >= -least && normal <= 1.0 + least)) return false;
      if (branch.normal == Branch::Normal::open) {
        if (at_rest && change_(i) < -slow) return false;
        continue;
      }
      if (branch.normal == Branch::Normal::pushed && at_rest && change_(i) > -slow) return false;
      if (friction(i) == 0.0) continue;
      if (branch.slip == 0 && std::abs(tangential) > friction(i) * normal + least) return false;
      if (branch.slip != 0 && velocity_(m_ + i) == 0.0 && branch.slip * change_(m_ + i) < -slow) return false;
    }
    return true;
  }

  /// The branches that hold from here on, the first admissible ones of all combinations.
  bool choose() {
    std::vector<std::vector<Branch>> all;
    for (std::size_t k = 0; k < touching_.size(); ++k) all.push_back(options(k));
    std::vector<std::size_t> number(all.size(), 0);
    constexpr long most = 20000;
    for (long tried = 0; tried < most; ++tried) {
      branches_.clear();
      for (std::size_t k = 0; k < all.size(); ++k) branches_.push_back(all[k][number[k]]);
      if (admits(branches_)) return true;
      std::size_t k = 0;
      while (k < all.size() && ++number[k] == all[k].size()) number[k++] = 0;
      if (k == all.size()) return false;
    }
    return false;
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
      if (friction(i) > 0.0 && branches_[k].normal != Branch::Normal::open) zero(m_ + i);
      if (releasing_[k]) length = std::min(length, release_length(k));
    }
    return length;
  }

  /// (v + v' p/2) p = work.
  [[nodiscard]] double release_length(std::size_t k) const {
    const double v = velocity_(touching_[k]), rate = change_(touching_[k]);
    const double root = v * v + 2.0 * rate * stored_[k];
    return root >= 0.0 && v + std::sqrt(root) > 0.0 ? 2.0 * stored_[k] / (v + std::sqrt(root))
                                                    : std::numeric_limits<double>::infinity();
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
    velocity_ += length * change_;
    impulse_ += length * rate_;
    for (std::size_t k = 0; k < touching_.size(); ++k) {
      if (stored_[k] == 0.0) releasing_[k] = false;
      const int i = touching_[k];
      if (branches_[k].normal == Branch::Normal::held) velocity_(i) = 0.0;
      if (branches_[k].normal != Branch::Normal::open && friction(i) > 0.0 && branches_[k].slip == 0) {
        velocity_(m_ + i) = 0.0;
      }
    }
  }

  const ContactPoint& point_;
  const std::vector<int>& touching_;
  int m_;
  VectorXd velocity_, impulse_;
  VectorXd rate_, change_;      ///< of impulses and velocities in the piece
  std::vector<double> stored_;  ///< by touching contact: work to give back
  std::vector<bool> releasing_;
  std::vector<Branch> branches_;
  std::optional<int> forced_;
  double size_ = 0.0, strength_ = 0.0;  ///< of velocities; of the influence of a normal impulse
};

}  // namespace

std::optional<VectorXd> impact(const ContactPoint& point, const std::vector<int>& touching, std::optional<int> pushed) {
  if (touching.size() == 1 && point.friction[static_cast<std::size_t>(touching.front())] == 0.0) {
    const int i = touching.front();
    VectorXd impulse = VectorXd::Zero(2 * point.contacts());
    impulse(i) = -(1.0 + point.restitution[static_cast<std::size_t>(i)]) * point.velocity(i) / point.influence(i, i);
    return impulse;
  }
  return Process(point, touching).run(pushed);
}

}  // namespace saltus::event_integrator
