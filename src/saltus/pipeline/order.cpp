#include "saltus/pipeline/order.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/contains.hpp"
#include "saltus/base/text.hpp"
#include "saltus/pipeline/compare.hpp"
#include "saltus/pipeline/observers_internal.hpp"
#include "saltus/pipeline/options/option_fields.hpp"
#include "saltus/pipeline/recorded_internal.hpp"

namespace saltus::pipeline {
namespace {

Error unreadable(std::string_view expected, std::string_view found, std::string remedy) {
  return {
      ErrorCode::invalid_option, fmt::format("expected {}, found '{}'", expected, found), std::move(remedy), {}, {}};
}

Expected<SimulateOptions> with_all(SimulateOptions options,
                                   std::initializer_list<std::pair<std::string, result::OptionValue>> values) {
  for (const auto& [key, value] : values) {
    auto changed = with_value(std::move(options), key, value);
    if (!changed) return tl::unexpected(with_context(changed.error(), "in simulate." + key));
    options = std::move(*changed);
  }
  return options;
}

Expected<SimulateOptions> options_of(const result::OrderSeries& series, long steps, SimulateOptions options) {
  options.output = AtTimes{{*end_time(options)}};
  const auto key = [&](const char* name) { return fmt::format("{}.{}", series.method, name); };
  return with_all(std::move(options),
                  {{"method", series.method},
                   {key("scheme"), series.scheme},
                   {key("stages"), series.stages},
                   {key("reformulation"), series.reformulation},
                   {key("error_limit"), std::string("off")},  // elements as long as they are asked to be
                   {key("steps"), std::int64_t{steps}}});
}

result::OrderPoint point(const Expected<result::Result>& found, const result::OrderSeries& series, long steps,
                         const result::Result& reference) {
  result::OrderPoint point;
  point.steps = steps;
  const double length = reference.final.t - reference.trajectory.t.front();
  point.mean_step = length / static_cast<double>(steps);
  if (!found) {
    point.reason = found.error().message;
    return point;
  }
  const auto elements = recorded<std::int64_t>(found->options, series.method + ".elements").value_or(1);
  point.mean_step /= static_cast<double>(elements);
  point.wall_seconds = found->statistics.wall_seconds;
  const auto [state, time] = agreement(*found, reference);
  point.error = state;
  point.switch_time_error = time;
  if (!is_done(found->status.termination)) {
    point.reason = fmt::format("{} at t = {:.6g}: {}", name(found->status.termination), found->status.time_reached,
                               found->status.message);
  } else if (!state) {
    point.reason = "the end state is not finite";
  }
  return point;
}

/// The slope of the points that have this error.
std::optional<double> slope(const std::vector<result::OrderPoint>& points,
                            std::optional<double> result::OrderPoint::*error, double floor) {
  std::vector<double> steps, errors;
  for (const auto& point : points) {
    if (!(point.*error)) continue;
    steps.push_back(point.mean_step);
    errors.push_back(*(point.*error));
  }
  return fitted_slope(steps, errors, floor);
}

/// What the reference is good for: ten times what changes with ten times its tolerances, and never below what a sum of
/// thousands of steps leaves of the last digits.
Expected<void> find_floor(const model::System& system, const SimulateOptions& tight, const result::Result& reference,
                          const Observers& observers, result::OrderStudy& study) {
  auto looser = tight;
  looser.rtol *= 10.0;
  looser.atol *= 10.0;
  const auto second = simulate(system, looser, observers);
  if (!second) return tl::unexpected(second.error());
  constexpr double rounding = 64.0 * std::numeric_limits<double>::epsilon();
  double largest = 0.0;  // on the way: a state that ends at rest is zero but for roundings of what it was
  for (const auto& row : reference.trajectory.x) {
    for (const double x : row) largest = std::max(largest, std::abs(x));
  }
  const auto [state, time] = agreement(*second, reference);
  study.floor = std::max(10.0 * state.value_or(0.0), rounding * largest);
  study.time_floor = std::max(10.0 * time.value_or(0.0), rounding * std::abs(reference.final.t));
  return {};
}

std::vector<result::OrderSeries> planned(const SimulateOptions& options, const OrderOptions& what) {
  const auto record = option_record(options);
  std::vector<result::OrderSeries> series;
  for (const auto* method : {"fesd", "timestepping"}) {
    const auto form = recorded<std::string>(record, std::string(method) + ".reformulation").value_or("step");
    for (const auto& scheme : what.schemes) {
      series.push_back({method, scheme.name, scheme.stages, what.reformulation.value_or(form), {}, {}, {}});
    }
  }
  return series;
}

}  // namespace

Expected<std::vector<OrderScheme>> parse_schemes(std::string_view text) {
  std::vector<OrderScheme> schemes;
  for (const auto piece : split(text, ',')) {
    const auto colon = piece.find(':');
    const auto stages = colon == std::string_view::npos ? std::nullopt : whole_text_as<long>(piece.substr(colon + 1));
    if (colon == 0 || !stages || *stages < 1 || *stages > 99) {
      return tl::unexpected(unreadable("NAME:STAGES", piece, "for example --schemes radau_iia:2,gauss_legendre:3"));
    }
    OrderScheme scheme{std::string(piece.substr(0, colon)), static_cast<int>(*stages)};
    if (contains(schemes, scheme)) {
      return tl::unexpected(unreadable("every scheme once", piece, "leave the second one out"));
    }
    schemes.push_back(std::move(scheme));
  }
  return schemes;
}

Expected<std::vector<long>> parse_steps(std::string_view text) {
  std::vector<long> steps;
  for (const auto piece : split(text, ',')) {
    const auto number = whole_text_as<long>(piece);
    if (!number || *number < 1 || (!steps.empty() && *number <= steps.back())) {
      return tl::unexpected(unreadable("ascending whole numbers >= 1", piece, "for example --steps 25,50,100,200"));
    }
    steps.push_back(*number);
  }
  if (steps.size() < 2) {
    return tl::unexpected(unreadable("at least two numbers of steps", text, "one step size has no slope"));
  }
  return steps;
}

std::optional<double> fitted_slope(std::span<const double> steps, std::span<const double> errors, double floor) {
  double n = 0.0, x_mean = 0.0, y_mean = 0.0;
  const auto counts = [&](std::size_t i) { return errors[i] > floor && errors[i] > 0.0; };
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (!counts(i)) continue;
    n += 1.0;
    x_mean += std::log(steps[i]);
    y_mean += std::log(errors[i]);
  }
  if (n < 2.0) return std::nullopt;
  x_mean /= n;
  y_mean /= n;
  double covariance = 0.0, variance = 0.0;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (!counts(i)) continue;
    const double x = std::log(steps[i]) - x_mean;
    covariance += x * (std::log(errors[i]) - y_mean);
    variance += x * x;
  }
  if (!(variance > 0.0)) return std::nullopt;
  return covariance / variance;
}

void measure(result::OrderStudy& study, const result::Result& reference, std::span<const long> steps, RunAtSteps run) {
  for (auto& series : study.series) {
    for (const long count : steps) series.points.push_back(point(run(series, count), series, count, reference));
    series.slope = slope(series.points, &result::OrderPoint::error, study.floor);
    if (!reference.events.empty()) {
      series.switch_time_slope = slope(series.points, &result::OrderPoint::switch_time_error, study.time_floor);
    }
  }
}

Expected<result::Result> order(const model::System& system, const SimulateOptions& options, const OrderOptions& what,
                               const Observers& observers) {
  if (const auto problem = find_problem(options)) return tl::unexpected(problem->error);
  result::OrderStudy study;
  study.series = planned(options, what);
  for (const auto& series : study.series) {
    if (auto known = options_of(series, what.steps.front(), options); !known) return tl::unexpected(known.error());
  }
  Numbered watch(observers, static_cast<long>(2 + study.series.size() * what.steps.size()));
  const auto tight = reference_options(options);
  auto reference = simulate(system, tight, watch.next());
  if (!reference) return reference;
  reference->command = "order";
  study.reference = reference_name(tight);
  if (auto found = find_floor(system, tight, *reference, watch.next(), study); !found) {
    return tl::unexpected(found.error());
  }
  std::optional<Error> first_refusal;
  bool any = false;
  const auto run = [&](const result::OrderSeries& series, long steps) -> Expected<result::Result> {
    if (watch.stopped()) {
      return tl::unexpected(Error{ErrorCode::not_available, "stopped by the user before it began", "", {}, {}});
    }
    auto found = options_of(series, steps, options).and_then([&](const SimulateOptions& chosen) {
      return simulate(system, chosen, watch.next());
    });
    any = any || found.has_value();
    if (!found && !first_refusal) first_refusal = found.error();
    return found;
  };
  if (is_done(reference->status.termination)) measure(study, *reference, what.steps, run);
  if (!any && first_refusal) return tl::unexpected(*first_refusal);
  reference->order = std::move(study);
  return reference;
}

}  // namespace saltus::pipeline
