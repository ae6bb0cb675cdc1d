// A model and its settings -> model file with the settings applied.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/io/toml/toml_model.hpp"
#include "saltus/model/description.hpp"
#include "saltus/result/result.hpp"

namespace saltus::frontend {

/// MODEL of the command line, read but not parsed.
using io::ModelText;

struct ModelInput {
  std::string path;
  io::ModelFile file;
  std::vector<model::Override> overrides;
  std::vector<std::string> settings{};  ///< NAME=VALUE in their order, those of a stored result first
  std::string call{};                   ///< the command line; empty elsewhere
};

/// @param model  path or catalogue name, - for standard input
[[nodiscard]] Expected<ModelText> read_model_text(const std::string& model);

/// @param model     path or catalogue name
/// @param settings  NAME=VALUE each; dotted names reach any key of the file, others replace a parameter, an initial
///                  value or a control's constant value; they come behind those of a stored result and replace the
///                  ones of the same name
[[nodiscard]] Expected<ModelInput> read_input(const std::string& model, const std::vector<std::string>& settings);
[[nodiscard]] Expected<ModelInput> read_input(const ModelText& text, const std::vector<std::string>& settings);

/// Applies one of these settings, which is noted.
[[nodiscard]] Expected<void> apply_setting(ModelInput& input, const std::string& setting);

/// Sets an option by its key, which is noted as such a setting.
/// @param written  what was typed, for messages
[[nodiscard]] Expected<void> apply_option(ModelInput& input, const std::string& key, const std::string& value,
                                          const std::string& written);

/// Says whether a command runs the method that was chosen, or several.
enum class RunMethods { chosen, several };

/// Returns which given options say nothing to the method that runs, as warnings. A file may hold the tables of several
/// methods; what is typed, and what stands in the table of this one, is meant. Data of inputs that begin behind the
/// start of the run are told, too.
[[nodiscard]] std::vector<std::string> options_without_effect(const io::ModelFile& file);

/// Adds what a simulation cannot know: what it takes to run it again (text of the model, files, settings, the call),
/// and the inputs as they were written.
/// @return what to tell of the environment: a date that is asked for and is none
[[nodiscard]] std::optional<std::string> complete_record(const ModelInput& input, result::Result& result);

/// Writes arguments as a shell reads them.
[[nodiscard]] std::string command_line(const std::vector<std::string>& arguments);

}  // namespace saltus::frontend
