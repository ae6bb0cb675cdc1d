// The one table of the options of a simulation: names, ranges and meanings for model files, --set, --help, the record
// in the result, and docs/options.md.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/pipeline/options/option_kind.hpp"
#include "saltus/pipeline/options/simulate_options.hpp"
#include "saltus/result/result.hpp"

namespace saltus::pipeline {

/// Holds one option a person may write. Spelled the same in TOML ([simulate.event] integrator = VALUE) and on the
/// command line (--set simulate.event.integrator=VALUE).
template <class Options>
struct FieldOf {
  std::string_view key;  ///< dotted, below its section; a final `*` stands for a name of the model
  OptionKind kind;
  std::string_view doc;  ///< one sentence
  /// Writes a value of this kind into the options. `name` is what `*` stands for.
  void (*set)(Options&, std::string_view name, const result::OptionValue&);
  /// Appends the values in force under their full names ("simulate.event.integrator"); nothing if the option is not.
  void (*record)(const Options&, std::string_view key, result::OptionRecord&);
  /// Says more about a value of another kind; may be null.
  void (*explain)(Error&, const result::OptionValue&) = nullptr;
};
using OptionField = FieldOf<SimulateOptions>;

/// Returns all options of a simulation, in the order of the documentation.
[[nodiscard]] std::span<const OptionField> simulate_fields();

/// Returns keys of simulate_fields(), without those with a `*`.
[[nodiscard]] std::vector<std::string> simulate_keys();

/// Returns the options with one of them replaced.
/// @param key    dotted, below [simulate]: "rtol", "event.integrator", "initial_mode.slip"
/// @param value  as written; integers are taken where numbers are expected
/// @return the options, or unknown_name (with the nearest known keys), invalid_option or not_available, each naming
///         what was expected and what was found, without a location.
[[nodiscard]] Expected<SimulateOptions> with_value(SimulateOptions options, std::string_view key,
                                                   const result::OptionValue& value);

/// Returns every option with its value in force, under its full name, for Result::options.
[[nodiscard]] result::OptionRecord option_record(const SimulateOptions& options);

/// Holds what is wrong between options that are fine one by one, and the key (below [simulate]) that shows it best.
struct OptionProblem {
  std::string key;
  Error error;
};

/// Returns the number of rows an output grid asks for between two times, both ends among them; 0 for every step.
[[nodiscard]] double number_of_rows(const OutputGrid& grid, double begin, double end);

/// Checks the options, which a program may have set to anything, one by one and against each other: `until` given and
/// after `from`, rtol + atol > 0, output times within the span and not too many, no initial_mode where no modes are
/// decided.
/// @return the first problem, or nullopt if a simulation may start.
[[nodiscard]] std::optional<OptionProblem> find_problem(const SimulateOptions& options);

/// Writes two lines per option: key, what is expected and default; meaning. For --help.
[[nodiscard]] std::string options_help();

/// Writes the page docs/options.md.
[[nodiscard]] std::string options_page();

/// Writes a value as a person would write it in a model file.
[[nodiscard]] std::string to_text(const result::OptionValue& value);

}  // namespace saltus::pipeline
