// The text of tables (RFC 4180) that become one: shares of a sweep, of which some may lack columns of others.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "saltus/frontend/joined_names.hpp"

namespace saltus::frontend {

using TextLines = std::vector<std::vector<std::string>>;

/// Returns the fields of all lines, as to_csv writes them.
[[nodiscard]] TextLines fields_of(std::string_view text);

/// Holds the headings of the table that several shares become. What was changed from run to run stands before the
/// status, and is known by its place: a share in which no run began does not know which of it are states.
class JoinedHeadings {
 public:
  /// @param headings  of a share, in any order of shares; the first one, which says whose it is, becomes "run"
  void add(const std::vector<std::string>& headings);
  [[nodiscard]] std::vector<std::string> all() const;
  /// Returns of each heading of the whole table where a share has it, or JoinedNames::missing.
  [[nodiscard]] std::vector<std::size_t> places_in(const std::vector<std::string>& headings) const;

 private:
  std::vector<std::string> changed_;  ///< before the status
  std::size_t most_ = 0;              ///< columns of the share that they are of
  JoinedNames others_;
};

/// Returns the headings of a table.
[[nodiscard]] std::vector<std::string> headings_of(std::string_view text);
/// Returns the rows of a table in the columns of the whole one, with "nan" where it lacks one.
[[nodiscard]] std::string rows_of(std::string_view text, const JoinedHeadings& whole);

}  // namespace saltus::frontend
