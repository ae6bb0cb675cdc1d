#include "saltus/frontend/catalogue.hpp"

#include <algorithm>
#include <cstdlib>
#include <map>

#include <fmt/format.h>

#include "saltus/frontend/sized_models.hpp"
#include "saltus/io/atomic_file.hpp"

namespace saltus::frontend {
namespace {

namespace fs = std::filesystem;

fs::path& chosen_folder() {
  static fs::path folder;
  return folder;
}

/// <executable>/../share/saltus of an installation.
fs::path shared_folder() {
  if (!chosen_folder().empty()) return chosen_folder();
  std::error_code unknown;
  const auto executable = fs::read_symlink("/proc/self/exe", unknown);
  return unknown ? fs::path() : executable.parent_path().parent_path() / "share" / "saltus";
}

std::vector<fs::path> model_folders() {
  std::vector<fs::path> folders;
  if (const char* chosen = std::getenv("SALTUS_MODELS"); chosen != nullptr && *chosen != '\0')
    folders.emplace_back(chosen);
  for (const auto& root : {shared_folder(), fs::path(SALTUS_SOURCE_DIR)}) {
    folders.push_back(root / "models");
    folders.push_back(root / "models" / "optima");
  }
  return folders;
}

std::vector<fs::path> plotly_places() {
  const fs::path environment = fs::path(SALTUS_SOURCE_DIR) / ".venv";
  std::vector<fs::path> places{shared_folder() / "plotly.min.js", environment / "plotly" / "plotly.min.js"};
  std::error_code none;
  for (fs::directory_iterator python(environment / "lib", none), end; !none && python != end; python.increment(none)) {
    places.push_back(python->path() / "site-packages" / "plotly" / "package_data" / "plotly.min.js");
  }
  return places;
}

/// A file that is not there, where its folder has one with a name like it, is told with that name.
Expected<fs::path> path_or_nearest(const fs::path& path) {
  std::error_code none;
  if (fs::exists(path, none)) return path;
  std::vector<std::string> near;
  const auto folder = path.parent_path();
  for (fs::directory_iterator file(folder.empty() ? fs::path(".") : folder, none), end; !none && file != end;
       file.increment(none)) {
    std::error_code broken;
    if (file->path().extension() != path.extension() || !fs::exists(file->path(), broken)) continue;
    // What all of them share, folder and ending, makes no names alike.
    if (nearest_names(path.stem().string(), {file->path().stem().string()}).empty()) continue;
    near.push_back((folder / file->path().filename()).string());
  }
  if (near.empty()) return path;
  std::sort(near.begin(), near.end());
  return tl::unexpected(
      Error{ErrorCode::io_failure, "there is no such file", suggest(path.string(), near), {path.string(), 0, 0}, {}});
}

}  // namespace

void set_shared_folder(const fs::path& folder) { chosen_folder() = folder; }

std::vector<CatalogueEntry> catalogue() {
  std::map<std::string, fs::path> found;
  for (const auto& folder : model_folders()) {
    std::error_code none;
    for (fs::directory_iterator file(folder, none), end; !none && file != end; file.increment(none)) {
      if (file->path().extension() == ".toml") found.emplace(file->path().stem().string(), file->path());
    }
  }
  std::vector<CatalogueEntry> entries;
  for (auto& [name, file] : found) entries.push_back({name, file});
  return entries;
}

Expected<fs::path> find_model(const std::string& model) {
  std::error_code ignored;
  const fs::path path(model);
  if (model == "-" || (fs::exists(path, ignored) && !fs::is_directory(path, ignored))) return path;
  std::vector<std::string> known;
  for (const auto& entry : catalogue()) {
    if (entry.name == model) return entry.file;
    known.push_back(entry.name);
  }
  const bool is_path = model.find('/') != std::string::npos || path.extension() == ".toml" || fs::exists(path, ignored);
  if (is_path) return path_or_nearest(path);
  if (const auto* sized = find_sized_model(model)) {
    return tl::unexpected(Error{
        ErrorCode::unknown_name, fmt::format("'{}' is a model of any size", model), how_to_write(*sized), {}, {}});
  }
  const auto nearest = nearest_names(model, known);
  if (fs::exists(path.string() + ".toml", ignored)) {
    return tl::unexpected(Error{ErrorCode::unknown_name,
                                fmt::format("'{}' is no file and no model of the catalogue", model),
                                fmt::format("did you mean the file {}.toml?", model),
                                {},
                                {}});
  }
  return tl::unexpected(Error{ErrorCode::unknown_name,
                              fmt::format("'{}' is no file and no model of the catalogue", model),
                              nearest.empty() ? "`saltus models` lists the catalogue" : suggest(model, known),
                              {},
                              {}});
}

Expected<std::string> plotly_source() {
  if (const char* chosen = std::getenv("SALTUS_PLOTLY"); chosen != nullptr && *chosen != '\0') {
    auto source = io::read_file(chosen);
    if (!source) return tl::unexpected(with_context(source.error(), "which $SALTUS_PLOTLY names"));
    return source;
  }
  for (const auto& place : plotly_places()) {
    std::error_code ignored;
    if (fs::exists(place, ignored)) return io::read_file(place);
  }
  return tl::unexpected(Error{ErrorCode::io_failure,
                              "a report needs plotly.min.js, and it is nowhere to be found",
                              "install PyPI's plotly and set SALTUS_PLOTLY to its package_data/plotly.min.js",
                              {},
                              {}});
}

}  // namespace saltus::frontend
