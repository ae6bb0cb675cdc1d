// Surfaces whose gradients depend on each other all along the set where they vanish: fewer conditions than selections.
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "saltus/event_integrator/decide/transition.hpp"
#include "saltus/event_integrator/decide/transition_internal.hpp"
#include "saltus/event_integrator/field/higher_order.hpp"
#include "saltus/linalg/factors.hpp"
#include "saltus/switching/table/additive_map.hpp"
#include "saltus/switching/table/field_accuracy.hpp"
#include "saltus/switching/table/independent_rows.hpp"

namespace saltus::event_integrator {
namespace {

using linalg::Index;

/// Selections whose corners are numbered by bits.
constexpr std::size_t most_numbered_surfaces = 60;

class DependentSearch {
 public:
  DependentSearch(const SwitchingContext& s, const ModeState& state, double t, std::vector<double>& x)
      : s_(s), sliding_(state.sliding), t_(t), x_(x), alpha_(state.alpha), functions_(s.kernel) {
    for (const int j : sliding_) alpha_[at(j)] = 0.5;
  }

  std::optional<HigherOrderSet> run() {
    choose_independent();
    if (dependent_.empty() && !velocities_depend()) return std::nullopt;
    static_cast<void>(functions_.project(t_, x_.data()));
    if (!stay_dependent()) return std::nullopt;
    if (!fields(t_, x_)) return std::nullopt;
    if (!make_balances() || !others_follow(t_, x_)) return std::nullopt;
    return checked();
  }

  /// What else may hold surfaces whose gradients are independent has its own problems.
  [[nodiscard]] std::string take_problem() { return dependent_.empty() ? std::string() : std::move(problem_); }

 private:
  bool reject(std::string why) {
    problem_ = std::move(why);
    return false;
  }

  /// Functions whose gradients the ones before do not span.
  void choose_independent() {
    std::vector<HeldFunction> all;
    for (const int j : sliding_) all.push_back({j, 0});
    functions_.set(std::move(all), alpha_);
    functions_.differentiate(t_, x_.data());
    const auto independent = switching::independent_rows(functions_.rows());
    for (std::size_t i = 0; i < sliding_.size(); ++i) {
      if (std::binary_search(independent.begin(), independent.end(), i)) {
        set_.functions.push_back({sliding_[i], 0});
      } else {
        dependent_.push_back(sliding_[i]);
      }
    }
    functions_.set(set_.functions, alpha_);
  }

  /// Whether selections move all of the functions, but not each by itself: blocks that press on each other stop
  /// together.
  bool velocities_depend() {
    functions_.differentiate(t_, x_.data());
    if (!fields(t_, x_)) return false;
    const linalg::Matrix effects = effects_on(functions_.rows());
    const bool all_move = effects.row_max_abs().min() > 0.0;
    return all_move && switching::independent_rows(effects).size() < sliding_.size();
  }

  /// What each selection adds to the velocities of functions, without what is rounding.
  [[nodiscard]] linalg::Matrix effects_on(const linalg::Matrix& rows) const {
    const linalg::Matrix terms = switching::field_accuracy * (rows.abs() * jumps_.abs());
    linalg::Matrix effects = rows * jumps_;
    for (Index i = 0; i < effects.size(); ++i) {
      if (!(std::abs(effects.data()[i]) > terms.data()[i])) effects.data()[i] = 0.0;
    }
    return effects;
  }

  /// The functions that were not chosen vanish with the others, now, near by on the set, and as time goes.
  bool stay_dependent() {
    std::vector<double> values(at(s_.kernel.event_functions())), row(x_.size());
    for (const unsigned pattern : {0U, 1U, 2U, 3U}) {
      std::vector<double> x = x_;
      functions_.differentiate(t_, x.data());
      if (pattern > 0) x = functions_.displaced(t_, x_.data(), 0x1p-10, pattern);
      functions_.differentiate(t_, x.data());
      s_.kernel.functions(t_, x.data(), alpha_.data(), values.data());
      const linalg::OrthogonalFactors spanned(functions_.rows().transpose());
      for (const int j : dependent_) {
        double rate = 0.0, size = 0.0;
        s_.kernel.gradient(j, t_, x.data(), alpha_.data(), row.data(), &rate);
        for (std::size_t i = 0; i < x.size(); ++i) size += std::abs(row[i]) * (1.0 + std::abs(x[i]));
        if (!(std::abs(values[at(j)]) <= switching::field_accuracy * size)) return reject("they part again");
        const linalg::ConstView gradient(row.data(), index(row.size()));
        const linalg::Vector shares = spanned.solve(gradient);
        const double rest = (functions_.rows().transpose() * shares - gradient).max_abs();
        if (!(rest <= 1e-6 * gradient.max_abs())) return reject("they part again");
        const double follows = functions_.rates().dot(shares);
        const double terms = std::abs(rate) + functions_.rates().abs().dot(shares.abs());
        if (!(std::abs(follows - rate) <= 1e-6 * terms)) return reject("they part again");
      }
    }
    return true;
  }

  /// What each of the selections adds to f.
  bool fields(double t, const std::vector<double>& x) {
    std::vector<double> trial = alpha_, f(x.size());
    const auto field = [&](const std::vector<double>& selections, linalg::Vector& value) {
      for (std::size_t i = 0; i < sliding_.size(); ++i) trial[at(sliding_[i])] = selections[i];
      s_.kernel.field(t, x.data(), trial.data(), f.data());
      value = linalg::ConstView(f.data(), index(f.size()));
    };
    auto map = switching::additive_map(sliding_.size(), field);
    if (!map) return reject("their selections multiply each other");
    if (!map->constant.all_finite() || !map->effects.all_finite())
      return reject("a field is not finite on the surfaces");
    jumps_ = std::move(map->effects);
    base_.assign(map->constant.begin(), map->constant.end());
    return true;
  }

  /// Functions that share selections are balanced together, as far as these move them independently.
  bool make_balances() {
    functions_.differentiate(t_, x_.data());
    const linalg::Matrix effects = functions_.rows() * jumps_;
    auto found = switching::balances_of(effects, functions_.rows().abs() * jumps_.abs());
    for (const std::size_t i : found.unused) {
      if (jumps_.col(index(i)).max_abs() > 0.0) {
        return reject("the motion depends on a selection that nothing determines");
      }
      set_.undetermined.push_back(sliding_[i]);
    }
    for (auto& balance : found.all) {
      if (balance.rows.empty()) return reject("no selection moves some of the surfaces");
      Followers own{{}, balance.functions};
      linalg::Matrix part(index(own.functions.size()), effects.cols());
      for (std::size_t k = 0; k < own.functions.size(); ++k) part.row(index(k)) = effects.row(index(own.functions[k]));
      for (const std::size_t k : switching::independent_rows(part)) own.leaders.push_back(own.functions[k]);
      balance.functions = own.leaders;
      std::erase_if(own.functions,
                    [&](std::size_t f) { return std::binary_search(own.leaders.begin(), own.leaders.end(), f); });
      if (balance.rows.size() > balance.functions.size()) {
        for (const std::size_t i : balance.rows) set_.undetermined.push_back(sliding_[i]);
      }
      if (!own.functions.empty()) followers_.push_back(std::move(own));
    }
    set_.balances = found.all;
    std::sort(set_.undetermined.begin(), set_.undetermined.end());
    return true;
  }

  /// Whether functions that are in no balance rest at a point while those in theirs do.
  bool others_follow(double t, const std::vector<double>& x) {
    if (followers_.empty()) return true;
    functions_.differentiate(t, x.data());
    if (!fields(t, x)) return false;
    const bool follow = std::all_of(followers_.begin(), followers_.end(), [&](const Followers& f) {
      return std::all_of(f.functions.begin(), f.functions.end(), [&](auto i) { return follows(i, f.leaders); });
    });
    return follow || reject("no selection moves some of the surfaces, which do not stay by themselves");
  }

  /// The same a little later along the motion: two that move alike for an instant part.
  bool others_follow_ahead(const std::vector<double>& motion) {
    const double step = 0x1p-10 * (1.0 + std::abs(t_));
    std::vector<double> x = x_;
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += step * motion[i];
    static_cast<void>(functions_.project(t_ + step, x.data()));
    return others_follow(t_ + step, x);
  }

  /// Whether the velocity of a function is a combination of those of others, for all selections.
  bool follows(std::size_t function, const std::vector<std::size_t>& leaders) {
    const auto velocity_at_0 = [&](std::size_t i) { return functions_.velocity(i, base_); };
    const auto terms_of = [&](std::size_t i) {
      return functions_.velocity_terms(i, base_) + functions_.rows().row(index(i)).abs().dot(jumps_.abs().row_sums());
    };
    const linalg::Matrix effects = functions_.rows() * jumps_;
    linalg::Matrix leading(effects.cols(), index(leaders.size()));
    for (std::size_t k = 0; k < leaders.size(); ++k) leading.col(index(k)) = effects.row(index(leaders[k]));
    const linalg::Vector own = effects.row(index(function));
    const linalg::Vector shares = linalg::least_squares(leading, own);
    double velocity = velocity_at_0(function), terms = terms_of(function);
    for (std::size_t k = 0; k < leaders.size(); ++k) {
      velocity -= shares[index(k)] * velocity_at_0(leaders[k]);
      terms += std::abs(shares[index(k)]) * terms_of(leaders[k]);
    }
    const double rest = std::max(std::abs(velocity), (own - leading * shares).max_abs());
    return rest <= switching::field_accuracy * terms;
  }

  std::optional<HigherOrderSet> checked() {
    HigherOrderField field(s_.kernel);
    field.enter(set_, sliding_, alpha_);
    field.evaluate(t_, x_.data());
    for (const auto& range : field.ranges()) {
      const double rounding = switching::field_accuracy * range.terms;
      if (range.min <= rounding && range.max >= -rounding) continue;
      static_cast<void>(reject("no selection holds the surfaces at zero"));
      return std::nullopt;
    }
    if (!is_finite(field.motion())) {
      static_cast<void>(reject(field.too_many() ? "there are too many of them"
                                                : "the motion depends on selections that are not determined"));
      return std::nullopt;
    }
    if (!others_follow_ahead(field.motion())) return std::nullopt;
    return std::move(set_);
  }

  /// Functions whose velocities are combinations of those of others, the leaders.
  struct Followers {
    std::vector<std::size_t> leaders, functions;
  };

  const SwitchingContext& s_;
  const std::vector<int>& sliding_;
  double t_;
  std::vector<double>& x_;
  std::vector<double> alpha_;
  std::vector<int> dependent_;
  std::vector<Followers> followers_;
  linalg::Matrix jumps_;      ///< n_x x q
  std::vector<double> base_;  ///< f with all selections at 0
  HeldFunctions functions_;
  HigherOrderSet set_;
  std::string problem_;
};

}  // namespace

bool are_plain_surfaces(const SwitchingContext& s, const std::vector<int>& surfaces) {
  for (int j = 0; j < s.kernel.switching_functions(); ++j) {
    const auto& inner = s.kernel.inner(j);
    const bool own = contains(surfaces, j);
    if (own && (s.layout.surfaces[at(j)].role != model::SwitchingRole::listed || !inner.empty())) return false;
    if (std::any_of(inner.begin(), inner.end(), [&](int i) { return contains(surfaces, i); })) return false;
  }
  return true;
}

std::optional<HigherOrderSet> find_dependent_set(const SwitchingContext& switching_context, const ModeState& state,
                                                 double t, std::vector<double>& x, std::string& problem) {
  problem.clear();
  if (state.sliding.size() < 2 || state.sliding.size() > most_numbered_surfaces) return std::nullopt;
  if (!are_plain_surfaces(switching_context, state.sliding)) return std::nullopt;
  DependentSearch search(switching_context, state, t, x);
  auto found = search.run();
  if (!found) problem = search.take_problem();
  return found;
}

}  // namespace saltus::event_integrator
