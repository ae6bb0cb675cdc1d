// Model file (TOML) -> Description and options.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/model/description.hpp"
#include "saltus/pipeline/simulate_options.hpp"

namespace saltus::io {

struct ModelFile {
  model::Description description;
  pipeline::SimulateOptions simulate;
  std::string sha256;
};

/// Reads a model file. Every error has file, line, column, what was expected and found, and a remedy; unknown tables and
/// keys name the nearest known ones; tables that this version does not support are refused (not_available).
[[nodiscard]] Expected<ModelFile> read_model(const std::filesystem::path& file);
/// The same for text in memory; `file` is used in messages and to resolve nothing else.
[[nodiscard]] Expected<ModelFile> parse_model(std::string_view text, const std::string& file);

/// `--set a.b=value` for the options of a simulation: KEY is a dotted path below the file's root
/// ("simulate.rtol", "simulate.event.integrator"); a bare word is a string.
[[nodiscard]] Expected<pipeline::SimulateOptions> with_option(pipeline::SimulateOptions options, std::string_view key,
                                                              std::string_view value);

}  // namespace saltus::io
