#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "saltus/switching/hidden/hidden_recurrence_internal.hpp"
#include "saltus/switching/hidden/hidden_trajectory_internal.hpp"

namespace saltus::switching {
namespace {

constexpr double close = 1e-6;               ///< a thousand times the integration's tolerance
constexpr double rounding_of_turns = 1e-12;  ///< of closed forms, some turns long
constexpr double shrinking = 0.9;            ///< a factor per turn that truncation errors do not imitate
constexpr double affine_match = 1e-6;        ///< to which two factors of an affine return map agree
constexpr double large = 1e6;                ///< times the cube: what happens inside it no longer matters
constexpr double growing = 1.001;            ///< per turn, at large amplitudes
constexpr double neutral = 1e-7;             ///< factors closer to 1 are not told from it
/// Of the durations of successive turns of a limit cycle. What slides along one surface before it enters the square
/// comes in at one point, closer and closer from turn to turn. Its turns grow all the same (by a third and more, or
/// they spiral in or out more slowly and are told by their factors).
constexpr double same_period = 0.01;

double excursion(double u) { return std::max({0.0, -u, u - 1.0}); }

}  // namespace

Recurrence::Recurrence(int surfaces)
    : last_free_(static_cast<std::size_t>(surfaces)), integral_(static_cast<std::size_t>(surfaces)) {
  reset();
}

void Recurrence::reset() {
  next_ = 0;
  count_ = 0;
  last_interior_ = -1;
  time_ = 0.0;
  std::fill(last_free_.begin(), last_free_.end(), -1);
  std::fill(integral_.begin(), integral_.end(), 0.0);
}

void Recurrence::visit(const std::vector<int>& zone, bool closed_form) {
  ++count_;
  for (std::size_t j = 0; j < zone.size(); ++j) {
    if (zone[j] == 0) last_free_[j] = count_;
  }
  if (!closed_form) last_interior_ = count_;
}

/// The smallest number of turns like this one after which a component that stays beyond the cube would come back.
double Recurrence::turns_back(std::size_t now_number, std::size_t before_number, const std::vector<int>& zone) {
  const double* u = u_of(now_number);
  const double* u_before = u_of(before_number);
  double back = infinite;
  for (std::size_t j = 0; j < zone.size(); ++j) {
    const double change = u[j] - u_before[j];
    if (last_free_[j] < passage(before_number).count && !(change * zone[j] > 0.0)) {
      back = std::min(back, excursion(u[j]) / std::abs(change));
    }
  }
  return back;
}

/// Notes how far this passage is from one before it, and how that changes.
void Recurrence::measure(std::size_t now_number, std::size_t before_number, std::size_t lag) {
  Passage& now = passage(now_number);
  const Passage& before = passage(before_number);
  double distance = 0.0;
  for (std::size_t j = 0; j < integral_.size(); ++j) {
    const double change = u_of(now_number)[j] - u_of(before_number)[j];
    if (last_free_[j] >= before.count) distance = std::max(distance, std::abs(change));
  }
  now.distance[lag] = distance;
  now.ratio[lag] = before.distance[lag] > 0.0 ? distance / before.distance[lag] : 0.0;
  now.compared[lag] = before.compared[lag] + 1;
  now.period[lag] = now.time - before.time;
}

/// What the turn from one passage to the next says, and what is left of it.
std::pair<Turn::Kind, double> Recurrence::kind_of(const Passage& now, const Passage& before, std::size_t lag) const {
  const double distance = now.distance[lag];
  const double ratio = now.ratio[lag];
  const double ratio_before = before.ratio[lag];
  const double size = 1.0 + now.amplitude;
  if (now.compared[lag] > 1 && std::max(distance, before.distance[lag]) <= rounding_of_turns * size) {
    return {Turn::Kind::cycle, distance};
  }
  if (now.compared[lag] <= 2) return {Turn::Kind::none, 0.0};
  // The section was passed twice before, and only closed-form zones were visited during the turns in between.
  const bool affine = std::abs(ratio - ratio_before) <= affine_match * ratio &&
                      last_interior_ < before.count - 2 * (now.count - before.count);
  const bool grows =
      (affine && ratio > 1.0 + neutral) || (now.amplitude > large && std::min(ratio, ratio_before) > growing);
  if (grows && now.amplitude > before.amplitude) return {Turn::Kind::spiral_out, 0.0};
  const bool periodic = std::abs(now.period[lag] - before.period[lag]) <= same_period * now.period[lag];
  const double remaining = distance * ratio / (1.0 - ratio);
  const bool shrinks = distance <= close * size && std::max(ratio, ratio_before) <= shrinking && periodic;
  if (shrinks || (affine && ratio < 1.0 - neutral && remaining < 0.01 * size)) return {Turn::Kind::cycle, remaining};
  return {Turn::Kind::none, 0.0};
}

Turn Recurrence::compare(std::size_t now_number, std::size_t before_number, std::size_t lag,
                         const std::vector<int>& zone) {
  Turn turn;
  measure(now_number, before_number, lag);
  const Passage& now = passage(now_number);
  const Passage& before = passage(before_number);
  std::tie(turn.kind, turn.remaining) = kind_of(now, before, lag);
  if (turn.kind == Turn::Kind::none) return turn;
  if (const double back = turns_back(now_number, before_number, zone); back < infinite) {
    // Two turns are left to be followed, since the cycle is known up to `remaining` only.
    turn.turns_to_skip = std::floor(back) - 2.0;
    if (turn.kind == Turn::Kind::spiral_out || !(turn.turns_to_skip >= 1.0)) return {};
  }
  const std::size_t m = integral_.size();
  turn.change.resize(m);
  turn.side.resize(m);
  turn.mean.resize(m);
  for (std::size_t j = 0; j < m; ++j) {
    turn.side[j] = last_free_[j] >= before.count ? 0 : zone[j];
    turn.change[j] = u_of(now_number)[j] - u_of(before_number)[j];
    turn.mean[j] = (integral_of(now_number)[j] - integral_of(before_number)[j]) / (now.time - before.time);
  }
  return turn;
}

Turn Recurrence::pass(std::uint64_t section, const std::vector<double>& u, const std::vector<int>& zone) {
  if (next_ < remembered && next_ >= passages_.size()) {
    passages_.emplace_back();
    values_.resize(values_.size() + 2 * u.size());
  }
  Passage& now = passage(next_);
  now.section = section;
  now.count = count_;
  now.time = time_;
  now.amplitude = 0.0;
  for (std::size_t j = 0; j < u.size(); ++j) {
    u_of(next_)[j] = u[j];
    integral_of(next_)[j] = integral_[j];
    now.amplitude = std::max(now.amplitude, excursion(u[j]));
  }
  now.distance.fill(0.0);
  now.ratio.fill(0.0);
  now.period.fill(0.0);
  now.compared.fill(0);
  Turn found;
  std::size_t lag = 0;
  const std::size_t oldest = next_ >= remembered ? next_ - remembered + 1 : 0;
  for (std::size_t i = next_; i > oldest && lag < lags && found.kind == Turn::Kind::none; --i) {
    if (passage(i - 1).section == section) found = compare(next_, i - 1, lag++, zone);
  }
  ++next_;
  return found;
}

}  // namespace saltus::switching
