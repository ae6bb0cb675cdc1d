// Files that a model names: read once, and kept with the result.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/result/result.hpp"

namespace saltus::io {

/// Reads the text of a file that a model names. One that is among `files` with its text is taken from there; any other
/// is read and noted there, with its text if that has at most 10^6 bytes. Fails if it cannot be read, or if it has not
/// the fingerprint that is noted.
[[nodiscard]] Expected<std::string> read_named(std::vector<result::NamedFile>& files,
                                               const std::filesystem::path& file);

}  // namespace saltus::io
