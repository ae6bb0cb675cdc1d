#include "saltus/frontend/sweep_folder.hpp"

#include <algorithm>
#include <cerrno>
#include <fcntl.h>
#include <optional>
#include <string_view>
#include <sys/file.h>
#include <unistd.h>

#include <fmt/format.h>

#include "saltus/base/text.hpp"
#include "saltus/base/version.hpp"
#include "saltus/frontend/share_text.hpp"
#include "saltus/io/atomic_file.hpp"

namespace saltus::frontend {
namespace {

namespace fs = std::filesystem;

/// Few enough that what a kill costs is little, many enough that a million runs are no million files.
constexpr std::size_t runs_of_share = 1000;
constexpr std::size_t least_shares = 64;  // of a small sweep, whose runs may be long
constexpr std::size_t most_shares = 10'000;
constexpr std::string_view form = "saltus sweep 1";
constexpr std::string_view statement_name = "_sweep.txt";  // readers of tables leave out what begins so

Error refused_folder(const fs::path& folder, std::string_view why, std::string remedy) {
  return {ErrorCode::io_failure, fmt::format("--resume {}: {}", folder.string(), why), std::move(remedy), {}, {}};
}

constexpr const char* other_folder = "name another folder, which may be a new one";

std::size_t shares_of(std::size_t runs) {
  return std::min(std::max((runs + runs_of_share - 1) / runs_of_share, std::min(runs, least_shares)), most_shares);
}

/// The value of a line "KEY VALUE".
std::string value_of(const std::string& text, std::string_view key) {
  for (const auto line : split(text, '\n')) {
    if (line.starts_with(key) && line.size() > key.size() && line[key.size()] == ' ')
      return std::string(line.substr(key.size() + 1));
  }
  return "";
}

}  // namespace

/// Another process that fills the folder has the lock; the system frees it when that one ends, however it does.
struct SweepFolder::Lock {
  explicit Lock(const fs::path& path) : number(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666)) {}
  Lock(const Lock&) = delete;
  Lock& operator=(const Lock&) = delete;
  ~Lock() {
    if (number >= 0) ::close(number);
  }
  /// Some file systems have no locks: then nothing is known of others.
  [[nodiscard]] bool is_taken() const { return ::flock(number, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK; }
  int number;
};

std::string SweepFolder::file_of(std::size_t number) const {
  return (folder_ / fmt::format("share-{:05}.csv", number)).string();
}

Expected<void> SweepFolder::read_or_begin() {
  const auto statement = folder_ / statement_name;
  std::error_code unknown;
  if (!fs::exists(statement, unknown)) {
    if (fs::exists(folder_, unknown) && (!fs::is_directory(folder_, unknown) || !fs::is_empty(folder_, unknown))) {
      return tl::unexpected(refused_folder(folder_, "there are other files, and no sweep", other_folder));
    }
    fs::create_directories(folder_, unknown);
    return io::write_file(statement, fmt::format("{}\nversion {}\nparts csv\nsweep {}\nruns {}\nblocks {}\n", form,
                                                 version, mark_, runs_, shares_));
  }
  const auto text = io::read_file(statement);
  if (!text) return tl::unexpected(text.error());
  const auto refuse = [&](std::string_view why, std::string remedy) {
    return tl::unexpected(refused_folder(folder_, why, std::move(remedy)));
  };
  if (!text->starts_with(form) || value_of(*text, "sweep").empty())
    return refuse("its _sweep.txt is no statement of a sweep", other_folder);
  if (value_of(*text, "parts") != "csv") {
    return refuse("a sweep of the Python package", "go on with m.sweep(…, resume=…), or name another folder");
  }
  if (const auto of = value_of(*text, "version"); of != version) {
    return refuse(fmt::format("it was begun with version {} of Saltus, this is {}", of, version),
                  "digits may differ between versions: go on with that one, or name another folder");
  }
  if (value_of(*text, "sweep") != mark_ || value_of(*text, "runs") != fmt::format("{}", runs_)) {
    return refuse(fmt::format("a folder of another sweep, of {} runs: model, settings, values or --keep differ",
                              value_of(*text, "runs")),
                  other_folder);
  }
  return {};
}

Expected<void> SweepFolder::count_shares() {
  for (std::size_t i = 1; i <= shares_; ++i) {
    std::error_code unknown;
    if (!fs::exists(file_of(i), unknown)) continue;
    const auto tally = tally_of_share(file_of(i), {i, shares_}, mark_);
    if (!tally) {
      auto error = tally.error();
      error.remedy = "nothing was written; remove this file, and these runs are run again";
      return tl::unexpected(std::move(error));
    }
    there_[i - 1] = true;
    tally_ += *tally;
  }
  return {};
}

Expected<SweepFolder> SweepFolder::open(const std::string& folder, const std::string& mark, std::size_t runs,
                                        const Share& task) {
  SweepFolder opened;
  opened.folder_ = folder;
  opened.mark_ = mark;
  opened.runs_ = runs;
  opened.shares_ = shares_of(runs);
  opened.task_ = task;
  opened.there_.resize(opened.shares_);
  if (task.of > opened.shares_) {
    return tl::unexpected(refused_folder(folder, fmt::format("{} shares, and --task of {}", opened.shares_, task.of),
                                         "a folder is filled by at most so many tasks"));
  }
  if (auto begun = opened.read_or_begin(); !begun) return tl::unexpected(begun.error());
  opened.lock_ = std::make_shared<Lock>(opened.folder_ / fmt::format("_lock-{}-of-{}", task.number, task.of));
  if (opened.lock_->is_taken()) {
    return tl::unexpected(refused_folder(folder, "another sweep fills this folder", "wait for it, or end its process"));
  }
  if (auto counted = opened.count_shares(); !counted) return tl::unexpected(counted.error());
  return opened;
}

std::vector<Share> SweepFolder::missing() const {
  std::vector<Share> missing;
  for (std::size_t i = task_.begin(shares_); i < task_.end(shares_); ++i) {
    if (!there_[i]) missing.push_back({i + 1, shares_});
  }
  return missing;
}

Expected<void> SweepFolder::add(const Share& share, const std::vector<TableColumn>& table) {
  if (auto written = io::write_file(file_of(share.number), to_csv(table)); !written) return written;
  const auto tally = tally_of_share(file_of(share.number), share, mark_);
  if (!tally) return tl::unexpected(tally.error());
  there_[share.number - 1] = true;
  tally_ += *tally;
  return {};
}

std::vector<std::string> SweepFolder::files() const {
  std::vector<std::string> files;
  for (std::size_t i = 1; i <= shares_; ++i) files.push_back(file_of(i));
  return files;
}

Expected<void> SweepFolder::write_csv(const std::string& file) const {
  std::optional<Error> failure;
  const auto for_each_share = [&](const auto& visit) {
    for (const auto& share : files()) {
      const auto text = io::read_file(share);
      if (!text) failure = text.error();
      if (!text || !visit(*text)) return false;
    }
    return true;
  };
  const auto write = [&](io::Sink sink) {
    JoinedHeadings whole;
    const auto note = [&](const std::string& text) {
      whole.add(headings_of(text));
      return true;
    };
    if (!for_each_share(note)) return false;
    std::vector<TableColumn> empty;
    for (const auto& name : whole.all()) empty.push_back({name, {}});
    return sink(to_csv(empty)) && for_each_share([&](const std::string& text) { return sink(rows_of(text, whole)); });
  };
  auto written = io::stream_file(file, write);
  if (failure) return tl::unexpected(std::move(*failure));
  return written;
}

}  // namespace saltus::frontend
