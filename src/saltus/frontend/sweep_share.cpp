#include "saltus/frontend/sweep_share.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <limits>
#include <optional>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "saltus/base/text.hpp"
#include "saltus/frontend/share_text.hpp"
#include "saltus/io/atomic_file.hpp"
#include "saltus/io/sha256.hpp"
#include "saltus/result/status.hpp"

namespace saltus::frontend {
namespace {

Error no_share(const std::string& file, const std::string& why, const std::string& remedy) {
  return {ErrorCode::parse_failure, fmt::format("{}: {}", file, why), remedy, {}, {}};
}

struct ShareTable {
  Share share;
  std::string mark, file;
  TextLines lines;  ///< headings first
  SweepPage page;   ///< as its heading says
};

constexpr std::string_view grid_word = "grid", pairs_word = "pairs";

/// What stands behind the bracket of a share's heading: fields of CSV, of them three for each caption; older shares
/// have fewer, or none.
void read_page(const std::string& text, SweepPage& page) {
  const auto lines = fields_of(text + "\n");
  if (lines.size() != 1 || lines[0].size() < 3) return;
  const auto& fields = lines[0];
  page.title = fields[0];
  page.command = fields[1];
  page.grid = fields[2] == grid_word;
  for (std::size_t k = 3; k + 3 <= fields.size(); k += 3)
    page.captions.emplace_back(fields[k], result::Caption{fields[k + 1], fields[k + 2]});
}

/// Those of the columns between the run and its status.
std::vector<std::string> changed_names(const std::vector<TableColumn>& table) {
  std::vector<std::string> names;
  for (std::size_t k = 1; k < table.size() && table[k].name != "status"; ++k) {
    const auto& name = table[k].name;
    names.push_back(name.ends_with("(0)") ? name.substr(0, name.size() - 3) : name);
  }
  return names;
}

/// Whether the rows are those of the runs from `first` to `last`; one for each where only ends are kept, which have the
/// column of their number of events last.
Expected<void> check_runs(const ShareTable& table, std::size_t first, std::size_t last) {
  const bool only_ends = table.lines[0].back() == "events";
  double expected = static_cast<double>(first) - 1.0;
  const auto damaged = [&](std::size_t line, const std::string& what) {
    return tl::unexpected(no_share(table.file, fmt::format("line {}: {}", line, what), "run this share again"));
  };
  for (std::size_t i = 1; i < table.lines.size(); ++i) {
    const auto& word = table.lines[i][0];
    const double run = whole_text_as<double>(word).value_or(-1.0);
    const bool next = run == expected + 1.0, same = !only_ends && i > 1 && run == expected;
    if (!next && !same) return damaged(i + 1, fmt::format("run {}, expected run {}", word, expected + 1.0));
    expected = run;
  }
  if (expected == static_cast<double>(last)) return {};
  return damaged(table.lines.size(), fmt::format("the table ends with run {}, expected run {}", expected, last));
}

Expected<ShareTable> read_share(const std::string& file) {
  const auto text = io::read_file(file);
  if (!text) return tl::unexpected(text.error());
  ShareTable table{{}, "", file, fields_of(*text), {}};
  const auto heading = table.lines.empty() || table.lines[0].empty() ? std::string() : table.lines[0][0];
  std::array<char, 65> mark{};
  int used = 0;
  std::size_t first = 0, last = 0;  // older shares do not tell of them
  const bool tells = std::sscanf(heading.c_str(), "run [task %zu of %zu, sweep %64[0-9a-f], runs %zu to %zu] %n",
                                 &table.share.number, &table.share.of, mark.data(), &first, &last, &used) == 5;
  if (!tells && std::sscanf(heading.c_str(), "run [task %zu of %zu, sweep %64[0-9a-f]] %n", &table.share.number,
                            &table.share.of, mark.data(), &used) != 3) {
    return tl::unexpected(no_share(file, "no share of a sweep", "join what `saltus sweep … --task I/N` wrote"));
  }
  table.mark = mark.data();
  read_page(heading.substr(static_cast<std::size_t>(used)), table.page);
  for (std::size_t i = 0; i < table.lines.size(); ++i) {
    if (table.lines[i].size() == table.lines[0].size()) continue;
    return tl::unexpected(no_share(
        file, fmt::format("line {} has {} values, expected {}", i + 1, table.lines[i].size(), table.lines[0].size()),
        "run this share again"));
  }
  if (tells) {
    if (auto whole = check_runs(table, first, last); !whole) return tl::unexpected(whole.error());
  }
  return table;
}

Expected<void> check_together(const std::vector<ShareTable>& shares) {
  const auto& first = shares.front();
  std::vector<std::string> seen(first.share.of);
  for (const auto& share : shares) {
    if (share.mark != first.mark || share.share.of != first.share.of) {
      return tl::unexpected(no_share(share.file,
                                     fmt::format("a share of another sweep (task of {}, {}) than {} (task of {}, {})",
                                                 share.share.of, share.mark, first.file, first.share.of, first.mark),
                                     "shares of one sweep have the same model, settings, values and number of tasks"));
    }
    if (share.share.number < 1 || share.share.number > seen.size()) {
      return tl::unexpected(no_share(share.file, "no share of a sweep", "run this share again"));
    }
    auto& before = seen[share.share.number - 1];
    if (!before.empty()) {
      return tl::unexpected(no_share(share.file,
                                     fmt::format("task {} is there already, in {}", share.share.number, before),
                                     "name every share once"));
    }
    before = share.file;
  }
  std::vector<std::size_t> missing;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (seen[i].empty()) missing.push_back(i + 1);
  }
  if (missing.empty()) return {};
  return tl::unexpected(Error{ErrorCode::invalid_option,
                              fmt::format("of {} shares there is no {}", seen.size(), fmt::join(missing, ", ")),
                              fmt::format("run --task {}/{}, and name its file, too", missing.front(), seen.size()),
                              {},
                              {}});
}

/// Numbers where all are; columns that hold words hold words in every row. A share without the column has gaps: of
/// words that is an empty one.
TableColumn column_of(std::string name, const std::vector<ShareTable>& shares, std::size_t column,
                      const std::vector<std::vector<std::size_t>>& places) {
  std::vector<std::string> words;
  std::vector<double> numbers;
  bool is_number = true;
  for (std::size_t k = 0; k < shares.size(); ++k) {
    const std::size_t place = places[k][column];
    for (std::size_t i = 1; i < shares[k].lines.size(); ++i) {
      const bool is_gap = place == JoinedNames::missing;
      words.push_back(is_gap ? "" : shares[k].lines[i][place]);
      if (!is_number) continue;
      const auto number =
          is_gap ? std::optional(std::numeric_limits<double>::quiet_NaN()) : whole_text_as<double>(words.back());
      is_number = number.has_value();
      if (number) numbers.push_back(*number);
    }
  }
  if (is_number) return {std::move(name), std::move(numbers)};
  return {std::move(name), std::move(words)};
}

}  // namespace

Expected<Share> parse_share(const std::string& text, std::size_t runs) {
  Share share;
  int used = 0;
  const bool read = std::sscanf(text.c_str(), "%zu/%zu%n", &share.number, &share.of, &used) == 2 &&
                    static_cast<std::size_t>(used) == text.size() && text.find('-') == std::string::npos;
  if (!read || share.number < 1 || share.number > share.of) {
    return tl::unexpected(Error{ErrorCode::invalid_option,
                                fmt::format("--task {}: expected I/N with 1 <= I <= N", text),
                                "e.g. --task 2/5, or --task $SLURM_ARRAY_TASK_ID/5",
                                {},
                                {}});
  }
  if (share.of > runs) {
    return tl::unexpected(Error{ErrorCode::invalid_option,
                                fmt::format("--task {}: the sweep has {} runs only", text, runs),
                                fmt::format("take at most {} tasks", runs),
                                {},
                                {}});
  }
  return share;
}

std::string sweep_mark(const ModelInput& model, const SweepRequest& request, const std::string& keep) {
  const auto all = fmt::format("{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}", model.file.sha256, fmt::join(model.settings, "\n"),
                               fmt::join(request.over, "\n"), request.paired, fmt::join(request.samples, "\n"),
                               request.runs.value_or(0), request.seed, keep);
  return io::sha256(all).substr(0, 16);
}

std::string share_heading(const Share& share, std::size_t runs, const std::string& mark, const SweepPage& page) {
  const std::string kind(page.grid ? grid_word : pairs_word);
  std::vector<TableColumn> said{{page.title, {}}, {page.command, {}}, {kind, {}}};
  for (const auto& [name, caption] : page.captions)
    said.insert(said.end(), {{name, {}}, {caption.unit, {}}, {caption.label, {}}});
  auto fields = to_csv(said);
  fields.pop_back();  // the end of the line
  return fmt::format("run [task {} of {}, sweep {}, runs {} to {}] {}", share.number, share.of, mark,
                     share.begin(runs) + 1, share.end(runs), fields);
}

SweepTally& SweepTally::operator+=(const SweepTally& other) {
  runs += other.runs;
  others += other.others;
  undecided += other.undecided;
  stopped += other.stopped;
  for (const auto& [status, count] : other.statuses) statuses[status] += count;
  if (first_stopped == 0 || (other.first_stopped > 0 && other.first_stopped < first_stopped))
    first_stopped = other.first_stopped;
  return *this;
}

Expected<SweepTally> tally_of_share(const std::string& file, const Share& share, const std::string& mark) {
  const auto read = read_share(file);
  if (!read) return tl::unexpected(read.error());
  if (read->mark != mark || read->share.number != share.number || read->share.of != share.of) {
    return tl::unexpected(no_share(file, fmt::format("not share {} of {} of this sweep", share.number, share.of), ""));
  }
  const auto& lines = read->lines;
  const auto column = [&](std::string_view name) {
    return static_cast<std::size_t>(std::find(lines[0].begin(), lines[0].end(), name) - lines[0].begin());
  };
  const std::size_t status = column("status"), unique = column("unique");
  SweepTally tally;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const auto& line = lines[i];
    if (i > 1 && line[0] == lines[i - 1][0]) continue;
    ++tally.runs;
    ++tally.statuses[line.at(status)];
    if (line.at(unique) == "0") ++tally.others;
    if (line.at(unique) == "-1") ++tally.undecided;
    const auto why = result::termination_named(line[status]);
    if (why && result::is_done(*why)) continue;
    ++tally.stopped;
    if (tally.first_stopped == 0) tally.first_stopped = whole_text_as<std::size_t>(line[0]).value_or(0);
  }
  return tally;
}

Expected<JoinedShares> join_shares(const std::vector<std::string>& files) {
  std::vector<ShareTable> shares;
  for (const auto& file : files) {
    auto share = read_share(file);
    if (!share) return tl::unexpected(share.error());
    shares.push_back(std::move(*share));
  }
  if (auto together = check_together(shares); !together) return tl::unexpected(together.error());
  std::sort(shares.begin(), shares.end(), [](const auto& a, const auto& b) { return a.share.number < b.share.number; });
  JoinedHeadings headings;
  for (const auto& share : shares) headings.add(share.lines[0]);
  std::vector<std::vector<std::size_t>> places;
  for (const auto& share : shares) places.push_back(headings.places_in(share.lines[0]));
  JoinedShares whole{{}, shares.front().page};
  const auto names = headings.all();
  for (std::size_t k = 0; k < names.size(); ++k) whole.table.push_back(column_of(names[k], shares, k, places));
  whole.page.names = changed_names(whole.table);
  return whole;
}

}  // namespace saltus::frontend
