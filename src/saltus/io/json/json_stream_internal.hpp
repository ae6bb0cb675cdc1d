// JSON that is written while it is made: what grows with a run never is a document.
#pragma once

#include <cmath>
#include <cstddef>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include <fmt/format.h>

#include "saltus/io/json/json_layout_internal.hpp"
#include "saltus/io/text_stream_internal.hpp"

namespace saltus::io {

inline void append_json(std::string& text, int number) { fmt::format_to(std::back_inserter(text), "{}", number); }

/// Appends the shortest text that reads as the same double, with a point or an exponent; null if it is not finite.
inline void append_json(std::string& text, double number) {
  if (!std::isfinite(number)) {
    text += "null";
    return;
  }
  const std::size_t begin = text.size();
  fmt::format_to(std::back_inserter(text), "{}", number);
  if (text.find_first_of(".e", begin) == std::string::npos) text += ".0";
}

inline void append_json(std::string& text, const std::string& words) { text += compact(Json(words)); }

template <class List>
requires(!std::is_convertible_v<const List&, std::string_view>) && requires(const List& list) { list.size(), list[0]; }
void append_json(std::string& text, const List& list) {
  text += '[';
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (i > 0) text += ',';
    append_json(text, list[i]);
  }
  text += ']';
}

template <class Value>
void append_json(std::string& text, const std::optional<Value>& value) {
  if (value) return append_json(text, *value);
  text += "null";
}

/// Writes the members of an object, each on a line of its own, as laid_out has them.
class ObjectStream {
 public:
  /// @param indent  of the object's braces
  ObjectStream(TextStream& stream, std::size_t indent) : stream_(stream), margin_(indent + 2, ' ') {
    stream_.text() += '{';
  }
  /// Begins a member; its value is appended next.
  std::string& key(const char* name) {
    static_cast<void>(stream_.pass());
    auto& text = stream_.text();
    text += first_ ? "\n" : ",\n";
    first_ = false;
    text.append(margin_).append("\"").append(name).append("\": ");
    return text;
  }
  void member(const char* name, const Json& json) { append_laid_out(json, margin_.size(), key(name)); }
  /// Writes a list, each element on a line of its own, by append_one(element, indent).
  template <class List, class Append>
  void list(const char* name, const List& elements, Append append_one) {
    key(name) += '[';
    const std::string inner(margin_.size() + 2, ' ');
    for (std::size_t i = 0; i < elements.size() && stream_.pass(); ++i) {
      stream_.text().append(i > 0 ? ",\n" : "\n").append(inner);
      append_one(elements[i], inner.size());
    }
    end_list(elements.empty());
  }
  void end_list(bool empty) {
    if (!empty) stream_.text().append("\n").append(margin_);
    stream_.text() += ']';
  }
  /// Writes numbers on one line.
  void line(const char* name, const std::vector<double>& numbers) {
    key(name) += '[';
    for (std::size_t i = 0; i < numbers.size() && stream_.pass(); ++i) {
      if (i > 0) stream_.text() += ',';
      append_json(stream_.text(), numbers[i]);
    }
    stream_.text() += ']';
  }
  void end() { stream_.text().append("\n").append(margin_, 0, margin_.size() - 2).append("}"); }

 private:
  TextStream& stream_;
  std::string margin_;
  bool first_ = true;
};

}  // namespace saltus::io
