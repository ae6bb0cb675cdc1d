// Surfaces at zero whose gradients depend on each other: which are slid on and which are left.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/base/contains.hpp"
#include "saltus/fesd_integrator/decide/transition.hpp"
#include "saltus/switching/selections/selection_complementarity.hpp"
#include "saltus/switching/table/additive_map.hpp"
#include "saltus/switching/table/field_accuracy.hpp"
#include "saltus/switching/table/independent_rows.hpp"

namespace saltus::fesd_integrator {
namespace {

using linalg::Index;
using linalg::Matrix;
using linalg::Vector;

/// The functions at zero at a point, taken for zero: d psi / dt of all members from f.
struct Gradients {
  Matrix rows;  ///< members x n_x
  Vector rates;
};

Gradients gradients_of(const discretization::StageValues& values, const std::vector<int>& members) {
  const auto count = index(members.size());
  Gradients gradients{Matrix::zero(count, index(values.f.size())), Vector(count)};
  for (std::size_t k = 0; k < members.size(); ++k) {
    gradients.rates[index(k)] = values.indicator_t[at(members[k])];
    visit_row(values.pattern->indicator_x, values.indicator_x, at(members[k]),
              [&](std::size_t i, double gradient) { gradients.rows(index(k), index(i)) = gradient; });
  }
  return gradients;
}

}  // namespace

ActiveSet Transition::make_set(const Decision& decision, std::vector<int> modes) {
  ActiveSet set(parts_, std::move(modes));
  rests_.put_into(set);
  if (!depends_ || set.sliding().size() < 2) return set;
  std::vector<double> selections(kernel_.selections());
  const std::vector<double> middle(set.sliding().size(), 0.5);
  set.selections(middle.data(), selections.data());
  discretization::StageValues values;
  kernel_.size(values);
  kernel_.evaluate(decision.t, decision.x.data(), selections.data(), decision.held, values);
  DenseMatrices memory;
  static_cast<void>(find_balances(field_view(values, memory), set));
  return set;
}

/// The members of a group that move the state, by their jumps of f; kinks, and functions of outputs alone, follow.
Transition::Dependent Transition::split_by_action(const Decision& decision, const std::vector<int>& modes,
                                                  const Group& group) {
  Dependent split;
  split.selections.resize(kernel_.selections());
  const std::vector<double> nothing(kernel_.selections(), 0.0);
  ActiveSet(parts_, modes).selections(nothing.data(), split.selections.data());
  for (const int j : group.members) split.selections[at(j)] = side_before(decision, j) < 0 ? 0.0 : 1.0;
  kernel_.evaluate(decision.t, decision.x.data(), split.selections.data(), decision.held, values_);
  Vector terms = linalg::ConstView(values_.f).abs();
  DenseMatrices memory;
  const linalg::ConstView jumps(field_view(values_, memory).f_selection, index(kernel_.states()),
                                index(kernel_.selections()));
  for (const int j : group.members) terms += jumps.col(j).abs();
  for (const int j : group.members) {
    const bool acts = linalg::any_beyond(jumps.col(j), switching::field_accuracy * terms);
    (acts ? split.acting : split.followers).push_back(j);
  }
  return split;
}

int Transition::side_before(const Decision& decision, int j) {
  return decision.before == nullptr ? 0 : decision.before->modes()[at(j)];
}

/// The pattern by the complementarity problem of the acting members at (t, x), into the group.
/// @return its motion; nullopt where selections multiply each other
std::optional<std::vector<double>> Transition::solve_dependent(const Decision& decision, double t,
                                                               const std::vector<double>& x, Dependent& split,
                                                               Group& group) {
  std::vector<double> f(x.size());
  const auto field = [&](const std::vector<double>& alpha, Vector& value) {
    for (std::size_t i = 0; i < split.acting.size(); ++i) split.selections[at(split.acting[i])] = alpha[i];
    kernel_.field(t, x.data(), split.selections.data(), decision.held, f.data());
    value = linalg::ConstView(f);
  };
  const auto map = switching::additive_map(split.acting.size(), field);
  if (!map || !map->constant.all_finite() || !map->effects.all_finite()) return std::nullopt;
  kernel_.evaluate(t, x.data(), split.selections.data(), decision.held, values_);
  const auto gradients = gradients_of(values_, split.acting);
  const auto solution = switching::solve_complementarity(
      gradients.rows * map->effects, gradients.rows * map->constant + gradients.rates, switching::field_accuracy);
  const Vector moves = map->constant + map->effects * solution.lambda;
  const auto follow = gradients_of(values_, split.followers);
  std::vector<int> pattern;
  for (const int j : group.members) {
    const auto acting = std::find(split.acting.begin(), split.acting.end(), j);
    if (acting != split.acting.end()) {
      pattern.push_back(solution.mode[at(acting - split.acting.begin())]);
      continue;
    }
    const auto k = std::find(split.followers.begin(), split.followers.end(), j) - split.followers.begin();
    const double velocity = follow.rows.row(k).dot(moves) + follow.rates[k];
    const double size = follow.rows.row(k).abs().dot(moves.abs()) + std::abs(follow.rates[k]);
    const bool goes = std::abs(velocity) > switching::field_accuracy * size;
    pattern.push_back(goes ? (velocity > 0.0 ? 1 : -1) : side_before(decision, j) < 0 ? -1 : 1);
  }
  if (group.patterns.empty()) group.decided = solution.unique_velocity;
  if (!contains(group.patterns, pattern)) {
    group.patterns.push_back(std::move(pattern));
  }
  return std::vector<double>(moves.data(), moves.data() + moves.size());
}

/// Patterns of a group with surfaces whose gradients depend on each other: by the complementarity problem here, then by
/// those a little further along the motion that the first one has. Functions that move nothing follow.
/// @param modes  of all, as for the enumeration
/// @return false if it is none, or selections multiply each other
bool Transition::find_dependent(const Decision& decision, const std::vector<int>& modes, Group& group) {
  if (group.members.size() < 2 || std::any_of(group.members.begin(), group.members.end(),
                                              [&](int j) { return parts_[at(part_of_[at(j)])].simplex; })) {
    return false;
  }
  Dependent split = split_by_action(decision, modes, group);
  const auto own = gradients_of(values_, split.acting);
  if (split.acting.size() < 2 || switching::independent_rows(own.rows).size() == split.acting.size()) return false;
  const std::vector<double> x(decision.x.begin(), decision.x.end());
  const auto motion = solve_dependent(decision, decision.t, x, split, group);
  if (!motion) return false;
  auto ahead = x;
  for (const double factor : {1.0, 8.0, 64.0}) {
    const double h = factor * decision.trial_length;
    for (std::size_t i = 0; i < x.size(); ++i) ahead[i] = x[i] + h * (*motion)[i];
    if (!solve_dependent(decision, decision.t + h, ahead, split, group)) break;
  }
  group.dependent = true;
  return true;
}

}  // namespace saltus::fesd_integrator
