// Model file (TOML) -> Description and options.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/model/description.hpp"
#include "saltus/pipeline/options/optimize_options.hpp"
#include "saltus/pipeline/options/simulate_options.hpp"
#include "saltus/result/caption.hpp"
#include "saltus/result/result.hpp"

namespace saltus::io {

struct ModelFile {
  model::Description description;
  pipeline::SimulateOptions simulate;
  std::optional<pipeline::OptimizeOptions> optimize;  ///< of a file with [optimize]; its problem is in `description`
  result::Captions captions;                          ///< `unit` and `label`, in the order of the file
  std::string text;                                   ///< of the file
  std::string sha256;                                 ///< of the file's bytes
  std::vector<result::NamedFile> files;               ///< that it, or a setting, names
  /// Where each option was written ("rtol", "output.times"), for errors that show only later.
  std::vector<std::pair<std::string, SourceLocation>> option_locations;
  /// The same for options of [optimize] ("mpcc.tolerance").
  std::vector<std::pair<std::string, SourceLocation>> optimize_locations;
  /// Where each table begins, by its name.
  std::vector<std::pair<std::string, SourceLocation>> table_locations;
  bool is_whole = true;  ///< false if some entry was left out, since it could not be understood
};

/// Reads a model file. Every error has file, line, column, what was expected and found, and a remedy; unknown tables
/// and keys name the nearest known ones; tables that this version does not support are refused (not_available). "-" is
/// standard input. Of a stored result (JSON) it is the model that is in it.
[[nodiscard]] Expected<ModelFile> read_model(const std::filesystem::path& file);

/// Holds what parse_model and diagnose_model take.
struct ModelText {
  std::string name;  ///< for messages: the path of the model file, or "<standard input>"
  std::string text;
  std::vector<result::NamedFile> files{};  ///< of a stored result
  std::vector<std::string> settings{};     ///< NAME=VALUE: with which it was computed
  std::string path{};                      ///< what was read: the model file, or the result
};
/// Reads the text of a model file, or the model in a stored result. "-" is standard input.
[[nodiscard]] Expected<ModelText> read_model_text(const std::filesystem::path& file);

/// Does the same for text in memory; `file` is used in messages, and the folder it is in to find files that the model
/// names.
/// @param files  taken in place of those of these names
[[nodiscard]] Expected<ModelFile> parse_model(std::string_view text, const std::string& file,
                                              std::vector<result::NamedFile> files = {});

/// Holds a model file with all its mistakes.
struct Diagnosis {
  ModelFile model;            ///< as far as it could be read
  std::vector<Error> errors;  ///< in the order of the file; empty for one that parse_model takes
};

/// Reads on behind a mistake, so that all of them can be told: those of the file, and those of what it states
/// (model::find_mistakes). Mistakes that follow from another one are left out.
[[nodiscard]] Diagnosis diagnose_model(std::string_view text, const std::string& file);

/// Larger files are refused: no model is written by hand at that length.
inline constexpr std::size_t max_model_bytes = std::size_t{16} << 20;

/// Does what `--set a.b=value` says, for any key of the file:
/// - options of [simulate] and its inputs;
/// - options and expressions of [optimize];
/// - the inclusion;
/// - the expressions that the file already has ("states.q", "states.q.lower", "dynamics.v") in [parameters] [states]
///   [controls] [definitions] [switching] [dynamics] [outputs].
///
/// @param key    dotted path below the file's root
/// @param value  a number, a list of numbers, an expression, or a bare word
/// @return the model with that key replaced, or an error that names the nearest known keys.
[[nodiscard]] Expected<ModelFile> with_setting(ModelFile model, std::string_view key, std::string_view value);

/// Changes an option of [simulate] ("simulate.rtol") or [optimize] ("optimize.elements") and notes that it was given at
/// `location`.
[[nodiscard]] Expected<void> set_option(ModelFile& model, std::string_view key, std::string_view value,
                                        const SourceLocation& location);

/// Checks the options of [simulate] against each other (pipeline::find_problem), and tells where the file states them.
[[nodiscard]] Expected<void> check_options(const ModelFile& model);

/// Checks that the file has [optimize], and its options against each other and the problem (pipeline::find_problem),
/// and tells where the file states them.
[[nodiscard]] Expected<void> check_optimize_options(const ModelFile& model);

/// Reads the result that `initial_guess` or --start names (OptimizeOptions::start_result) into start_from; does nothing
/// if none is named. Fails if there is no such file, or if it holds no result.
[[nodiscard]] Expected<void> read_start_result(ModelFile& model);

/// Gives an error without a place that of the option or the table it is about. A frame of its context has to name it
/// ("in simulate.initial_mode.slip", "in [states]"). A table the file does not have is missed at its beginning.
[[nodiscard]] Error located(Error error, const ModelFile& model);

/// Does what `--set a.b=value` does for the options of a simulation: KEY is a dotted path below the file's root
/// ("simulate.rtol", "simulate.event.integrator"); a bare word is a string.
[[nodiscard]] Expected<pipeline::SimulateOptions> with_option(pipeline::SimulateOptions options, std::string_view key,
                                                              std::string_view value);

}  // namespace saltus::io
