// A folder that a sweep fills share by share, so that it goes on where it was ended.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/frontend/sweep_share.hpp"

namespace saltus::frontend {

/// Holds a folder of one sweep: _sweep.txt says of which, shares of at most a thousand runs are files as `--task`
/// writes them. A share is there whole or not at all, whenever the process ends.
class SweepFolder {
 public:
  /// Opens a folder, or begins it where there is none, or an empty one. Shares that are there are read and counted.
  /// Nothing is written where it fails, which is for these:
  /// - a folder of another sweep, of another version of Saltus, of the Python package, or with other files;
  /// - a share that is not complete (a copy that broke off);
  /// - one that another process fills.
  /// @param mark  sweep_mark of the sweep
  /// @param task  which part of the shares this process computes, so that several fill one folder
  [[nodiscard]] static Expected<SweepFolder> open(const std::string& folder, const std::string& mark, std::size_t runs,
                                                  const Share& task);

  [[nodiscard]] std::size_t runs() const { return runs_; }
  /// Returns the shares that are to be computed, in their order.
  [[nodiscard]] std::vector<Share> missing() const;
  /// Returns what the runs that are there came to.
  [[nodiscard]] const SweepTally& tally() const { return tally_; }
  /// Writes a share, with its heading, and counts its runs.
  [[nodiscard]] Expected<void> add(const Share& share, const std::vector<TableColumn>& table);
  /// Returns the files of all shares, in their order.
  [[nodiscard]] std::vector<std::string> files() const;
  /// Writes the table of all shares, with one of them in memory at a time.
  [[nodiscard]] Expected<void> write_csv(const std::string& file) const;

 private:
  struct Lock;
  [[nodiscard]] std::string file_of(std::size_t number) const;
  [[nodiscard]] Expected<void> read_or_begin();
  [[nodiscard]] Expected<void> count_shares();

  std::filesystem::path folder_;
  std::string mark_;
  std::size_t runs_ = 0, shares_ = 1;
  Share task_;
  SweepTally tally_;
  std::vector<bool> there_;
  std::shared_ptr<Lock> lock_;
};

}  // namespace saltus::frontend
