// Weights of regions that are sign patterns: of those that keep the same surfaces at zero as many as determine them.
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/base/contains.hpp"
#include "saltus/fesd_integrator/decide/nonnegative_solution.hpp"
#include "saltus/fesd_integrator/decide/transition.hpp"

namespace saltus::fesd_integrator {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Whether regions on both sides of one surface alone are told apart; all other differences are sums of these.
bool are_beside(const Part& part, int a, int b) {
  int different = 0;
  for (int k = 0; k < part.surfaces; ++k) different += part.side(a, k) != part.side(b, k) ? 1 : 0;
  return part.surfaces == 0 || different == 1;
}

}  // namespace

/// Weights >= 0 of the active regions of a set at (t, x) that keep its surfaces at zero; nullopt if there are none.
std::optional<Transition::Weights> Transition::find_weights(const Decision& decision, double t,
                                                            const std::vector<double>& x, const ActiveSet& set) {
  const std::size_t n = kernel_.selections(), n_x = kernel_.states();
  std::vector<int> active;
  for (const Part& part : parts_) {
    for (int j = part.first; part.simplex && j < part.first + part.count; ++j) {
      if (set.modes()[at(j)] == 0) active.push_back(j);
    }
  }
  std::vector<std::size_t> rows;
  for (std::size_t k = 0; k < set.sliding().size(); ++k) {
    const Sliding& entry = set.sliding()[k];
    if (entry.reference < 0) return std::nullopt;
    if (are_beside(parts_[at(part_of_[at(entry.selection)])], entry.selection, entry.reference)) rows.push_back(k);
  }
  Weights weights{std::vector<double>(n, 0.0), std::vector<double>(n_x), false};
  kernel_.evaluate(t, x.data(), weights.selections.data(), decision.held, values_);
  DenseMatrices memory;
  const FieldView view = field_view(values_, memory);
  const Eigen::Map<const MatrixXd> fields(view.f_selection, index(n_x), index(n));
  const Eigen::Map<const VectorXd> constant(view.f, index(n_x));
  MatrixXd A = MatrixXd::Zero(index(rows.size()), index(active.size()));
  VectorXd b = VectorXd::Zero(A.rows()), negligible = VectorXd::Constant(A.rows(), undecided);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const Sliding& entry = set.sliding()[rows[r]];
    const double size = std::max(size_[at(entry.selection)], size_[at(entry.reference)]);
    if (!(size > 0.0)) continue;
    VectorXd gradient(index(n_x));
    for (std::size_t i = 0; i < n_x; ++i) gradient[index(i)] = set.surface(rows[r], view.indicator_x + i * n) / size;
    b[index(r)] = -gradient.dot(constant) - set.surface(rows[r], view.indicator_t) / size;
    for (std::size_t c = 0; c < active.size(); ++c) A(index(r), index(c)) = gradient.dot(fields.col(active[c]));
    negligible[index(r)] += noise_[at(entry.selection)] / (decision.trial_length * size);
  }
  // The sum of the weights of each simplex is 1.
  for (const Part& part : parts_) {
    if (!part.simplex) continue;
    A.conservativeResize(A.rows() + 1, Eigen::NoChange);
    for (std::size_t c = 0; c < active.size(); ++c) {
      A(A.rows() - 1, index(c)) = part_of_[at(active[c])] == part_of_[at(part.first)] ? 1.0 : 0.0;
    }
    b.conservativeResize(A.rows());
    b[A.rows() - 1] = 1.0;
    negligible.conservativeResize(A.rows());
    negligible[A.rows() - 1] = undecided;
  }
  if (!A.allFinite() || !b.allFinite()) return std::nullopt;
  const VectorXd found = nonnegative_solution(A, b);
  if (((A * found - b).cwiseAbs().array() > negligible.array()).any()) return std::nullopt;
  Index positive = 0;
  for (std::size_t c = 0; c < active.size(); ++c) {
    const double weight = found[index(c)];
    weights.selections[at(active[c])] = weight;
    positive += weight > undecided ? 1 : 0;
  }
  weights.determined = positive == A.rows();
  kernel_.field(t, x.data(), weights.selections.data(), decision.held, weights.motion.data());
  return weights;
}

/// The patterns that stand for one whose regions are all between the same sides of surfaces: fewer of them, as many as
/// are determined, here or a little further along; and all of them, the weights of least norm.
std::vector<std::vector<int>> Transition::supports_of(const Decision& decision, const Group& group,
                                                      const std::vector<int>& pattern, const std::vector<int>& modes) {
  const ActiveSet face(parts_, modes);
  const auto is_regular = [&](const Sliding& entry) { return parts_[at(part_of_[at(entry.selection)])].surfaces > 0; };
  if (!std::any_of(face.sliding().begin(), face.sliding().end(), is_regular)) return {pattern};
  std::vector<std::vector<int>> found;
  std::vector<double> x(decision.x.begin(), decision.x.end()), motion(x.size(), 0.0);
  for (const double factor : {0.0, 1.0, 8.0}) {
    const double h = factor * decision.trial_length;
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = decision.x[i] + h * motion[i];
    const auto weights = find_weights(decision, decision.t + h, x, face);
    if (!weights && factor == 0.0) return {};
    if (!weights) break;
    motion = weights->motion;
    if (!weights->determined) continue;
    auto fewer = pattern;
    for (std::size_t k = 0; k < fewer.size(); ++k) {
      const int j = group.members[k];
      if (parts_[at(part_of_[at(j)])].surfaces > 0 && weights->selections[at(j)] <= undecided) fewer[k] = -1;
    }
    if (!contains(found, fewer)) found.push_back(std::move(fewer));
    if (factor == 0.0) break;
  }
  if (!contains(found, pattern)) found.push_back(pattern);
  return found;
}

}  // namespace saltus::fesd_integrator
