// Shares of a sweep: what one of several tasks computes, and how their tables become one.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/frontend/model_input.hpp"
#include "saltus/frontend/sweep_page.hpp"
#include "saltus/frontend/sweep_plan.hpp"
#include "saltus/frontend/sweep_table.hpp"

namespace saltus::frontend {

/// Holds one of `of` shares, from 1: consecutive runs, as equal in number as can be.
struct Share {
  std::size_t number = 1, of = 1;
  [[nodiscard]] std::size_t begin(std::size_t runs) const { return (number - 1) * runs / of; }
  [[nodiscard]] std::size_t end(std::size_t runs) const { return number * runs / of; }
};

/// Reads a share from I/N; a share without a run is refused.
[[nodiscard]] Expected<Share> parse_share(const std::string& text, std::size_t runs);

/// Returns what tells the shares of one sweep from those of another: model, settings, plan and what is kept.
[[nodiscard]] std::string sweep_mark(const ModelInput& model, const SweepRequest& request, const std::string& keep);

/// Returns the heading of the first column of a share's table. It says whose it is, which of all `runs` it has, and
/// what the page of all says.
[[nodiscard]] std::string share_heading(const Share& share, std::size_t runs, const std::string& mark,
                                        const SweepPage& page);

/// Counts what runs have come to.
struct SweepTally {
  std::size_t runs = 0, others = 0, undecided = 0;  ///< of all; not unique; whose uniqueness is not decided
  std::map<std::string, std::size_t> statuses;
  std::size_t stopped = 0, first_stopped = 0;  ///< that stopped early; the first of them, from 1 (0: none)
  SweepTally& operator+=(const SweepTally& other);
};

/// Counts the runs of the file of a share. Fails where it is no complete table of this share of this sweep.
[[nodiscard]] Expected<SweepTally> tally_of_share(const std::string& file, const Share& share, const std::string& mark);

struct JoinedShares {
  std::vector<TableColumn> table;
  SweepPage page;  ///< without title, command and captions where the shares do not say them (older ones)
};

/// Returns the table and page of the whole sweep from the files (.csv) of all its shares, in any order: what one run of
/// it would have written; where a share lacks a column its rows have gaps there. Fails for these:
/// - a file that is no share, or whose runs are not those of its heading;
/// - shares of different sweeps, a missing one, and one that is there twice.
[[nodiscard]] Expected<JoinedShares> join_shares(const std::vector<std::string>& files);

}  // namespace saltus::frontend
