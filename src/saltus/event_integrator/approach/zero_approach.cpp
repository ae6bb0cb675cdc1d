#include "saltus/event_integrator/approach/zero_approach.hpp"

#include <algorithm>
#include <numeric>

#include "saltus/event_integrator/field/rooted_exit.hpp"
#include "saltus/event_integrator/mode/at_surface.hpp"
#include "saltus/event_integrator/mode/resolution.hpp"
#include "saltus/event_integrator/mode/small_internal.hpp"

namespace saltus::event_integrator {
namespace {

/// A rate below this part of its terms is rounding: the function is touched, or left, tangentially.
constexpr double rate_rounding = 1e-12;
/// Of det G: a root that is as good as lost.
constexpr double lost_root = 1e-3;

}  // namespace

ZeroApproach::ZeroApproach(const SwitchingContext& switching_context, const Position& here, ModeField& field,
                           EventSearch& search)
    : switching_context_(switching_context),
      kernel_(switching_context.kernel),
      here_(here),
      field_(field),
      search_(search),
      rates_(kernel_, here) {
  for (int j = 0; j < kernel_.switching_functions(); ++j) {
    if (kernel_.root_is_continued(j)) {
      continued_.push_back(j);
    } else if (kernel_.has_root(j)) {
      ending_.push_back(j);
    }
  }
}

const std::vector<double>& ZeroApproach::functions(double t, const double* x) {
  all_.resize(search_.functions().size());
  std::iota(all_.begin(), all_.end(), std::size_t{0});
  search_.evaluate(t, x, all_, values_);
  return values_;
}

bool ZeroApproach::ends_at(int surface) const { return contains(ending_, surface); }

/// Calls take(number, value) for the surfaces that are within some roundings of zero here, until that returns true.
template <class Take>
void ZeroApproach::each_near(double roundings, Take take) {
  functions(here_.t, here_.x.data());
  for (std::size_t i = 0; i < values_.size(); ++i) {
    if (search_.functions()[i].kind != FunctionKind::surface) continue;
    if (std::abs(values_[i]) <= roundings * search_.noise(i) && take(i, values_[i])) return;
  }
}

/// The point on a surface that the position gets to over the time `left`.
Located ZeroApproach::onto(std::size_t function, double left) const {
  const auto& reached = search_.functions()[function];
  Located located{here_.t + left, here_.x, {function}, {reached.sign}};
  if (left != 0.0) {
    for (std::size_t k = 0; k < located.x.size(); ++k) located.x[k] += left * here_.slope[k];
  }
  move_onto(kernel_, here_.state, reached.index, located.t, located.x);
  return located;
}

/// Beside a surface with a root of psi, psi matters relative to itself: errors of a step are to be less than a part of
/// what psi is or becomes. h' = -sqrt(h) empties at 2 sqrt(h), which an error of atol in h moves by 1e-5.
ode::Tolerances ZeroApproach::bearable(double h, std::optional<double> cycle, const ode::Tolerances& mode) {
  // A thousandth of psi moves that time by 1e-3 sqrt(psi); of what is left at `least` of atol, 1e-18, by 1e-9 at most.
  constexpr double part = 1e-3, least = 1e-8;
  const double smallest = carried_part / mode.rtol;
  ode::Tolerances bearable{.rtol = 1.0, .atol = 1.0};
  auto& [rtol, atol] = bearable;
  kernel_values_.resize(at(kernel_.event_functions()));
  kernel_.functions(here_.t, here_.x.data(), here_.state.alpha.data(), kernel_values_.data());
  for (const int j : continued_) {
    if (here_.state.mode[at(j)] == 0) continue;
    const Rate rate = rates_.here(j);
    const double wanted = part * std::max(std::abs(kernel_values_[at(j)]), std::abs(h * rate.value));
    atol = std::min(atol, std::max(least, wanted / (rate.slope * mode.atol)));
    rtol = std::min(rtol, std::max(smallest, wanted / (rate.magnitude * mode.rtol)));
  }
  // In cycles that contract atol does so already. What rtol allows of terms that are larger than psi, as x and t of
  // x - sin(t) are, has to; psi becomes the rate with which it leaves its surface for a part of the cycle. Their limit
  // is as far off as the part of psi that is wrong is of the cycle: from 1e-3 of it cycles of dopri5 contracted
  // unevenly, so that some had no limit. Steps change a state by far less than its own size there: no more is lost than
  // its rounding.
  constexpr double cycle_part = 0.1, part_of_cycle = 1e-5;
  const double rounding = rounding_of(1.0) / mode.rtol;
  for (const int j : ending_) {
    if (!cycle || here_.state.mode[at(j)] == 0) continue;
    const Rate rate = rates_.here(j);
    const double farthest =
        std::max(std::abs(kernel_values_[at(j)]), std::max(h, cycle_part * *cycle) * std::abs(rate.value));
    rtol = std::min(rtol, std::max(rounding, part_of_cycle * farthest / (rate.magnitude * mode.rtol)));
  }
  return bearable;
}

/// Steps that change nothing succeed there, although time could go on, and all others are undefined.
std::optional<Located> ZeroApproach::within_rounding() {
  if (none_at_ == here_.t) return std::nullopt;
  std::optional<Located> located;
  each_near(1.0, [&](std::size_t i, double) {
    const auto& function = search_.functions()[i];
    const Rate rate = rates_.here(function.index);
    if (function.sign * rate.value < -rate_rounding * rate.terms) located = onto(i, 0.0);
    return located.has_value();
  });
  if (!located) none_at_ = here_.t;
  return located;
}

std::optional<Located> ZeroApproach::ahead(double until) {
  constexpr double few = 4.0;
  std::optional<Located> located;
  each_near(few, [&](std::size_t i, double value) {
    const auto& function = search_.functions()[i];
    if (!ends_at(function.index)) return false;
    const Rate rate = rates_.here(function.index);
    // A step of this length may have ended beyond it by as little.
    const double left = std::max(0.0, -value / rate.value);
    if (function.sign * rate.value < 0.0 && here_.t + left < until) located = onto(i, left);
    return located.has_value();
  });
  return located;
}

std::optional<Located> ZeroApproach::beside_undefined() {
  functions(here_.t, here_.x.data());
  for (std::size_t i = 0; i < values_.size(); ++i) {
    const auto& function = search_.functions()[i];
    if (function.kind == FunctionKind::surface) {
      // The zero lies within the time that can no longer be resolved.
      const double rate = rates_.here(function.index).value;
      // NOTE: the last step may have ended at 0 itself, or a rounding beyond it.
      const bool ahead = function.sign * rate < 0.0 || (function.sign == 0 && values_[i] * rate < 0.0);
      // Of sqrt(x) + 1 the rate is infinite at x = 0, and nothing is reached.
      const bool is_near = std::isfinite(rate) && std::abs(values_[i] / rate) <= 1e3 * here_.smallest_step();
      if (ahead && is_near) return onto(i, 0.0);
    } else if (function.kind == FunctionKind::loss && std::abs(values_[i]) < lost_root) {
      return Located{here_.t, here_.x, {i}, {function.sign}};  // the selection has become double
    }
  }
  return std::nullopt;
}

bool ZeroApproach::is_repelled(const Located& located) {
  const auto& function = search_.functions()[located.functions.front()];
  if (!located.short_of || function.kind != FunctionKind::surface) return false;
  std::vector<double> x = located.x, slope(x.size());
  move_onto(kernel_, here_.state, function.index, located.t, x);
  field_(located.t, x.data(), slope.data());
  const Rate rate = rates_.at(function.index, located.t, x, slope);
  return located.signs.front() * rate.value > rate_rounding * rate.terms;
}

int ZeroApproach::root_here() {
  int root = -1;
  each_near(1.0, [&](std::size_t i, double) {
    const int surface = search_.functions()[i].index;
    if (here_.state.mode[at(surface)] == 0) return false;
    RootedExit exit(kernel_, switching_context_.affine_in_alpha, here_.state, surface);
    if (exit.has_root(here_.t, here_.x)) root = surface;
    return root >= 0;
  });
  return root;
}

int ZeroApproach::root_here_once() {
  if (here_.t == root_asked_at_) return -1;
  root_asked_at_ = here_.t;
  return root_here();
}

bool ZeroApproach::keep_their_signs(int surface, double t, const double* x) {
  const std::vector<double> before = functions(here_.t, here_.x.data());
  functions(t, x);
  for (std::size_t i = 0; i < values_.size(); ++i) {
    const auto& function = search_.functions()[i];
    if (function.kind == FunctionKind::surface && function.index == surface) continue;
    if (!(values_[i] * before[i] >= 0.0)) return false;
  }
  return true;
}

std::vector<const EventFunction*> ZeroApproach::unresolved() {
  std::vector<const EventFunction*> zeros;
  functions(here_.t, here_.x.data());
  for (std::size_t i = 0; i < values_.size(); ++i) {
    const auto& function = search_.functions()[i];
    if (function.kind == FunctionKind::surface && std::abs(values_[i]) <= search_.accuracy(i))
      zeros.push_back(&function);
  }
  return zeros;
}

}  // namespace saltus::event_integrator
