// Many objects with the same members, member by member: a hundredth of the memory of the objects.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "saltus/report/json_internal.hpp"

namespace saltus::report {

/// Returns a number; NaN for null.
[[nodiscard]] double number_of(const nlohmann::json& value);
/// Tells whether all are numbers or null.
[[nodiscard]] bool all_numbers(const nlohmann::json& list);

/// Holds the values of one member, in the shortest form that fits all of them: numbers; few that differ; arrays of
/// numbers of one length; or as they are.
class PackedColumn {
 public:
  void add(nlohmann::json value);
  [[nodiscard]] nlohmann::json take();

 private:
  [[nodiscard]] bool is_short() const { return is_numbers_ || is_coded_ || is_table_; }
  [[nodiscard]] nlohmann::json::array_t unfolded() const;

  std::size_t size_ = 0, width_ = 0;
  bool is_numbers_ = true, is_coded_ = true, is_table_ = true;
  std::vector<double> numbers_, which_, flat_;
  std::map<std::string, std::size_t> codes_;
  nlohmann::json::array_t of_, values_;
};

/// Takes objects one by one and makes of them what pack() makes of a list of them, with the numbers still in it.
class PackedRows {
 public:
  /// @param row  an object with the keys of the first
  void add(nlohmann::json row);
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] nlohmann::json take();

 private:
  std::size_t size_ = 0;
  std::map<std::string, PackedColumn> columns_;
};

}  // namespace saltus::report
