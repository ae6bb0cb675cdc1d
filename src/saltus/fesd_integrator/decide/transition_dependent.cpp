// Surfaces at zero whose gradients depend on each other: which are slid on and which are left.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/fesd_integrator/decide/transition.hpp"
#include "saltus/switching/selections/selection_complementarity.hpp"
#include "saltus/switching/table/additive_map.hpp"
#include "saltus/switching/table/field_accuracy.hpp"
#include "saltus/switching/table/independent_rows.hpp"

namespace saltus::fesd_integrator {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The functions at zero at a point, taken for zero: d psi / dt of all members from f.
struct Gradients {
  MatrixXd rows;  ///< members x n_x
  VectorXd rates;
};

Gradients gradients_of(const discretization::StageValues& values, const std::vector<int>& members) {
  const std::size_t n = values.indicator.size(), n_x = values.f.size();
  Gradients gradients{MatrixXd(index(members.size()), index(n_x)), VectorXd(index(members.size()))};
  for (std::size_t k = 0; k < members.size(); ++k) {
    gradients.rates[index(k)] = values.indicator_t[at(members[k])];
    for (std::size_t i = 0; i < n_x; ++i) {
      gradients.rows(index(k), index(i)) = values.indicator_x[i * n + at(members[k])];
    }
  }
  return gradients;
}

}  // namespace

ActiveSet Transition::make_set(const Decision& decision, std::vector<int> modes) {
  ActiveSet set(parts_, std::move(modes));
  if (!depends_ || set.sliding().size() < 2) return set;
  std::vector<double> selections(kernel_.selections());
  const std::vector<double> middle(set.sliding().size(), 0.5);
  set.selections(middle.data(), selections.data());
  discretization::StageValues values;
  kernel_.size(values);
  kernel_.evaluate(decision.t, decision.x.data(), selections.data(), decision.held, values);
  static_cast<void>(find_balances(field_view(values), set));
  return set;
}

/// Patterns of a group with surfaces whose gradients depend on each other: by the complementarity problem here, then by
/// those a little further along the motion that the first one has. Functions that move nothing follow.
/// @param modes  of all, as for the enumeration
/// @return false if it is none, or selections multiply each other
bool Transition::find_dependent(const Decision& decision, const std::vector<int>& modes, Group& group) {
  const std::size_t n_x = kernel_.states(), m = group.members.size();
  if (m < 2 || std::any_of(group.members.begin(), group.members.end(),
                           [&](int j) { return parts_[at(part_of_[at(j)])].simplex; })) {
    return false;
  }
  std::vector<double> selections(kernel_.selections());
  const std::vector<double> nothing(kernel_.selections(), 0.0);
  ActiveSet(parts_, modes).selections(nothing.data(), selections.data());
  const auto side_before = [&](int j) { return decision.before == nullptr ? 0 : decision.before->modes()[at(j)]; };
  for (const int j : group.members) selections[at(j)] = side_before(j) < 0 ? 0.0 : 1.0;
  discretization::StageValues values;
  kernel_.size(values);

  // What acts: kinks, and functions of outputs alone, do not.
  kernel_.evaluate(decision.t, decision.x.data(), selections.data(), decision.held, values);
  VectorXd terms = Eigen::Map<const VectorXd>(values.f.data(), index(n_x)).cwiseAbs();
  const Eigen::Map<const MatrixXd> jumps(values.f_selection.data(), index(n_x), index(kernel_.selections()));
  for (const int j : group.members) terms += jumps.col(j).cwiseAbs();
  std::vector<int> acting, followers;
  for (const int j : group.members) {
    const bool acts = (jumps.col(j).cwiseAbs().array() > switching::field_accuracy * terms.array()).any();
    (acts ? acting : followers).push_back(j);
  }
  const auto own = gradients_of(values, acting);
  if (acting.size() < 2 || switching::independent_rows(own.rows).size() == acting.size()) return false;

  std::vector<double> f(n_x);
  const auto decide_at = [&](double t, const std::vector<double>& x, std::vector<double>& motion) {
    const auto field = [&](const std::vector<double>& alpha, VectorXd& value) {
      for (std::size_t i = 0; i < acting.size(); ++i) selections[at(acting[i])] = alpha[i];
      kernel_.field(t, x.data(), selections.data(), decision.held, f.data());
      value = Eigen::Map<const VectorXd>(f.data(), index(n_x));
    };
    const auto map = switching::additive_map(acting.size(), field);
    if (!map || !map->constant.allFinite() || !map->effects.allFinite()) return false;
    kernel_.evaluate(t, x.data(), selections.data(), decision.held, values);
    const auto gradients = gradients_of(values, acting);
    const auto solution = switching::solve_complementarity(
        gradients.rows * map->effects, gradients.rows * map->constant + gradients.rates, switching::field_accuracy);
    const VectorXd moves = map->constant + map->effects * solution.lambda;
    motion.assign(moves.data(), moves.data() + moves.size());
    const auto follow = gradients_of(values, followers);
    std::vector<int> pattern;
    for (const int j : group.members) {
      if (const auto k = std::find(acting.begin(), acting.end(), j); k != acting.end()) {
        pattern.push_back(solution.mode[at(k - acting.begin())]);
        continue;
      }
      const auto k = std::find(followers.begin(), followers.end(), j) - followers.begin();
      const double velocity = follow.rows.row(k) * moves + follow.rates[k];
      const double size = follow.rows.row(k).cwiseAbs() * moves.cwiseAbs() + std::abs(follow.rates[k]);
      const bool goes = std::abs(velocity) > switching::field_accuracy * size;
      pattern.push_back(goes ? (velocity > 0.0 ? 1 : -1) : side_before(j) < 0 ? -1 : 1);
    }
    if (group.patterns.empty()) group.decided = solution.unique_velocity;
    if (std::find(group.patterns.begin(), group.patterns.end(), pattern) == group.patterns.end()) {
      group.patterns.push_back(std::move(pattern));
    }
    return true;
  };
  const std::vector<double> x(decision.x.begin(), decision.x.end());
  std::vector<double> motion, ignored, ahead(n_x);
  if (!decide_at(decision.t, x, motion)) return false;
  for (const double factor : {1.0, 8.0, 64.0}) {
    const double h = factor * decision.trial_length;
    for (std::size_t i = 0; i < n_x; ++i) ahead[i] = x[i] + h * motion[i];
    if (!decide_at(decision.t + h, ahead, ignored)) break;
  }
  group.dependent = true;
  return true;
}

}  // namespace saltus::fesd_integrator
