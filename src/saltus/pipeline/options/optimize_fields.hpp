// The one table of the options of an optimisation: names, ranges and meanings for model files, --set, --help, the
// record in the result, and docs/options.md.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/model/ocp_description.hpp"
#include "saltus/pipeline/options/optimize_options.hpp"
#include "saltus/pipeline/options/option_fields.hpp"
#include "saltus/result/result.hpp"

namespace saltus::pipeline {

/// Holds one option a person may write under [optimize]. Spelled the same in TOML ([optimize.mpcc] sigma_final = VALUE)
/// and on the command line (--set optimize.mpcc.sigma_final=VALUE).
struct OptimizeField {
  std::string key;  ///< dotted, below [optimize]
  OptionKind kind;
  std::string doc;  ///< one sentence
  /// Writes a value of this kind into the options; no option has a name behind its key.
  std::function<void(OptimizeOptions&, std::string_view, const result::OptionValue&)> set;
  /// Appends the value in force under its full name; nothing if the option is not.
  std::function<void(const OptimizeOptions&, std::string_view key, result::OptionRecord&)> record;
  /// Says more about a value of another kind; may be null.
  void (*explain)(Error&, const result::OptionValue&) = nullptr;
};

/// Returns all options of an optimisation, in the order of the documentation.
[[nodiscard]] std::span<const OptimizeField> optimize_fields();

/// Returns keys of optimize_fields().
[[nodiscard]] std::vector<std::string> optimize_keys();

/// Holds a key of [optimize] that states the problem: an expression, a list of them, or a table.
struct ProblemKey {
  std::string_view key;      ///< "terminal_cost"
  std::string_view expects;  ///< "an expression"
  std::string_view doc;      ///< one sentence
};

/// Returns all keys of [optimize] that are not options, in the order of the documentation.
[[nodiscard]] std::span<const ProblemKey> problem_keys();

/// Returns the options with one of them replaced.
/// @param key    dotted, below [optimize]: "elements", "mpcc.tolerance"
/// @param value  as written; integers are taken where numbers are expected
/// @return the options, or unknown_name (with the nearest known keys, those of the problem among them), invalid_option
///         or not_available, each naming what was expected and what was found, without a location.
[[nodiscard]] Expected<OptimizeOptions> with_value(OptimizeOptions options, std::string_view key,
                                                   const result::OptionValue& value);

/// Returns every option with its value in force, under its full name ("optimize.mpcc.tolerance"), for Result::options.
[[nodiscard]] result::OptionRecord option_record(const OptimizeOptions& options);

/// Checks the options against each other and against the problem: control_intervals given, elements and references of
/// the right length, nothing that does not fit into memory, sigma falling.
/// @return the first problem, or nullopt if an optimisation may start. The error has a location where `problem` has
/// one.
[[nodiscard]] std::optional<OptionProblem> find_problem(const OptimizeOptions& options,
                                                        const model::OcpDescription& problem);

/// Writes two lines per option, as options_help() of a simulation.
[[nodiscard]] std::string optimize_options_help();

/// Writes the part of docs/options.md that is about [optimize].
[[nodiscard]] std::string optimize_options_page();

}  // namespace saltus::pipeline
