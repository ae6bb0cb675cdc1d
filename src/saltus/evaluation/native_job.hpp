// A compiler at work on one C source, beside everything else.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <sys/types.h>

#include "saltus/base/error.hpp"
#include "saltus/evaluation/native_code.hpp"

namespace saltus::evaluation {

/// Returns what find_native() compares and compile_native() compiles: the source below what its machine code depends
/// on.
[[nodiscard]] std::string native_content(const std::string& source);
/// Returns where the library of a content is.
[[nodiscard]] std::filesystem::path native_library_file(const std::filesystem::path& folder,
                                                        const std::string& content);
[[nodiscard]] std::optional<NativeLibrary> open_library(const std::filesystem::path& file);

/// Holds a running compiler, which is ended with the job; nothing half-written is left behind.
class NativeJob {
 public:
  /// Fails (not_available) without cache folder or compiler.
  [[nodiscard]] static Expected<std::unique_ptr<NativeJob>> start(const std::string& source);
  NativeJob(const NativeJob&) = delete;
  NativeJob& operator=(const NativeJob&) = delete;
  ~NativeJob();

  /// Returns whether the compiler has ended. Cost: one call of the system.
  [[nodiscard]] bool has_ended();
  /// Waits for its end, and puts the library into the cache.
  [[nodiscard]] Expected<NativeLibrary> finish();

 private:
  NativeJob() = default;
  bool take_status(int options);
  void remove_files();

  pid_t child_ = -1;  ///< -1: ended
  bool succeeded_ = false;
  std::filesystem::path library_, own_, c_file_, log_;
};

}  // namespace saltus::evaluation
