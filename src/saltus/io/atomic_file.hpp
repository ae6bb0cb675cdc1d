// Whole files or none: a half-written output never replaces a good one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>

#include "saltus/base/error.hpp"
#include "saltus/base/function_ref.hpp"

namespace saltus::io {

/// Returns where the bytes go: the file behind symbolic links, also one that is not there yet; the links stay.
[[nodiscard]] std::filesystem::path target_of(std::filesystem::path path);
/// Checks whether `path` could be written (folder exists and is writable, not a folder itself); found out before
/// computing.
[[nodiscard]] Expected<void> check_writable(const std::filesystem::path& path);
/// Writes to a temporary file beside `path`, flushes it to disk, and renames it over `path`.
[[nodiscard]] Expected<void> write_file(const std::filesystem::path& path, std::string_view content);

/// Takes bytes, a piece after the other. False: they cannot be written, or no more are wanted.
using Sink = FunctionRef<bool(std::string_view piece)>;
/// Hands all its bytes to a sink; false if the sink took not all of them.
using Writer = FunctionRef<bool(Sink)>;
/// Does as write_file, of what is written a piece after the other. Of a writer that returns false nothing is left: an
/// earlier file of that name is as it was.
[[nodiscard]] Expected<void> stream_file(const std::filesystem::path& path, Writer writer);
/// Is a file that grows beside its place, as NAME.part from its first bytes on, and is put there when it is complete:
/// whoever ends the program before finds in NAME.part what was written.
class GrowingFile {
 public:
  explicit GrowingFile(const std::filesystem::path& path);
  GrowingFile(const GrowingFile&) = delete;
  GrowingFile& operator=(const GrowingFile&) = delete;
  ~GrowingFile();
  /// Returns false if it could not be written, which complete() tells.
  bool write(std::string_view piece);
  /// Notes that something of it was lost elsewhere, for this reason: complete() tells, and puts nothing in its place.
  void spoil(std::string reason);
  /// Flushes it to disk and renames it over its place.
  [[nodiscard]] Expected<void> complete();
  /// Removes it; an earlier file of that name is as it was.
  void remove();

 private:
  bool is_open();

  std::filesystem::path target_, part_;
  int number_ = -1;
  int error_number_ = 0;
  std::string spoiled_;
};

/// Holds bytes that are put aside on the disk, in a file without a name, made with the first of them.
class SpoolFile {
 public:
  /// @param folder  where it lies
  explicit SpoolFile(std::filesystem::path folder) : folder_(std::move(folder)) {}
  SpoolFile(const SpoolFile&) = delete;
  SpoolFile& operator=(const SpoolFile&) = delete;
  ~SpoolFile();
  /// Returns false if it could not be written, now or before.
  bool write(std::string_view piece);
  [[nodiscard]] std::uint64_t size() const { return size_; }
  /// Hands so many bytes from a place on to a sink, in pieces; false if the sink, or the disk, did not.
  bool copy_to(Sink sink, std::uint64_t from, std::uint64_t count);
  bool copy_to(Sink sink) { return copy_to(sink, 0, size_); }
  /// Returns the first thing that failed, with the folder.
  [[nodiscard]] Expected<void> outcome() const;

 private:
  std::filesystem::path folder_;
  int number_ = -1;
  int error_number_ = 0;
  std::uint64_t size_ = 0;
};

/// Returns the whole content of a file, device or pipe; more than `limit` bytes are an error (a device has no end).
[[nodiscard]] Expected<std::string> read_file(const std::filesystem::path& path,
                                              std::size_t limit = std::size_t{2} << 30);

}  // namespace saltus::io
