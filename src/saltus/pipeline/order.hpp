// How errors fall with the step: Fig. 6 of [nurkanovic2024] for any model.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/base/function_ref.hpp"
#include "saltus/pipeline/simulate.hpp"
#include "saltus/result/comparison.hpp"

namespace saltus::pipeline {

struct OrderScheme {
  std::string name;  ///< as in fesd.scheme
  int stages = 1;
  bool operator==(const OrderScheme&) const = default;
};

/// Says what to measure. Everything else is as in [simulate.fesd] and [simulate.timestepping].
struct OrderOptions {
  std::vector<OrderScheme> schemes{{"radau_iia", 1}, {"radau_iia", 2}, {"radau_iia", 3}, {"gauss_legendre", 2}};
  std::vector<long> steps{25, 50, 100, 200, 400};  ///< simulation steps, ascending
  std::optional<std::string> reformulation{};      ///< step or stewart; that of the options without
};

/// Reads "radau_iia:2,gauss_legendre:3"; errors (invalid_option) say what was expected and found.
[[nodiscard]] Expected<std::vector<OrderScheme>> parse_schemes(std::string_view text);
/// Reads "25,50,100": whole numbers >= 1, at least two, ascending.
[[nodiscard]] Expected<std::vector<long>> parse_steps(std::string_view text);

/// Finds the slope of the straight line that fits log(error) over log(step) in the least squares. Points with an error
/// of at most `floor` say nothing about the scheme and are left out.
/// @return nullopt if fewer than two points are left, or all at one step.
[[nodiscard]] std::optional<double> fitted_slope(std::span<const double> steps, std::span<const double> errors,
                                                 double floor);

/// One run of a series; its points are those before. An Error where the run cannot start.
using RunAtSteps = FunctionRef<Expected<result::Result>(const result::OrderSeries& series, long steps)>;

/// Fills in points and slopes of all series. Runs go on after failures, which become reasons of their points.
/// @param study      its series have no points yet
/// @param reference  a run that is more accurate than all others
void measure(result::OrderStudy& study, const result::Result& reference, std::span<const long> steps, RunAtSteps run);

/// Runs the model with every scheme, with (fesd) and without (timestepping) switch detection, with every number of
/// steps, and compares with the event engine at its tightest (reference_options). The floor of the errors is what two
/// such runs, the second with ten times the tolerances, differ by, ten times.
/// @return the result of the reference run with `order`; an Error for options that do not exist, or if no run could be
///         started: then the first reason.
[[nodiscard]] Expected<result::Result> order(const model::System& system, const SimulateOptions& options,
                                             const OrderOptions& what, const Observers& observers = {});

}  // namespace saltus::pipeline
