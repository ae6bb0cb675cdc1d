#include "saltus/fesd_integrator/decide/rests.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Core>

#include "saltus/base/at.hpp"

namespace saltus::fesd_integrator {
namespace {

using Eigen::VectorXd;

VectorXd gradient_of(int j, const discretization::StageValues& at_point) {
  VectorXd gradient = VectorXd::Zero(index(at_point.f.size()));
  visit_row(at_point.pattern->indicator_x, at_point.indicator_x, at(j),
            [&](std::size_t i, double value) { gradient[index(i)] = value; });
  return gradient;
}

}  // namespace

Rests::Rests(const discretization::StageKernel& kernel)
    : kernel_(kernel), governors_(kernel.selections(), -1), sides_(kernel.selections(), 0) {
  for (auto* values : {&values_, &ahead_, &behind_}) kernel.size(*values);
}

/// The values in the middle of all selections, and a little ahead of the point and behind it along f.
void Rests::find_slopes(const Place& place) {
  selections_.assign(kernel_.selections(), 0.5);
  kernel_.evaluate(place.t, place.x.data(), selections_.data(), place.held, values_);
  double fastest = 0.0;
  for (const double rate : values_.f) fastest = std::max(fastest, std::abs(rate));
  constexpr double small = 1e-6;
  step_ = fastest > 0.0 ? small * place.size / fastest : 0.0;
  std::vector<double> x(place.x.size());
  for (const double sign : {1.0, -1.0}) {
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = place.x[i] + sign * step_ * values_.f[i];
    kernel_.evaluate(place.t, x.data(), selections_.data(), place.held, sign > 0.0 ? ahead_ : behind_);
  }
}

/// Whether d psi_j / dt is zero and has the gradient of psi_r times c > 0, but for a multiple of that of psi_j.
bool Rests::follows(int j, int r, double size) const {
  const VectorXd own = gradient_of(j, values_), other = gradient_of(r, values_);
  VectorXd slope = VectorXd::Zero(own.size());
  if (step_ > 0.0) slope = (gradient_of(j, ahead_) - gradient_of(j, behind_)) / (2.0 * step_);
  for (Eigen::Index k = 0; k < own.size(); ++k) {
    visit_column(values_.pattern->f_x, values_.f_x, static_cast<std::size_t>(k),
                 [&](std::size_t i, double value) { slope[k] += own[index(i)] * value; });
  }
  const double rate = own.dot(Eigen::Map<const VectorXd>(values_.f.data(), own.size()));
  constexpr double zero = 1e-9;
  if (std::abs(rate) > zero * size * slope.cwiseAbs().maxCoeff()) return false;
  const double oo = own.squaredNorm(), ou = own.dot(other), uu = other.squaredNorm();
  const double determinant = oo * uu - ou * ou;
  if (!(determinant > 1e-12 * oo * uu)) return false;
  const double of_own = (uu * own.dot(slope) - ou * other.dot(slope)) / determinant;
  const double of_other = (oo * other.dot(slope) - ou * own.dot(slope)) / determinant;
  constexpr double rounding = 1e-6;  // of differences
  const VectorXd rest = slope - of_own * own - of_other * other;
  return of_other > 0.0 && rest.cwiseAbs().maxCoeff() <= rounding * slope.cwiseAbs().maxCoeff();
}

/// The sides of `of` on which the selection of `other` acts on nothing.
std::vector<int> Rests::idle_sides(const Place& place, int of, int other) {
  std::vector<int> idle;
  for (const int side : {1, -1}) {
    selections_.assign(kernel_.selections(), 0.5);
    selections_[at(of)] = side > 0 ? 1.0 : 0.0;
    kernel_.evaluate(place.t, place.x.data(), selections_.data(), place.held, ahead_);
    bool acts = false;
    visit_column(ahead_.pattern->f_selection, ahead_.f_selection, at(other),
                 [&](std::size_t, double value) { acts = acts || value != 0.0; });
    if (!acts) idle.push_back(side);
  }
  return idle;
}

void Rests::find(const Place& place, std::span<const Part> parts, const std::vector<int>& members) {
  std::fill(governors_.begin(), governors_.end(), -1);
  std::vector<bool> is_step(kernel_.selections(), false);
  for (const Part& part : parts) {
    for (int j = part.first; j < part.first + part.count; ++j) is_step[at(j)] = !part.simplex;
  }
  std::vector<int> steps;
  for (const int j : members) {
    if (is_step[at(j)]) steps.push_back(j);
  }
  if (steps.size() < 2) return;
  find_slopes(place);
  std::vector<std::pair<int, int>> pairs;
  for (const int j : steps) {
    if (values_.indicator_t[at(j)] != 0.0) continue;
    const auto r = std::find_if(steps.begin(), steps.end(), [&](int k) { return k != j && follows(j, k, place.size); });
    if (r != steps.end()) pairs.emplace_back(j, *r);
  }
  for (const auto& [j, r] : pairs) {
    const auto idle = idle_sides(place, j, r), own = idle_sides(place, r, j);
    if (idle.size() != 1 || (!own.empty() && own != idle)) continue;
    governors_[at(j)] = r;
    sides_[at(j)] = own.empty() ? 0 : -idle.front();
  }
}

bool Rests::any() const {
  return std::any_of(governors_.begin(), governors_.end(), [](int governor) { return governor >= 0; });
}

bool Rests::allow(const std::vector<int>& members, std::span<const int> modes) const {
  for (std::size_t k = 0; k < modes.size(); ++k) {
    const int j = members[k];
    const auto found = std::find(members.begin(), members.begin() + index(modes.size()), governor(j));
    if (found == members.begin() + index(modes.size())) continue;
    const int mode = modes[at(found - members.begin())];
    if (modes[k] != (mode != 0 ? mode : sides_[at(j)])) return false;
  }
  return true;
}

void Rests::put_into(ActiveSet& set) const {
  std::vector<int> list;
  const std::vector<int>& modes = set.modes();
  for (std::size_t j = 0; j < governors_.size(); ++j) {
    if (governors_[j] < 0 || modes[at(governors_[j])] != 0) continue;
    if ((modes[j] == 0) == (sides_[j] == 0)) list.push_back(static_cast<int>(j));
  }
  for (const int j : list) {
    if (sides_[at(j)] == 0) set.hold(j, governors_[at(j)]);
  }
  set.set_resting(std::move(list));
}

}  // namespace saltus::fesd_integrator
