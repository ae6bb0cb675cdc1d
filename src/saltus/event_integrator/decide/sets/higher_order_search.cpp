// Which functions are zero on a higher-order set, and what holds them there.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "saltus/event_integrator/decide/transition.hpp"
#include "saltus/event_integrator/decide/transition_internal.hpp"
#include "saltus/event_integrator/field/higher_order.hpp"
#include "saltus/event_integrator/mode/at_surface.hpp"
#include "saltus/event_integrator/mode/resolution.hpp"
#include "saltus/switching/table/independent_rows.hpp"

namespace saltus::event_integrator {
namespace {

/// Derivatives of psi looked at: sliding of the fourth order is the highest one found.
constexpr int highest_order = 3;
/// Surfaces whose 2^m corners are looked at.
constexpr std::size_t most_surfaces = 8;

/// Grows a set function by function.
class SetSearch {
 public:
  SetSearch(const SwitchingContext& s, const ModeState& state, double t, std::vector<double>& x, double resolved,
            std::vector<NestedSelection> nested)
      : s_(s),
        state_(state),
        sliding_(state.sliding),
        t_(t),
        x_(x),
        resolved_(resolved),
        alpha_(state.alpha),
        functions_(s.kernel),
        surfaces_(s.kernel) {
    for (const int j : sliding_) alpha_[at(j)] = 0.5;
    corners_.resize(std::size_t{1} << sliding_.size(), std::vector<double>(x.size()));
    set_.nested = std::move(nested);
  }

  std::optional<HigherOrderSet> run() {
    if (!place_surfaces()) return std::nullopt;
    for (int order = 0; order <= highest_order && !open_.empty(); ++order) {
      for (const HeldFunction& function : std::exchange(open_, {})) {
        if (!look_at(function)) return std::nullopt;
      }
    }
    if (!open_.empty()) return refuse("is not held by any selection");
    return finish();
  }

  [[nodiscard]] std::string take_problem() { return std::move(problem_); }

 private:
  std::nullopt_t refuse(std::string why) {
    problem_ = std::move(why);
    return std::nullopt;
  }
  bool reject(std::string why) {
    problem_ = std::move(why);
    return false;
  }

  bool place_surfaces() {
    for (const int j : sliding_) set_.functions.push_back({j, 0});
    open_ = set_.functions;
    surfaces_.set(set_.functions, alpha_);
    functions_.set(set_.functions, alpha_);
    static_cast<void>(functions_.project(t_, x_.data()));
    if (!nested_are_continuous()) return false;
    functions_.differentiate(t_, x_.data());
    for (std::size_t i = 0; i < sliding_.size(); ++i) {
      if (!(functions_.independent_part(i) > switching::dependent_part))
        return reject("the gradients of the surfaces depend on each other");
    }
    std::vector<double> ignored;
    static_cast<void>(velocities(0, x_, ignored));
    fields_ = corners_;
    return std::all_of(fields_.begin(), fields_.end(), [](const auto& f) { return is_finite(f); }) ||
           reject("a field is not finite on the surfaces");
  }

  /// Whether functions around others have the same value, 0, in all regions that meet here, but for roots of rounding.
  bool nested_are_continuous() {
    for (const int j : sliding_) {
      const auto inner = sliding_inside(s_.kernel, state_, j);
      if (inner.empty()) continue;
      const int form = s_.kernel.with_limited_roots(j);
      std::vector<double> row(x_.size());
      for (const auto& alpha : corners_at(state_, inner)) {
        double rate = 0.0;
        const double psi = s_.kernel.lie_derivative(form, 0, t_, x_.data(), alpha.data());
        s_.kernel.lie_gradient(form, 0, t_, x_.data(), alpha.data(), row.data(), &rate);
        double terms = std::abs(rate * t_);
        for (std::size_t i = 0; i < row.size(); ++i) terms += std::abs(row[i] * x_[i]);
        // Four digits above rounding, as for other functions that hold signs: a jump is something of size.
        if (!(std::abs(psi) <= smallest_jump(terms))) return reject("a nested switching function that jumps");
      }
    }
    return true;
  }

  /// The velocities of function i of the set at all corners; the largest size of their terms.
  double velocities(std::size_t i, const std::vector<double>& x, std::vector<double>& result) {
    functions_.differentiate(t_, x.data());
    std::vector<double> trial = alpha_;
    double terms = 0.0;
    result.resize(corners_.size());
    for (std::size_t corner = 0; corner < corners_.size(); ++corner) {
      for (std::size_t row = 0; row < sliding_.size(); ++row) {
        trial[at(sliding_[row])] = (corner >> row & 1U) != 0 ? 1.0 : 0.0;
      }
      read_nested(set_.nested, trial);
      s_.kernel.field(t_, x.data(), trial.data(), corners_[corner].data());
      result[corner] = functions_.velocity(i, corners_[corner]);
      terms = std::max(terms, functions_.velocity_terms(i, corners_[corner]));
    }
    return terms;
  }

  /// The surfaces whose selections change these velocities.
  [[nodiscard]] std::vector<std::size_t> rows_in(const std::vector<double>& velocity, double terms) const {
    std::vector<std::size_t> rows;
    for (std::size_t row = 0; row < sliding_.size(); ++row) {
      double change = 0.0;
      for (std::size_t corner = 0; corner < velocity.size(); ++corner) {
        change = std::max(change, std::abs(velocity[corner ^ (std::size_t{1} << row)] - velocity[corner]));
      }
      if (!(change <= velocity_accuracy * terms)) rows.push_back(row);
    }
    return rows;
  }

  /// A function joins the set, if those in it do not fix it already, with its balance or its next derivative.
  bool look_at(const HeldFunction& function) {
    std::size_t place = 0;
    if (function.order == 0) {
      while (set_.functions[place].surface != function.surface) ++place;
    } else {
      auto functions = set_.functions;
      place = functions.size();
      functions.push_back(function);
      functions_.set(functions, alpha_);
      functions_.differentiate(t_, x_.data());
      if (!(functions_.independent_part(place) > switching::dependent_part)) return follows(place);
      set_.functions = std::move(functions);
    }
    std::vector<double> velocity;
    const double terms = velocities(place, x_, velocity);
    const auto rows = rows_in(velocity, terms);
    if (function.order > 0 && !vanishes(place)) return false;
    // Fields that are tangent here and not near by (a two-fold point) are not held.
    for (const unsigned pattern : {0U, 1U, 2U}) {
      if (!acts_alike_nearby(place, rows, pattern)) return reject("which selections act changes with the place");
    }
    if (rows.empty()) {
      open_.push_back({function.surface, function.order + 1});
      return true;
    }
    set_.balances.push_back({{place}, rows});
    return true;
  }

  /// Whether the same selections change the velocities of a function at a displaced point: on the other side, where the
  /// fields of these regions are undefined on this one, beyond a surface with a root.
  bool acts_alike_nearby(std::size_t place, const std::vector<std::size_t>& rows, unsigned pattern) {
    std::vector<double> nearby;
    for (const double step : {0x1p-10, -0x1p-10}) {
      functions_.differentiate(t_, x_.data());
      const double size = velocities(place, functions_.displaced(t_, x_.data(), step, pattern), nearby);
      if (rows_in(nearby, size) == rows) return true;
      if (is_finite(nearby)) return false;
    }
    return false;
  }

  /// A derivative that the functions of the set fix must be zero where they are, and stay so.
  bool follows(std::size_t place) {
    const double later = resolved_ * std::abs(functions_.rates()[static_cast<linalg::Index>(place)]);
    const bool rests = vanishes(place) && later <= change_of(place);
    functions_.set(set_.functions, alpha_);
    return rests || reject("a derivative of a surface that no selection changes does not stay at zero");
  }

  /// What a function changes by in the time that is resolved, under the field of any corner: as it goes, and on the
  /// surfaces, beside which the field may be undefined.
  [[nodiscard]] double change_of(std::size_t place) {
    const double here = functions_.value(place, t_, x_.data());
    double largest = 0.0;
    std::vector<double> x(x_.size());
    const auto note = [&] {
      const double change = std::abs(functions_.value(place, t_, x.data()) - here);
      if (std::isfinite(change)) largest = std::max(largest, change);
    };
    for (const auto& f : fields_) {
      for (std::size_t i = 0; i < x.size(); ++i) x[i] = x_[i] + resolved_ * f[i];
      note();
      static_cast<void>(surfaces_.project(t_, x.data()));
      note();
    }
    return largest;
  }

  bool vanishes(std::size_t place) {
    if (std::abs(functions_.value(place, t_, x_.data())) <= change_of(place)) return true;
    return reject("a derivative of a surface that no selection changes is not zero");
  }

  std::optional<HigherOrderSet> finish() {
    std::vector<bool> used(sliding_.size(), false);
    for (const auto& balance : set_.balances) {
      for (const std::size_t row : balance.rows) {
        if (used[row]) return refuse("several conditions share a selection");
        used[row] = true;
        if (balance.rows.size() > 1) set_.undetermined.push_back(sliding_[row]);
      }
    }
    for (std::size_t row = 0; row < sliding_.size(); ++row) {
      if (!used[row]) set_.undetermined.push_back(sliding_[row]);
    }
    std::sort(set_.undetermined.begin(), set_.undetermined.end());
    if (!set_.nested.empty() && set_.balances.size() > 1) return refuse("a nested switching function");
    if (!unused_change_nothing(used)) return refuse("the motion depends on a selection that nothing determines");
    HigherOrderField field(s_.kernel);
    field.enter(set_, sliding_, alpha_);
    static_cast<void>(field.project(t_, x_.data()));
    field.evaluate(t_, x_.data());
    for (const auto& range : field.ranges()) {
      const double rounding = velocity_accuracy * range.terms;
      if (!(range.max - range.min > rounding)) return refuse("no selection moves a derivative of the surfaces");
      if (!(range.min <= rounding && range.max >= -rounding)) return refuse("no selection holds the surfaces at zero");
    }
    if (!is_finite(field.motion())) return refuse("the motion depends on selections that are not determined");
    return std::move(set_);
  }

  /// Whether f is the same for all values of the selections that are in no balance.
  bool unused_change_nothing(const std::vector<bool>& used) const {
    for (std::size_t row = 0; row < sliding_.size(); ++row) {
      if (used[row]) continue;
      for (std::size_t corner = 0; corner < fields_.size(); ++corner) {
        const auto& here = fields_[corner];
        const auto& there = fields_[corner ^ (std::size_t{1} << row)];
        for (std::size_t i = 0; i < here.size(); ++i) {
          const double size = std::max(std::abs(here[i]), std::abs(there[i]));
          if (!(std::abs(here[i] - there[i]) <= velocity_accuracy * size)) return false;
        }
      }
    }
    return true;
  }

  const SwitchingContext& s_;
  const ModeState& state_;
  const std::vector<int>& sliding_;
  double t_;
  std::vector<double>& x_;
  double resolved_;
  std::vector<double> alpha_;
  HeldFunctions functions_;
  HeldFunctions surfaces_;  ///< psi only
  HigherOrderSet set_;
  std::vector<HeldFunction> open_;            ///< to be looked at
  std::vector<std::vector<double>> fields_;   ///< of all corners at x
  std::vector<std::vector<double>> corners_;  ///< of all corners, in the last velocities()
  std::string problem_;
};

/// Kinks that no other function of the held ones holds the sign of, and other surfaces that cannot be held.
std::string find_obstacle(const SwitchingContext& s, const ModeState& state) {
  for (const int j : state.sliding) {
    const auto role = s.layout.surfaces[at(j)].role;
    const auto holds = [&](int i) { return contains(s.kernel.inner(i), j); };
    const bool is_held_kink =
        role == model::SwitchingRole::kink && std::any_of(state.sliding.begin(), state.sliding.end(), holds);
    if (role != model::SwitchingRole::listed && !is_held_kink) return "a kink";
  }
  return {};
}

/// The held surfaces inside a function, and inside those inside it that have both signs.
std::vector<int> held_inside(const evaluation::ModelKernel& kernel, const ModeState& state, int function,
                             const std::vector<NestedSelection>& nested) {
  std::vector<int> inside = sliding_inside(kernel, state, function);
  for (const auto& inner : nested) {
    if (!contains(kernel.inner(function), inner.function)) continue;
    for (const int j : inner.inside) {
      if (!contains(inside, j)) inside.push_back(j);
    }
  }
  return inside;
}

/// The functions around held surfaces that have both signs in the regions that meet there, away from zero in all of
/// them; nullopt where one may be zero.
std::optional<std::vector<NestedSelection>> find_nested(const evaluation::ModelKernel& kernel, const ModeState& state,
                                                        double t, const double* x) {
  std::vector<NestedSelection> found;
  std::vector<double> values(at(kernel.event_functions()));
  for (int j = 0; j < kernel.switching_functions(); ++j) {
    if (contains(state.sliding, j)) continue;
    NestedSelection nested{j, held_inside(kernel, state, j, found), {}};
    if (nested.inside.empty()) continue;
    if (nested.inside.size() > most_surfaces) return std::nullopt;
    double least = std::numeric_limits<double>::infinity();
    for (auto& alpha : corners_at(state, nested.inside)) {
      read_nested(found, alpha);
      kernel.functions(t, x, alpha.data(), values.data());
      nested.alpha.push_back(values[at(j)] > 0.0 ? 1.0 : 0.0);
      least = std::min(least, std::abs(values[at(j)]));
    }
    const double own = state.mode[at(j)] > 0 ? 1.0 : 0.0;
    const bool keeps_sign =
        std::all_of(nested.alpha.begin(), nested.alpha.end(), [&](double alpha) { return alpha == own; });
    if (!(least > (keeps_sign ? 0.0 : smallest_jump(size_of(kernel, j, t, x, state.alpha.data(), 0.0)))))
      return std::nullopt;
    if (!keeps_sign) found.push_back(std::move(nested));
  }
  return found;
}

}  // namespace

std::optional<HigherOrderSet> find_higher_order_set(const SwitchingContext& switching_context, const ModeState& state,
                                                    double t, std::vector<double>& x, double resolved,
                                                    std::string& problem) {
  const auto refuse = [&](std::string why) {
    problem = std::move(why);
    return std::nullopt;
  };
  if (state.sliding.empty() || state.sliding.size() > most_surfaces) return refuse("too many surfaces");
  if (!switching_context.affine_in_alpha) return refuse("selections do not enter affinely");
  if (const auto why = find_obstacle(switching_context, state); !why.empty()) return refuse(why);
  auto nested = find_nested(switching_context.kernel, state, t, x.data());
  if (!nested) return refuse("a nested switching function");
  SetSearch search(switching_context, state, t, x, resolved, std::move(*nested));
  auto found = search.run();
  if (!found) problem = search.take_problem();
  return found;
}

}  // namespace saltus::event_integrator
