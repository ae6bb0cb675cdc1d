// Whole files or none: a half-written output never replaces a good one.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

#include "saltus/base/error.hpp"

namespace saltus::io {

/// Where the bytes go: the file behind symbolic links, also one that is not there yet; the links stay.
[[nodiscard]] std::filesystem::path target_of(std::filesystem::path path);
/// Whether `path` could be written (folder exists and is writable, not a folder itself); found out before computing.
[[nodiscard]] Expected<void> check_writable(const std::filesystem::path& path);
/// Writes to a temporary file beside `path`, flushes it to disk, and renames it over `path`.
[[nodiscard]] Expected<void> write_file(const std::filesystem::path& path, std::string_view content);
/// The whole content of a file, device or pipe; more than `limit` bytes are an error (a device has no end).
[[nodiscard]] Expected<std::string> read_file(const std::filesystem::path& path,
                                              std::size_t limit = std::size_t{2} << 30);

}  // namespace saltus::io
