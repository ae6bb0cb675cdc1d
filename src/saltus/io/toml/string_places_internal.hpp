// Where the characters of a TOML string with escapes stand in the file.
#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/expression/syntax_tree.hpp"

namespace saltus::io {

/// Says that from byte `offset` of the string's value on, up to the next anchor, the value stands as it is from `place`
/// on.
struct StringAnchor {
  std::size_t offset = 0;
  SourceLocation place;
};

/// Returns the anchors of a basic string ("text" or """text""").
/// @param raw    the text of the file from behind the opening quotes (and the line break that TOML drops) on
/// @param start  its place
/// @return one anchor at the beginning and one behind every escape; nothing if there is no escape.
[[nodiscard]] std::vector<StringAnchor> anchors_of(std::string_view raw, const SourceLocation& start, bool multi_line);

/// Maps line and column that expression::parse gives the bytes of `value` when it starts at line 1, column 1 -> the
/// file.
class StringPlaces {
 public:
  StringPlaces(std::string_view value, const std::vector<StringAnchor>& anchors) : value_(value), anchors_(anchors) {}

  [[nodiscard]] SourceLocation in_file(const SourceLocation& location) const;
  /// Returns the same tree with its places in the file.
  [[nodiscard]] expression::NodePtr in_file(const expression::NodePtr& tree) const;

 private:
  std::string_view value_;
  const std::vector<StringAnchor>& anchors_;
};

}  // namespace saltus::io
