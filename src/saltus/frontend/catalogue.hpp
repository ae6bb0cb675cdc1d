// The shipped models, and other files that travel with the tool.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "saltus/base/error.hpp"

namespace saltus::frontend {

struct CatalogueEntry {
  std::string name;  ///< file name without .toml
  std::filesystem::path file;
};

/// Says where models and plotly.min.js are, if not in <executable>/../share/saltus: beside a library that is no program
/// of its own.
void set_shared_folder(const std::filesystem::path& folder);

/// Returns all models of the catalogue by name, from $SALTUS_MODELS, then <executable>/../share/saltus/models and its
/// folder optima, then those of the source tree; the first of a name counts.
[[nodiscard]] std::vector<CatalogueEntry> catalogue();

/// Returns the file that MODEL of the command line means: a path, or the name of a catalogue entry.
/// @return the file, or unknown_name with the nearest names.
[[nodiscard]] Expected<std::filesystem::path> find_model(const std::string& model);

/// Returns the text of plotly.min.js, from $SALTUS_PLOTLY, then <executable>/../share/saltus, then the virtual
/// environment of the source tree: the small one, or the one of the wheel.
[[nodiscard]] Expected<std::string> plotly_source();

}  // namespace saltus::frontend
