#include "saltus/io/atomic_file.hpp"

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>

#include <fmt/format.h>

namespace saltus::io {
namespace {

namespace fs = std::filesystem;

tl::unexpected<Error> failure(const fs::path& path, std::string message, std::string remedy = "") {
  return tl::unexpected(Error{ErrorCode::io_failure, std::move(message), std::move(remedy), {path.string(), 0, 0}, {}});
}

std::string reason(int error_number) { return std::strerror(error_number); }

/// Closes on every path out of a function.
class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() { close(); }

  [[nodiscard]] int number() const { return number_; }
  /// 0, or -1 with errno: some file systems report a failed write only here.
  int close() { return number_ < 0 ? 0 : ::close(std::exchange(number_, -1)); }

 private:
  int number_;
};

/// 0 or errno.
int write_all(int number, std::string_view content) {
  while (!content.empty()) {
    const auto written = ::write(number, content.data(), content.size());
    if (written < 0 && errno != EINTR) return errno;
    if (written > 0) content.remove_prefix(static_cast<std::size_t>(written));
  }
  return 0;
}

fs::path folder_of(const fs::path& path) { return path.has_parent_path() ? path.parent_path() : fs::path("."); }

/// A temporary file beside the target, removed unless it became the target.
class TemporaryFile {
 public:
  explicit TemporaryFile(const fs::path& target)
      : path_((folder_of(target) / ".saltus-XXXXXX.tmp").string()),
        descriptor_(::mkostemps(path_.data(), 4, O_CLOEXEC)),
        error_number_(descriptor_.number() < 0 ? errno : 0) {}
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile() {
    if (error_number_ == 0 && !became_target_) ::unlink(path_.c_str());
  }

  [[nodiscard]] int error_number() const { return error_number_; }

  /// 0 or errno.
  int write(std::string_view content) { return write_all(descriptor_.number(), content); }

  /// Flushes to disk, then renames over the target: after a crash there is the old file or the new one. 0 or errno.
  int replace(const fs::path& target) {
    struct stat old {};
    const mode_t mask = ::umask(0);
    ::umask(mask);
    const mode_t mode = ::stat(target.c_str(), &old) == 0 ? (old.st_mode & 07777) : (0666 & ~mask);
    if (::fchmod(descriptor_.number(), mode) != 0 || ::fsync(descriptor_.number()) != 0 || descriptor_.close() != 0 ||
        ::rename(path_.c_str(), target.c_str()) != 0) {
      return errno;
    }
    became_target_ = true;
    const Descriptor folder(::open(folder_of(target).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (folder.number() >= 0) ::fsync(folder.number());  // not every file system can; the rename is done anyway
    return 0;
  }

 private:
  std::string path_;
  Descriptor descriptor_;
  int error_number_;
  bool became_target_ = false;
};

}  // namespace

fs::path target_of(fs::path path) {
  constexpr int most_links = 40;  // as in Linux; a circle of links ends, too
  std::error_code none;
  for (int links = 0; links < most_links && fs::is_symlink(path, none); ++links) {
    const auto next = fs::read_symlink(path, none);
    if (none) break;
    path = path.parent_path() / next;  // an absolute one replaces all of it
  }
  return path;
}

Expected<void> check_writable(const fs::path& path) {
  std::error_code ignored;
  if (!path.has_filename() || fs::is_directory(path, ignored)) {
    return failure(path, "cannot write: this is a folder", "name a file in it");
  }
  const auto target = target_of(path);
  const auto folder = folder_of(target);
  if (!fs::exists(folder, ignored)) {
    return failure(path, fmt::format("cannot write: there is no folder '{}'", folder.string()), "create it first");
  }
  if (!fs::is_directory(folder, ignored)) {
    return failure(path, fmt::format("cannot write: '{}' is not a folder", folder.string()));
  }
  if (fs::exists(target, ignored)) {
    if (!fs::is_regular_file(target, ignored)) return failure(path, "cannot write: not a regular file");
    if (::access(target.c_str(), W_OK) != 0) {
      return failure(path, fmt::format("cannot write: {}", reason(errno)), "write-protected? choose another name");
    }
  }
  struct stat old {};
  if (::stat(target.c_str(), &old) != 0 && errno != ENOENT) {  // too long a name, a circle of links
    return failure(path, fmt::format("cannot write: {}", reason(errno)), "choose another name");
  }
  const TemporaryFile trial(target);  // the surest test: quotas and read-only mounts show here, too
  if (trial.error_number() != 0) {
    return failure(path,
                   fmt::format("cannot write into folder '{}': {}", folder.string(), reason(trial.error_number())),
                   "choose a folder you may write to");
  }
  return {};
}

Expected<void> write_file(const fs::path& path, std::string_view content) {
  return stream_file(path, [&](Sink sink) { return sink(content); });
}

Expected<void> stream_file(const fs::path& path, Writer writer) {
  const auto target = target_of(path);
  TemporaryFile file(target);
  int error_number = file.error_number();
  if (error_number == 0) {
    const bool complete = writer([&](std::string_view piece) {
      error_number = file.write(piece);
      return error_number == 0;
    });
    if (!complete && error_number == 0) error_number = ECANCELED;
  }
  if (error_number == 0) error_number = file.replace(target);
  if (error_number == 0) return {};
  return failure(path, fmt::format("cannot write: {}", reason(error_number)),
                 "an earlier file of that name is as it was");
}

GrowingFile::GrowingFile(const fs::path& path) : target_(target_of(path)), part_(target_) { part_ += ".part"; }

bool GrowingFile::is_open() {
  if (number_ < 0 && error_number_ == 0) {
    number_ = ::open(part_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (number_ < 0) error_number_ = errno;
  }
  return error_number_ == 0;
}

GrowingFile::~GrowingFile() {
  if (number_ >= 0) ::close(number_);
}

bool GrowingFile::write(std::string_view piece) {
  if (is_open()) error_number_ = write_all(number_, piece);
  return error_number_ == 0;
}

void GrowingFile::spoil(std::string reason) {
  if (error_number_ == 0 && spoiled_.empty()) spoiled_ = std::move(reason);
}

Expected<void> GrowingFile::complete() {
  struct stat old {};
  const bool exists = ::stat(target_.c_str(), &old) == 0;
  if (spoiled_.empty() && is_open() && exists && ::fchmod(number_, old.st_mode & 07777) != 0) error_number_ = errno;
  if (error_number_ == 0 && spoiled_.empty() &&
      (::fsync(number_) != 0 || ::close(std::exchange(number_, -1)) != 0 ||
       ::rename(part_.c_str(), target_.c_str()) != 0)) {
    error_number_ = errno;
  }
  if (error_number_ == 0 && spoiled_.empty()) return {};
  const std::string part = number_ < 0 ? "" : fmt::format("what was written is in {}; ", part_.string());
  return failure(target_, fmt::format("cannot write: {}", error_number_ != 0 ? reason(error_number_) : spoiled_),
                 part + "an earlier file of that name is as it was");
}

void GrowingFile::remove() { ::unlink(part_.c_str()); }

SpoolFile::~SpoolFile() {
  if (number_ >= 0) ::close(number_);
}

bool SpoolFile::write(std::string_view piece) {
  if (number_ < 0 && error_number_ == 0) {
    std::string path = (folder_ / ".saltus-XXXXXX.tmp").string();
    number_ = ::mkostemps(path.data(), 4, O_CLOEXEC);
    if (number_ < 0) error_number_ = errno;
    if (number_ >= 0) ::unlink(path.c_str());
  }
  if (error_number_ == 0) error_number_ = write_all(number_, piece);
  size_ += piece.size();
  return error_number_ == 0;
}

bool SpoolFile::copy_to(Sink sink, std::uint64_t from, std::uint64_t count) {
  std::string buffer(std::min<std::uint64_t>(count, std::uint64_t{1} << 18), '\0');
  while (error_number_ == 0 && count > 0) {
    const std::size_t wanted = std::min<std::uint64_t>(count, buffer.size());
    for (std::size_t filled = 0; filled < wanted;) {
      const auto got = ::pread(number_, buffer.data() + filled, wanted - filled, static_cast<off_t>(from + filled));
      if (got < 0 && errno == EINTR) continue;
      if (got <= 0) error_number_ = got < 0 ? errno : EIO;
      if (got <= 0) return false;
      filled += static_cast<std::size_t>(got);
    }
    from += wanted, count -= wanted;
    if (!sink(std::string_view(buffer.data(), wanted))) return false;
  }
  return error_number_ == 0;
}

Expected<void> SpoolFile::outcome() const {
  if (error_number_ == 0) return {};
  return tl::unexpected(
      Error{ErrorCode::io_failure,
            fmt::format("rows cannot be put aside in folder '{}': {}", folder_.string(), reason(error_number_)),
            "make room there, or choose another folder for the output",
            {},
            {}});
}

Expected<std::string> read_file(const fs::path& path, std::size_t limit) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) return failure(path, "cannot read: this is a folder", "name a file in it");
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (file.number() < 0) {
    const int error_number = errno;
    if (error_number == ENOENT) return failure(path, "there is no such file");
    return failure(path, fmt::format("cannot read: {}", reason(error_number)));
  }
  std::string content;
  // A text that grows is there twice, for a while.
  if (const auto size = fs::file_size(path, ignored); !ignored) content.reserve(std::min<std::size_t>(size, limit));
  std::string buffer(1 << 16, '\0');
  for (;;) {
    const auto count = ::read(file.number(), buffer.data(), buffer.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return failure(path, fmt::format("cannot read: {}", reason(errno)));
    if (count == 0) return content;
    content.append(buffer, 0, static_cast<std::size_t>(count));
    if (content.size() > limit) {
      return failure(path, fmt::format("cannot read: larger than {} MiB", limit >> 20));
    }
  }
}

}  // namespace saltus::io
