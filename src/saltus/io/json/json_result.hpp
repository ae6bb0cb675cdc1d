// Result <-> JSON (format saltus-result/1), and trajectory and events as CSV and as arrays of NumPy.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "saltus/base/error.hpp"
#include "saltus/io/atomic_file.hpp"
#include "saltus/result/result.hpp"

namespace saltus::io {

/// Writes numbers as shortest round trip, non-finite ones as null. Memory: some pieces of text, and the parts that do
/// not grow with the run. False if the sink took not all.
[[nodiscard]] bool write_json(const result::Result& result, Sink sink);
[[nodiscard]] std::string to_json(const result::Result& result);
/// Reads a stored result; errors name the file, the position or the JSON path, and what was expected.
[[nodiscard]] Expected<result::Result> read_result(const std::filesystem::path& file);
[[nodiscard]] Expected<result::Result> parse_result(const std::string& text, const std::string& file);
/// Returns a field of CSV by RFC 4180: one with a comma, a quote or a line break in quotes, its quotes doubled.
[[nodiscard]] std::string csv_field(const std::string& text);
/// Writes the header t,side,<states>,<controls>,<outputs>, then alpha(<name>) of all surfaces, then mode(<name>) of
/// all. Fields are quoted by RFC 4180. `side` is result::side.
[[nodiscard]] bool write_csv(const result::Result& result, Sink sink);
[[nodiscard]] std::string to_csv(const result::Result& result);
/// Writes a line per event: t,kind,name,surfaces,<states>, then after(<state>) of all states, then mode_before(<name>),
/// mode_after(<name>), alpha_before(<name>), alpha_after(<name>) of all surfaces each, then unique,reason. Surfaces are
/// separated by semicolons. What an event does not have is empty, and so is `unique` where it is not decided.
[[nodiscard]] bool write_events_csv(const result::Result& result, Sink sink);
/// Writes a file of a result that gets its rows and events part by part, while they are computed; it becomes what the
/// writers above write, without branches.
class ResultParts {
 public:
  ResultParts() = default;
  ResultParts(const ResultParts&) = delete;
  ResultParts& operator=(const ResultParts&) = delete;
  virtual ~ResultParts() = default;
  /// Adds a part: rows and events behind those before it.
  /// @return why not everything was taken; where the sink refused, it knows better
  [[nodiscard]] virtual Expected<void> add(const result::Result& part) = 0;
  /// Returns how many bytes it has put aside, which finish() will write.
  [[nodiscard]] virtual std::size_t bytes_aside() const { return 0; }
  /// Writes all that is not in parts; returns as add.
  [[nodiscard]] virtual Expected<void> finish(const result::Result& rest) = 0;
};
/// Lets lines reach the sink, which must outlive what is returned, part by part.
[[nodiscard]] std::unique_ptr<ResultParts> csv_parts(Sink sink);
[[nodiscard]] std::unique_ptr<ResultParts> events_csv_parts(Sink sink);
/// Puts what they get aside in files without names; it reaches the sink with finish().
/// @param folder  for those files
[[nodiscard]] std::unique_ptr<ResultParts> json_parts(const std::filesystem::path& folder, Sink sink);
[[nodiscard]] std::unique_ptr<ResultParts> npz_parts(const std::filesystem::path& folder, Sink sink);
/// Writes the columns of both tables as a zip archive of .npy arrays, deflated: those of the trajectory by their names,
/// those of the events with "events." before them. Numbers are float64, `side` and modes of rows int8, words unicode;
/// what is not there is NaN, `unique` is 1, 0 or -1 (not decided).
[[nodiscard]] bool write_npz(const result::Result& result, Sink sink);
/// Writes what the end of a name says: .events.csv, .csv, .npz, else JSON.
[[nodiscard]] bool write_as(std::string_view name, const result::Result& result, Sink sink);

}  // namespace saltus::io
