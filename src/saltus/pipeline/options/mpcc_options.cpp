#include "saltus/pipeline/options/mpcc_options.hpp"

#include <array>
#include <limits>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "saltus/pipeline/options/option_values_internal.hpp"

namespace saltus::pipeline {
namespace {

using solver::FirstProblem;
using solver::SolveOptions;
using solver::homotopy::Relaxation;
using solver::homotopy::Steering;
using solver::homotopy::WarmStart;

constexpr auto sigma_initial_of = [](auto& o) -> auto& { return o.schedule.sigma_initial; };
constexpr auto sigma_final_of = [](auto& o) -> auto& { return o.schedule.sigma_final; };
constexpr auto tolerance_of = [](auto& o) -> auto& { return o.tolerance; };
constexpr auto steering_of = [](auto& o) -> auto& { return o.steering; };
constexpr auto first_of = [](auto& o) -> auto& { return o.first; };
constexpr auto warm_start_of = [](auto& o) -> auto& { return o.warm_start; };

constexpr Choices<Steering, 3> steerings{{"direct", "l1", "linf"}, {Steering::direct, Steering::l1, Steering::linf}};
constexpr Choices<FirstProblem, 2> first_problems{{"relaxed", "branch"}, {FirstProblem::relaxed, FirstProblem::branch}};
constexpr Choices<WarmStart, 2> warm_starts{{"primal", "primal_dual"}, {WarmStart::primal, WarmStart::primal_dual}};

/// The names of the relaxations stand beside these themselves.
Expected<void> set_method(SolveOptions& options, std::string_view, const OptionValue& value) {
  std::vector<std::string> known;
  const auto* word = std::get_if<std::string>(&value);
  for (const auto relaxation : solver::homotopy::all_relaxations) {
    known.emplace_back(name(relaxation));
    if (word == nullptr || *word != known.back()) continue;
    options.relaxation = relaxation;
    return {};
  }
  auto error = out_of_range(fmt::format("\"{}\"", fmt::join(known, "\" or \"")), value);
  if (word != nullptr && !nearest_names(*word, known).empty()) error.remedy = suggest(*word, known);
  return tl::unexpected(std::move(error));
}

void record_method(const SolveOptions& options, std::string_view key, OptionRecord& record) {
  record.emplace_back(key, std::string(name(options.relaxation)));
}

Expected<void> set_sigma_factor(SolveOptions& options, std::string_view, const OptionValue& value) {
  const double number = number_in(value);
  if (!(number > 0.0 && number < 1.0)) return tl::unexpected(out_of_range("a number > 0 and < 1", value));
  options.schedule.sigma_factor = number;
  return {};
}

void record_sigma_factor(const SolveOptions& options, std::string_view key, OptionRecord& record) {
  record.emplace_back(key, options.schedule.sigma_factor);
}

Expected<void> set_crossover(SolveOptions& options, std::string_view, const OptionValue& value) {
  const auto* truth = std::get_if<bool>(&value);
  if (truth == nullptr) return tl::unexpected(out_of_range("true or false", value));
  options.crossover = *truth;
  return {};
}

void record_crossover(const SolveOptions& options, std::string_view key, OptionRecord& record) {
  record.emplace_back(key, options.crossover);
}

Expected<void> set_iteration_limit(SolveOptions& options, std::string_view, const OptionValue& value) {
  constexpr double most = std::numeric_limits<int>::max();
  const double number = number_in(value);
  if (!(number >= 1.0 && number <= most && number == std::floor(number))) {
    return tl::unexpected(out_of_range("a whole number >= 1", value));
  }
  options.iteration_limit = static_cast<int>(number);
  return {};
}

void record_iteration_limit(const SolveOptions& options, std::string_view key, OptionRecord& record) {
  record.emplace_back(key, std::int64_t{options.iteration_limit});
}

constexpr std::array fields_of_mpcc{
    MpccField{"method",
              "scholtes, fischer_burmeister, natural_residual, chen_chen_kanzow, steffensen_ulbrich_sine|poly, "
              "kanzow_schwartz, lin_fukushima, kadrani",
              "How complementarities are relaxed by sigma.", set_method, record_method},
    MpccField{"steering", "direct, l1, linf",
              "What makes sigma small: its bound alone, or a price on the sum or the largest of the products.",
              set_choice<steering_of, steerings, SolveOptions>, record_choice<steering_of, steerings, SolveOptions>},
    MpccField{"sigma_initial", "a finite number > 0", "Sigma of the first relaxed problem.",
              set_number<sigma_initial_of, Range::positive, SolveOptions>,
              record_number<sigma_initial_of, SolveOptions>},
    MpccField{"sigma_factor", "a number > 0 and < 1", "From one relaxed problem to the next.", set_sigma_factor,
              record_sigma_factor},
    MpccField{"sigma_final", "a finite number > 0", "Sigma of the last relaxed problem.",
              set_number<sigma_final_of, Range::positive, SolveOptions>, record_number<sigma_final_of, SolveOptions>},
    MpccField{"warm_start", "primal, primal_dual", "What the next relaxed problem starts with.",
              set_choice<warm_start_of, warm_starts, SolveOptions>,
              record_choice<warm_start_of, warm_starts, SolveOptions>},
    MpccField{"first", "relaxed, branch",
              "The problem that is solved first: the relaxed one of sigma_initial, or that of the sides of the start, "
              "for a start "
              "at a result of a similar problem.",
              set_choice<first_of, first_problems, SolveOptions>,
              record_choice<first_of, first_problems, SolveOptions>},
    MpccField{"crossover", "true, false",
              "Problems with one side of every pair fixed behind the relaxed ones: exact zeros, and a certificate.",
              set_crossover, record_crossover},
    MpccField{"tolerance", "a finite number > 0",
              "Of feasibility, complementarity min(|G|, |H|) and stationarity of the answer.",
              set_number<tolerance_of, Range::positive, SolveOptions>, record_number<tolerance_of, SolveOptions>},
    MpccField{"iteration_limit", "a whole number >= 1", "Of the solver, in all problems together.", set_iteration_limit,
              record_iteration_limit},
};

}  // namespace

std::span<const MpccField> mpcc_fields() { return fields_of_mpcc; }

Expected<void> set_mpcc_option(SolveOptions& options, std::string_view key, const OptionValue& value) {
  std::vector<std::string> known;
  for (const auto& field : fields_of_mpcc) {
    if (field.key == key) return field.set(options, key, value);
    known.emplace_back(field.key);
  }
  return tl::unexpected(Error{
      ErrorCode::unknown_name, fmt::format("unknown option mpcc.{}", key), suggest(std::string(key), known), {}, {}});
}

Expected<void> check_mpcc_options(const SolveOptions& options) {
  const auto& [initial, factor, final] = options.schedule;
  if (final <= initial) return {};
  return tl::unexpected(Error{ErrorCode::invalid_option,
                              fmt::format("sigma_final ({}) is above sigma_initial ({})", final, initial),
                              "sigma falls: choose sigma_final <= sigma_initial",
                              {},
                              {}});
}

}  // namespace saltus::pipeline
