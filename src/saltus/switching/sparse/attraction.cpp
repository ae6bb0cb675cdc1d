#include "saltus/switching/sparse/attraction.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/linalg/matrix.hpp"
#include "saltus/linalg/sparse_factors.hpp"
#include "saltus/switching/table/field_accuracy.hpp"

namespace saltus::switching {
namespace {

using linalg::Vector;
using SparseSquare = linalg::SparseColumns;

/// Changes each entry of a matrix to change(row, column, value).
template <class Change>
void change_entries(SparseSquare& matrix, const Change& change) {
  const auto start = matrix.start(), rows = matrix.inner();
  const auto values = matrix.values();
  for (linalg::Index column = 0; column < matrix.cols(); ++column) {
    for (std::size_t k = at(start[at(column)]); k < at(start[at(column) + 1]); ++k)
      values[k] = change(linalg::Index{rows[k]}, column, values[k]);
  }
}

/// w of C w = 1, the rows of C being divided by their diagonals; NaN where C is singular, or a diagonal not positive.
Vector weights_of(const SparseSquare& comparison) {
  const auto m = comparison.rows();
  const Vector nothing = Vector::constant(m, std::numeric_limits<double>::quiet_NaN());
  const Vector own = comparison.diagonal();
  if (!(own.min() > 0.0)) return nothing;
  SparseSquare scaled = comparison;
  scaled.scale_rows(own.inverses());
  const linalg::SparseLu lu(scaled);
  if (!lu.is_factorised()) return nothing;
  return lu.solve(Vector::ones(m));
}

double margin_of(const Vector& weights) {
  double margin = 1.0;
  for (linalg::Index j = 0; j < weights.size(); ++j) {
    const double part = 1.0 / weights[j];
    if (!std::isfinite(part)) return -1.0;
    margin = std::min(margin, part);
  }
  return margin;
}

/// One search for the selections in the cube.
class BoundedSearch {
 public:
  BoundedSearch(const Influence& influence, ProjectedField g, const SparseSquare& comparison, std::vector<double> start)
      : influence_(influence),
        g_(g),
        comparison_(comparison),
        weights_(weights_of(comparison)),
        alpha_(std::move(start)) {
    velocity_.resize(index(alpha_.size()));
    largest_ = Vector::zero(velocity_.size());
  }

  [[nodiscard]] bool applies() const { return margin_of(weights_) > 0.0; }

  std::optional<BoundedRoot> run() {
    // Most steps are Newton's; those that contract by themselves get there from everywhere.
    constexpr int iterations = 2000;
    SparseEffects effects(influence_);
    evaluate(alpha_);
    for (int k = 0; k < iterations && velocity_.all_finite(); ++k) {
      const double before = distance(alpha_);
      if (before <= 4e-16) return finish();
      effects.find(g_, alpha_.data(), velocity_.data());
      own_ = effects.matrix().diagonal();
      std::vector<double> next = newton_step(effects.matrix());
      evaluate(next);
      if (!velocity_.all_finite() || !(distance(next) < 0.5 * before)) {
        evaluate(alpha_);
        next = contracted();
        evaluate(next);
        // Rounding has the last word.
        if (before <= 1e-13 && !(distance(next) < before)) return finish();
      }
      alpha_ = std::move(next);
    }
    return std::nullopt;
  }

 private:
  void evaluate(std::vector<double>& alpha) {
    g_(alpha.data(), velocity_.data());
    if (velocity_.all_finite()) largest_ = largest_.at_least(velocity_.abs());
  }
  /// Of the step that contracts, in its norm; behind evaluate() there.
  [[nodiscard]] double distance(const std::vector<double>& alpha) const {
    double result = 0.0;
    for (std::size_t j = 0; j < alpha.size(); ++j) {
      const double step = std::clamp(alpha[j] + speed(j), 0.0, 1.0) - alpha[j];
      result = std::max(result, std::abs(step) / weights_[index(j)]);
    }
    return result * weights_.min();
  }
  /// By the largest -G_jj that was seen: no step goes beyond the balance of its surface.
  [[nodiscard]] double speed(std::size_t j) const {
    const auto i = index(j);
    const double own = own_.size() > 0 ? std::max(-own_[i], comparison_(i, i)) : comparison_(i, i);
    return velocity_[i] / own;
  }
  [[nodiscard]] std::vector<double> contracted() const {
    std::vector<double> next = alpha_;
    for (std::size_t j = 0; j < next.size(); ++j) next[j] = std::clamp(next[j] + speed(j), 0.0, 1.0);
    return next;
  }
  /// With the selections that stay at their bounds taken out.
  [[nodiscard]] std::vector<double> newton_step(const SparseSquare& effects) const {
    std::vector<bool> bound(alpha_.size());
    Vector right = -velocity_;
    for (std::size_t j = 0; j < alpha_.size(); ++j) {
      const double target = alpha_[j] + speed(j);
      bound[j] = target <= 0.0 || target >= 1.0;
      if (bound[j]) right[index(j)] = std::clamp(target, 0.0, 1.0) - alpha_[j];
    }
    SparseSquare matrix = effects;
    change_entries(matrix, [&](linalg::Index row, linalg::Index column, double value) {
      return !bound[at(row)] ? value : row == column ? 1.0 : 0.0;
    });
    const linalg::SparseLu lu(matrix);
    std::vector<double> next = alpha_;
    if (!lu.is_factorised()) return next;
    const Vector step = lu.solve(right);
    for (std::size_t j = 0; j < next.size(); ++j) next[j] = std::clamp(next[j] + step[index(j)], 0.0, 1.0);
    return next;
  }

  [[nodiscard]] BoundedRoot finish() const {
    BoundedRoot root{std::vector<int>(alpha_.size(), 0), alpha_, false};
    for (std::size_t j = 0; j < alpha_.size(); ++j) {
      const double velocity = velocity_[index(j)];
      const double rounding = field_accuracy * std::max(largest_[index(j)], comparison_(index(j), index(j)));
      const bool low = alpha_[j] <= field_accuracy, high = alpha_[j] >= 1.0 - field_accuracy;
      if (low && velocity < -rounding) root.mode[j] = -1;
      if (high && velocity > rounding) root.mode[j] = 1;
      if (root.mode[j] == 0 && (low || high)) root.is_borderline = true;
    }
    return root;
  }

  const Influence& influence_;
  ProjectedField g_;
  const SparseSquare& comparison_;
  Vector weights_, velocity_, largest_, own_;
  std::vector<double> alpha_;
};

}  // namespace

double attraction_margin(const SparseSquare& comparison) { return margin_of(weights_of(comparison)); }

SparseSquare comparison_of(const SparseSquare& effects) {
  SparseSquare comparison = effects;
  change_entries(comparison, [](linalg::Index row, linalg::Index column, double value) {
    return row == column ? -value : -std::abs(value);
  });
  return comparison;
}

std::optional<SparseSquare> comparison_in_cube(const Influence& influence, ProjectedField g) {
  SparseEffects effects(influence);
  if (effects.colours() > most_colours) return std::nullopt;
  const auto m = influence.size();
  std::vector<double> alpha(m), velocity(m);
  SparseSquare least;
  for (unsigned corner = 0; corner < 1U << effects.colours(); ++corner) {
    for (std::size_t j = 0; j < m; ++j) alpha[j] = (corner >> effects.colour()[j] & 1U) != 0 ? 1.0 : 0.0;
    g(alpha.data(), velocity.data());
    effects.find(g, alpha.data(), velocity.data());
    const SparseSquare here = comparison_of(effects.matrix());
    if (corner == 0) {
      least = here;
      continue;
    }
    const auto values = least.values();
    for (std::size_t k = 0; k < values.size(); ++k) values[k] = std::min(values[k], here.values()[k]);
  }
  if (!least.all_finite()) return std::nullopt;
  return least;
}

std::optional<BoundedRoot> bounded_root(const Influence& influence, ProjectedField g, const SparseSquare& comparison,
                                        std::vector<double> start) {
  BoundedSearch search(influence, g, comparison, std::move(start));
  if (!search.applies()) return std::nullopt;
  return search.run();
}

}  // namespace saltus::switching
