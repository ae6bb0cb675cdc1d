// Weights of regions that are sign patterns: of those that keep the same surfaces at zero as many as determine them.
#include <algorithm>
#include <numeric>
#include <optional>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/base/contains.hpp"
#include "saltus/fesd_integrator/decide/transition.hpp"
#include "saltus/linalg/factors.hpp"
#include "saltus/switching/point/nonnegative_solution.hpp"

namespace saltus::fesd_integrator {
namespace {

using linalg::Index;
using linalg::Matrix;
using linalg::Vector;

/// Whether regions are on the two sides of one surface; all other differences are sums of these.
bool are_beside(const Part& part, int a, int b) {
  int different = 0;
  for (int k = 0; k < part.surfaces; ++k) different += part.side(a, k) != part.side(b, k) ? 1 : 0;
  return part.surfaces == 0 || different == 1;
}

std::vector<int> active_regions(std::span<const Part> parts, const ActiveSet& set) {
  std::vector<int> active;
  for (const Part& part : parts) {
    for (int j = part.first; part.simplex && j < part.first + part.count; ++j) {
      if (set.modes()[at(j)] == 0) active.push_back(j);
    }
  }
  return active;
}

/// How many of the surfaces of a set are independent.
Index independent_surfaces(const ActiveSet& set, const FieldView& view) {
  constexpr double unequal = 1e-9;
  Matrix gradients(index(set.sliding().size()), index(view.n_x));
  for (std::size_t k = 0; k < set.sliding().size(); ++k) {
    for (std::size_t i = 0; i < view.n_x; ++i) {
      gradients(index(k), index(i)) = set.surface(k, view.indicator_x + i * view.n);
    }
  }
  for (Index k = 0; k < gradients.rows(); ++k) gradients.row(k) = gradients.row(k).normalized();
  linalg::PivotedQr factors(gradients);
  factors.set_threshold(unequal);
  return factors.rank();
}

}  // namespace

/// The equations of the weights of active regions at (t, x): rates of the surfaces that a set keeps at zero, relative
/// to their sizes, and one sum for each simplex.
Transition::WeightEquations Transition::weight_equations(const Decision& decision, double t,
                                                         const std::vector<double>& x, const ActiveSet& set,
                                                         const std::vector<int>& active) {
  const std::size_t n_x = kernel_.states(), n = kernel_.selections();
  // Fields of regions without any weight may not be there: their branches are guarded.
  std::vector<double> middle(n);
  set.selections(set.middle().data(), middle.data());
  kernel_.evaluate(t, x.data(), middle.data(), decision.held, values_);
  DenseMatrices memory;
  const FieldView view = field_view(values_, memory);
  const linalg::ConstView fields(view.f_selection, index(n_x), index(n));
  Vector constant = linalg::ConstView(view.f, index(n_x));
  for (const int j : active) constant.add_scaled(-middle[at(j)], fields.col(j));
  WeightEquations equations;
  const auto add = [&](double right, double negligible) {
    const Index row = equations.matrix.rows();
    equations.matrix.resize_and_keep(row + 1, index(active.size()));
    equations.right.resize_and_keep(row + 1);
    equations.negligible.resize_and_keep(row + 1);
    equations.right[row] = right;
    equations.negligible[row] = negligible;
    return row;
  };
  Vector gradient(index(n_x));
  for (std::size_t k = 0; k < set.sliding().size(); ++k) {
    const Sliding& entry = set.sliding()[k];
    const double size = std::max(size_[at(entry.selection)], size_[at(entry.reference)]);
    if (!(size > 0.0)) continue;
    if (!are_beside(parts_[at(part_of_[at(entry.selection)])], entry.selection, entry.reference)) continue;
    for (std::size_t i = 0; i < n_x; ++i) gradient[index(i)] = set.surface(k, view.indicator_x + i * n) / size;
    const double free = gradient.dot(constant) + set.surface(k, view.indicator_t) / size;
    const Index row = add(-free, undecided + noise_[at(entry.selection)] / (decision.trial_length * size));
    for (std::size_t c = 0; c < active.size(); ++c) {
      equations.matrix(row, index(c)) = gradient.dot(fields.col(active[c]));
    }
  }
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    if (!parts_[p].simplex) continue;
    const Index row = add(1.0, undecided);
    for (std::size_t c = 0; c < active.size(); ++c) {
      equations.matrix(row, index(c)) = part_of_[at(active[c])] == static_cast<int>(p) ? 1.0 : 0.0;
    }
  }
  return equations;
}

/// A pattern without the regions whose weights of least norm are negative, one after the other; as it is where none
/// would be left.
std::vector<int> Transition::without_negative(const Decision& decision, const Group& group,
                                              const std::vector<int>& pattern, std::vector<int> modes) {
  put(group, pattern, modes);
  const ActiveSet face = make_set(decision, std::move(modes));
  const auto active = active_regions(parts_, face);
  const std::vector<double> x(decision.x.begin(), decision.x.end());
  const auto [matrix, right, negligible] = weight_equations(decision, decision.t, x, face, active);
  std::vector<Index> columns(active.size());
  std::iota(columns.begin(), columns.end(), Index{0});
  auto fewer = pattern;
  while (columns.size() > 1) {
    const Matrix some = matrix.selected_cols(columns);
    const Vector weights = linalg::least_squares(some, right);
    if (linalg::any_beyond(some * weights - right, negligible)) return pattern;
    const Index least = weights.index_of_min();
    if (weights[least] >= -undecided) return fewer;
    const auto place = std::find(group.members.begin(), group.members.end(), active[at(columns[at(least)])]);
    if (place == group.members.end()) return pattern;
    fewer[at(place - group.members.begin())] = -1;
    columns.erase(columns.begin() + least);
  }
  return pattern;
}

/// Weights >= 0 of the active regions of a set at (t, x) that keep its surfaces at zero; nullopt if there are none.
std::optional<Transition::Weights> Transition::find_weights(const Decision& decision, double t,
                                                            const std::vector<double>& x, const ActiveSet& set) {
  Weights weights{std::vector<double>(kernel_.selections(), 0.0), std::vector<double>(x.size())};
  const auto active = active_regions(parts_, set);
  const auto [matrix, right, negligible] = weight_equations(decision, t, x, set, active);
  if (!matrix.all_finite() || !right.all_finite()) return std::nullopt;
  const Vector found = switching::nonnegative_solution(matrix, right);
  if (linalg::any_beyond(matrix * found - right, negligible)) return std::nullopt;
  for (std::size_t c = 0; c < active.size(); ++c) weights.selections[at(active[c])] = found[index(c)];
  kernel_.field(t, x.data(), weights.selections.data(), decision.held, weights.motion.data());
  return weights;
}

/// The regions of a pattern that have these weights, if they are as many as keep all its surfaces at zero.
std::optional<std::vector<int>> Transition::fewer_regions(const Decision& decision, const Group& group,
                                                          const std::vector<int>& pattern, const Weights& weights,
                                                          const ActiveSet& face) {
  auto fewer = pattern;
  auto modes = face.modes();
  for (std::size_t k = 0; k < fewer.size(); ++k) {
    const int j = group.members[k];
    if (parts_[at(part_of_[at(j)])].surfaces > 0 && weights.selections[at(j)] <= undecided) fewer[k] = -1;
  }
  put(group, fewer, modes);
  const ActiveSet set = make_set(decision, modes);
  DenseMatrices memory;
  const FieldView view = field_view(values_, memory);
  const Index kept = independent_surfaces(face, view);
  if (index(set.sliding().size()) != kept || independent_surfaces(set, view) != kept) return std::nullopt;
  return fewer;
}

/// What stands for a pattern whose regions are all between the same sides of surfaces: fewer of them that determine
/// their weights, here or a little further along, and all of them with the weights of least norm.
std::vector<Transition::Support> Transition::supports_of(const Decision& decision, const Group& group,
                                                         const std::vector<int>& pattern,
                                                         const std::vector<int>& modes) {
  const ActiveSet face = make_set(decision, modes);
  const bool alone = std::none_of(face.sliding().begin(), face.sliding().end(), [&](const Sliding& entry) {
    return parts_[at(part_of_[at(entry.selection)])].surfaces > 0;
  });
  if (alone) return {{pattern, true}};
  std::vector<Support> found;
  std::vector<double> x(decision.x.begin(), decision.x.end()), motion;
  for (const double factor : {0.0, 1.0, 8.0}) {
    const double h = factor * decision.trial_length;
    for (std::size_t i = 0; i < motion.size(); ++i) x[i] = decision.x[i] + h * motion[i];
    const auto weights = find_weights(decision, decision.t + h, x, face);
    if (!weights && factor == 0.0) return {};
    if (!weights) break;
    motion = weights->motion;
    auto fewer = fewer_regions(decision, group, pattern, *weights, face);
    const auto is_known = [&](const Support& other) { return other.pattern == *fewer; };
    if (fewer && std::none_of(found.begin(), found.end(), is_known)) found.push_back({std::move(*fewer), true});
    if (fewer && factor == 0.0) break;
  }
  if (!found.empty() && found.front().pattern == pattern) return found;
  constexpr std::size_t most = 3;  // of four regions at most: whether others have weights, too, and move otherwise
  if (found.empty()) {
    found.push_back({pattern, false, std::move(motion)});
  } else if (face.sliding().size() <= most) {
    found.push_back({pattern, false});
  }
  return found;
}

}  // namespace saltus::fesd_integrator
