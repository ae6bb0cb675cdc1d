#include "saltus/event_integrator/sequences/contracting_cycles.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "saltus/event_integrator/mode/small_internal.hpp"

namespace saltus::event_integrator {
namespace {

/// Of fewer events no power can be told.
constexpr long fewest_shrinking = 64;

/// What to smooth such cycles with: a layer that is far wider than they are now has far fewer of them outside. Below a
/// hundred thousandth of the function's size a run takes as many steps as there would be cycles.
std::string resolving_layer(double farthest, double size, bool smoothed) {
  constexpr double wider = 100.0, least = 1e-5;
  const double wanted = std::max(wider * farthest, least * size);
  if (!(wanted > 0.0) || !std::isfinite(wanted)) return "method = \"smoothed\"";
  const double epsilon = std::pow(10.0, std::ceil(std::log10(wanted)));
  return smoothed ? fmt::format("a wider layer: simulate.smoothed.epsilon = {:g}", epsilon)
                  : fmt::format("method = \"smoothed\" with simulate.smoothed.epsilon = {:g}", epsilon);
}

}  // namespace

/// Mean distance of the events number first to first + count.
double ContractingCycles::mean_interval(long first, long count) const {
  return (recorder_.event_time(first + count) - recorder_.event_time(first)) / static_cast<double>(count);
}

/// Mean distance of the last eighth of the first `count` events.
double ContractingCycles::last_interval(long count) const {
  return mean_interval(count - 1 - (count - 1) / 8, (count - 1) / 8);
}

/// Returns how many of the events of the run so far are in resolved cycles. Of these more is resolved than what changes
/// from one to the next. Between two zeros psi gets about as far as its rate times a quarter of their distance T. A
/// rounding less or more of it makes the next cycle longer or shorter by as large a part. Of cycles like k^-p only p/k
/// of one is missing in the next. The rate, and with it how far psi gets, goes with T: T^2.
long ContractingCycles::resolved_events(double farthest, double rounding) const {
  long count = recorder_.events();
  const double last = last_interval(count);
  const auto part = [&](long k) { return std::pow(last_interval(k) / last, 2) * farthest; };
  while (count >= fewest_shrinking && part(count) < static_cast<double>(count) * rounding) count -= count / 8;
  return count;
}

/// The exponent p if the first n events of the run follow each other like k^-p, k their number; nullopt if they do not,
/// or are too few to tell.
std::optional<double> ContractingCycles::exponent_of(long n) const {
  if (n < fewest_shrinking) return std::nullopt;
  // Means over eighths, each twice as far from the start as the one before: whole cycles and others alike. Their
  // middles are (first + half an eighth), so that p follows from two of them.
  const long eighth = (n - 1) / 8;
  const auto middle = [&](long first) { return static_cast<double>(first) + 0.5 * static_cast<double>(eighth); };
  const long firsts[] = {eighth, 3 * eighth, 7 * eighth};
  const auto exponent = [&](long early, long late) {
    return std::log(mean_interval(early, eighth) / mean_interval(late, eighth)) /
           std::log(middle(late) / middle(early));
  };
  const double before = exponent(firsts[0], firsts[1]);
  const double now = exponent(firsts[1], firsts[2]);
  // k^-1 is what a weak damping leaves of a relay of relative degree 2; slower than k^-1/4 may be a cycle that is
  // approached, and exponents that still change are no power.
  constexpr double weakest = 0.25;
  constexpr double same = 0.25;
  if (!(now >= weakest && std::abs(now - before) <= same * now)) return std::nullopt;
  return now;
}

/// Whether no selection of a surface moves psi at once: d psi/dt is the same on both sides (relative degree 2 or more).
bool ContractingCycles::has_one_rate(int surface) {
  std::vector<double> alpha = here_.state.alpha;
  std::vector<double> slope(here_.x.size());
  Rate sides[2];
  for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
    alpha[at(surface)] = static_cast<double>(side);
    kernel_.field(here_.t, here_.x.data(), alpha.data(), slope.data());
    sides[side] = rates_.along(surface, slope);
  }
  constexpr double rounding = 1e-12;
  return std::abs(sides[1].value - sides[0].value) <= rounding * std::max(sides[0].terms, sides[1].terms);
}

/// What max_events has ended, where that is a sequence that shrinks like a power of its number; empty elsewhere.
std::string ContractingCycles::describe() {
  long events = recorder_.events();
  if (events < fewest_shrinking) return {};
  constexpr long longest_cycle = 8;
  std::string names;
  double farthest = 0.0, rounding = 0.0;
  bool smoothed = false;  // the surfaces are edges of layers
  for (int j = 0; j < kernel_.switching_functions(); ++j) {
    const auto& function = switching_context_.layout.surfaces[at(j)];
    if (function.role != model::SwitchingRole::listed || here_.state.mode[at(j)] == 0) continue;
    if (!recorder_.switched_lately(j, longest_cycle) || !has_one_rate(j)) continue;
    smoothed = smoothed || function.continuous;
    names += (names.empty() ? "'" : "', '") + function.name;
    const Rate rate = rates_.here(j);
    farthest = std::max(farthest, 0.25 * std::abs(rate.value) * last_interval(events));
    rounding = std::max(rounding, rounding_unit * rate.magnitude);
  }
  if (names.empty()) return {};
  names += "'";
  events = resolved_events(farthest, rounding);
  const auto exponent = exponent_of(events);
  if (!exponent) return {};
  // The sum of what follows like k^-p.
  const std::string when =
      *exponent > 1.1 ? fmt::format("at about t = {:.3g}",
                                    recorder_.event_time(events - 1) +
                                        last_interval(events) * static_cast<double>(events) / (*exponent - 1.0))
                      : std::string("as t -> infinity");
  return fmt::format(
      "cycles of {} shrink like the power -{:.2g} of their number: the motion reaches the point where these functions "
      "are 0 {} only, with ever faster switches, infinitely many of them; end the run earlier (simulate.until), begin "
      "at that point (the motion can stay there), use {}, or give the switches a hysteresis",
      names, *exponent, when, resolving_layer(farthest, rounding / rounding_unit, smoothed));
}

}  // namespace saltus::event_integrator
