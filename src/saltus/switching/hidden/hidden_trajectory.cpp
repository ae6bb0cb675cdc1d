#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

#include "saltus/base/at.hpp"
#include "saltus/base/stop.hpp"
#include "saltus/ode/bernstein.hpp"
#include "saltus/switching/hidden/hidden_strip_internal.hpp"
#include "saltus/switching/hidden/hidden_trajectory_internal.hpp"

namespace saltus::switching {
namespace {

/// Relative to the largest velocity of a surface: below this it says nothing (switching.md's sign tests have 1e-10).
constexpr double vanishing = 1e-12;
/// Unstable states of rest one after the other; more are a continuum of them.
constexpr int most_nudges = 20;

}  // namespace

HiddenTrajectory::HiddenTrajectory(HiddenFace& face, const TrajectoryOptions& options)
    : face_(face),
      options_(options),
      m_(face.surfaces()),
      u_(at(m_)),
      v_(at(m_)),
      zone_(at(m_)),
      recurrence_(m_),
      low_(at(m_)),
      high_(at(m_)),
      point_(at(m_)),
      point_velocity_(at(m_)),
      derivatives_(at(m_ * m_)),
      rest_(face),
      samples_(at(m_ * ode::event_nodes)) {}

TrajectoryEnd HiddenTrajectory::follow(const std::vector<double>& u) {
  start_ = u;
  u_ = u;
  end_ = {};
  used_ = 0;
  stiff_ = false;
  h_ = 0.0;
  recurrence_.reset();
  enter_zones();
  nudges_ = 0;
  std::string_view stopped = "the hidden dynamics has no limit within its budget";
  while (used_ < options_.budget) {
    heed_stop();
    ++used_;
    face_.enter(zone_);
    face_.velocity(u_.data(), v_.data());
    if (!std::all_of(v_.begin(), v_.end(), [](double v) { return std::isfinite(v); })) {
      stopped = "the velocities are not finite";
      break;
    }
    if (nudges_ > most_nudges) {
      stopped = "the hidden dynamics rests wherever it is put";
      break;
    }
    const std::size_t free = face_.free().size();
    const bool closed_form = free == 0 || (free == 1 && options_.closed_forms);
    recurrence_.visit(zone_, closed_form);
    const Status status = free == 0 ? cross_corner() : closed_form ? cross_strip() : cross_interior();
    if (status == Status::ended) return end_;
  }
  end_.limit = HiddenLimit::undecided;
  end_.mode = zone_;
  end_.alpha.resize(at(m_));
  for (int j = 0; j < m_; ++j) end_.alpha[at(j)] = std::clamp(u_[at(j)], 0.0, 1.0);
  end_.reason = stopped;
  return end_;
}

double HiddenTrajectory::boundary(int j) const {
  return zone_[at(j)] > 0 || (zone_[at(j)] == 0 && u_[at(j)] > 0.5) ? 1.0 : 0.0;
}

std::uint64_t HiddenTrajectory::zone_number() const {
  std::uint64_t number = 0;
  for (const int z : zone_) number = 3 * number + static_cast<std::uint64_t>(z + 1);
  return number;
}

/// Zones at the start: on the boundary the velocity says whether a component moves in.
void HiddenTrajectory::enter_zones() {
  for (std::size_t j = 0; j < u_.size(); ++j) zone_[j] = u_[j] < 0.0 ? -1 : u_[j] > 1.0 ? 1 : 0;
  face_.enter(zone_);
  face_.velocity(u_.data(), v_.data());
  for (std::size_t j = 0; j < u_.size(); ++j) {
    if (u_[j] == 0.0 && v_[j] < 0.0) zone_[j] = -1;
    if (u_[j] == 1.0 && v_[j] > 0.0) zone_[j] = 1;
  }
}

/// u_j has reached a boundary with velocity v_: its new zone. Where the velocity vanishes there, it changes zone.
HiddenTrajectory::Status HiddenTrajectory::at_boundary(int j) {
  const double limit = boundary(j);
  u_[at(j)] = limit;
  const int outside = limit == 0.0 ? -1 : 1;
  const double outward = v_[at(j)] * outside;
  zone_[at(j)] = outward > 0.0 ? outside : outward < 0.0 ? 0 : zone_[at(j)] == 0 ? outside : 0;
  return pass_section(static_cast<std::uint64_t>(2 * j) + (outside > 0 ? 1 : 0));
}

HiddenTrajectory::Status HiddenTrajectory::pass_section(std::uint64_t event) {
  const Turn turn = recurrence_.pass(zone_number() * static_cast<std::uint64_t>(3 * m_) + event, u_, zone_);
  if (turn.kind == Turn::Kind::none) return Status::goes_on;
  if (turn.turns_to_skip > 0.0) {
    for (std::size_t j = 0; j < u_.size(); ++j) {
      if (turn.side[j] != 0) u_[j] += turn.turns_to_skip * turn.change[j];
    }
    return Status::goes_on;
  }
  end_.mode = turn.side;
  end_.alpha = turn.mean;
  if (turn.kind == Turn::Kind::spiral_out) {
    end_.limit = HiddenLimit::spirals_out;
    end_.reason = "the solution spirals out through all regions";
    return Status::ended;
  }
  const bool enclosed = enclosed_root(turn);
  // A cycle is further from the root that it surrounds, or from its mean, than from its own limit.
  double distance = 0.0;
  for (std::size_t j = 0; j < u_.size(); ++j) {
    if (turn.side[j] == 0) distance = std::max(distance, std::abs(u_[j] - end_.alpha[j]));
  }
  if (turn.remaining > 0.05 * distance) return Status::goes_on;
  if (!enclosed) {
    end_.limit = HiddenLimit::rootless;
    end_.reason = "the hidden dynamics is periodic about no selections that slide";
    return Status::ended;
  }
  end_.limit = HiddenLimit::oscillating;
  end_.reason = "the hidden dynamics is periodic: sliding, about which the regularised solution oscillates";
  return Status::ended;
}

/// Constant velocity: the first component that comes back, or all leave.
HiddenTrajectory::Status HiddenTrajectory::cross_corner() {
  double duration = infinite;
  int first = -1;
  for (int j = 0; j < m_; ++j) {
    const double towards = -zone_[at(j)] * v_[at(j)];
    if (!(towards > 0.0)) continue;
    const double t = std::abs(u_[at(j)] - boundary(j)) / towards;
    if (t < duration) {
      duration = t;
      first = j;
    }
  }
  if (first < 0) return settle("the hidden dynamics leaves every surface", v_.data());
  recurrence_.add_time(duration);
  for (int j = 0; j < m_; ++j) {
    u_[at(j)] += duration * v_[at(j)];
    recurrence_.add_selection(j, zone_[at(j)] > 0 ? duration : 0.0);
  }
  return at_boundary(first);
}

HiddenTrajectory::Status HiddenTrajectory::cross_strip() {
  const int free = face_.free().front();
  // NOTE: a step may have ended a rounding beyond an end of the strip, which the component would never reach from
  // there.
  u_[at(free)] = std::clamp(u_[at(free)], 0.0, 1.0);
  face_.derivatives(u_.data(), v_.data(), derivatives_.data());
  const StripMotion motion{u_[at(free)], v_[at(free)], derivatives_[at(free)]};
  if (motion.v0 == 0.0 && !(motion.rate < 0.0)) {
    perturb();
    return Status::goes_on;
  }
  const double exit = motion.v0 > 0.0 ? 1.0 : 0.0;
  const auto at_exit = motion.v0 == 0.0 ? std::nullopt : motion.time_to(exit);
  const double x_end = at_exit ? exit : motion.x0 - motion.v0 / motion.rate;
  double duration = at_exit.value_or(infinite);
  int first = at_exit ? free : -1;
  for (int j = 0; j < m_; ++j) {
    if (j == free) continue;
    const double inwards = -zone_[at(j)];
    const SaturatedMotion saturated{-std::abs(u_[at(j)] - boundary(j)), inwards * v_[at(j)],
                                    inwards * derivatives_[at(j)]};
    const double x_last = first == free || first < 0 ? x_end : motion.position(duration);
    const auto t = time_of_return(motion, saturated, duration, x_last);
    if (t && *t < duration) {
      duration = *t;
      first = j;
    }
  }
  if (first < 0) {
    u_[at(free)] = x_end;
    face_.velocity(u_.data(), v_.data());
    v_[at(free)] = 0.0;
    return settle("the hidden dynamics comes to rest on one surface: sliding", v_.data());
  }
  const double excursion = motion.integrated_excursion(duration);
  recurrence_.add_time(duration);
  for (int j = 0; j < m_; ++j) {
    if (j == free) continue;
    u_[at(j)] += v_[at(j)] * duration + derivatives_[at(j)] * excursion;
    recurrence_.add_selection(j, zone_[at(j)] > 0 ? duration : 0.0);
  }
  recurrence_.add_selection(free, motion.x0 * duration + excursion);
  u_[at(free)] = first == free ? exit : std::clamp(motion.position(duration), 0.0, 1.0);
  face_.velocity(u_.data(), v_.data());
  return at_boundary(first);
}

/// Resting where it need not stay: a nudge, upwards as on a single repelling surface.
void HiddenTrajectory::perturb() {
  constexpr double nudge = 1e-6;
  end_.nudged = true;
  ++nudges_;
  double size = nudge;
  for (const int j : face_.free()) {
    u_[at(j)] += u_[at(j)] < 0.5 ? size : u_[at(j)] > 1.0 - size ? -size : size;
    size *= 0.7;
  }
}

HiddenTrajectory::Status HiddenTrajectory::settle(std::string_view reason, const double* limit_velocity) {
  end_.limit = HiddenLimit::settled;
  end_.mode = zone_;
  end_.alpha.resize(at(m_));
  for (int j = 0; j < m_; ++j) {
    const int z = zone_[at(j)];
    end_.alpha[at(j)] = z == 0 ? u_[at(j)] : z > 0 ? 1.0 : 0.0;
    if (z != 0 && std::abs(limit_velocity[j]) <= vanishing * face_.speed(j)) end_.marginal = true;
  }
  end_.reason = reason;
  return Status::ended;
}

}  // namespace saltus::switching
