// C sources as native code: compiled once by the system's C compiler, cached by content in the user's cache folder.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "saltus/base/error.hpp"

namespace saltus::evaluation {

/// Holds a shared library in memory; closed with the last copy of the handle.
class NativeLibrary {
 public:
  /// Returns the address of a function, or nullptr.
  [[nodiscard]] void* symbol(const std::string& name) const;

 private:
  friend std::optional<NativeLibrary> open_library(const std::filesystem::path& file);
  explicit NativeLibrary(std::shared_ptr<void> handle) : handle_(std::move(handle)) {}
  std::shared_ptr<void> handle_;  // shared: functions of one library live in several places
};

/// Returns $SALTUS_CACHE, else $XDG_CACHE_HOME/saltus, else ~/.cache/saltus; nullopt if none of them is set.
[[nodiscard]] std::optional<std::filesystem::path> cache_folder();

/// Returns the library of a C source if it has been compiled before, found by content (the stored source is compared,
/// so two sources never share a library). Never compiles.
[[nodiscard]] std::optional<NativeLibrary> find_native(const std::string& source);

/// Compiles a C source (cc, or $CC) with -O3 for this machine and -ffp-contract=off, so that results are bit-identical
/// to interpretation, and stores it in the cache; a half-written library is never found. Fails (not_available) without
/// compiler or cache folder, with the compiler's last words if it refuses the source. Cost: tenths of a second.
[[nodiscard]] Expected<NativeLibrary> compile_native(const std::string& source);

}  // namespace saltus::evaluation
