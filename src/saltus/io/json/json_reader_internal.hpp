// Reads checked values out of a JSON document; the first mismatch is kept, with its path ("/events/3/kind").
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "saltus/base/error.hpp"
#include "saltus/io/json/json_document_internal.hpp"
#include "saltus/result/result.hpp"

namespace saltus::io {

class JsonReader {
 public:
  explicit JsonReader(std::string file) : file_(std::move(file)) {}

  [[nodiscard]] const std::optional<Error>& error() const { return error_; }

  void fail(const std::string& path, std::string message) {
    if (error_) return;
    error_ = Error{ErrorCode::parse_failure,
                   fmt::format("at {}: {}", path.empty() ? "/" : path, message),
                   "is this the whole, unedited result file?",
                   {file_, 0, 0},
                   {}};
  }

  /// Returns the member of an object, or null and an error.
  const Json* member(const Json& object, const std::string& path, const char* key) {
    if (!object.is_object()) {
      mismatch(path, "an object", object);
      return nullptr;
    }
    const auto found = object.find(key);
    if (found != object.end()) return &*found;
    fail(path, fmt::format("'{}' is missing", key));
    return nullptr;
  }

  /// Reads object[key] into `target`, of any type that read() knows.
  template <class Target>
  void read_member(const Json& object, const std::string& path, const char* key, Target& target) {
    if (const auto* json = member(object, path, key)) read(*json, path + "/" + key, target);
  }

  /// Reads a word of a fixed set; words.named gives its value, or nullopt where it is no words.what.
  template <class Words, class Target>
  void read_word(const Json& json, const std::string& path, const Words& words, Target& target) {
    std::string word;
    read(json, path, word);
    if (const auto value = words.named(word)) {
      target = *value;
    } else {
      fail(path, fmt::format("'{}' is no {}", word, words.what));
    }
  }

  /// Reads a member that only models of some kinds have.
  template <class Target>
  void read_if_there(const Json& object, const std::string& path, const char* key, Target& target) {
    if (object.is_object() && object.contains(key)) read(object[key], path + "/" + key, target);
  }

  void read(const Json& json, const std::string& path, double& target) {
    if (json.is_number()) {
      target = json.get<double>();
    } else if (json.is_null()) {
      target = std::numeric_limits<double>::quiet_NaN();
    } else {
      mismatch(path, "a number or null", json);
    }
  }
  void read(const Json& json, const std::string& path, std::int64_t& target) {
    json.is_number_integer() ? void(target = json.get<std::int64_t>()) : mismatch(path, "a whole number", json);
  }
  void read(const Json& json, const std::string& path, int& target) {
    // The only integers of a result besides counts are the components of a mode.
    const bool sign = json.is_number_integer() && std::abs(json.get<std::int64_t>()) <= 1;
    sign ? void(target = json.get<int>()) : mismatch(path, "-1, 0 or 1", json);
  }
  void read(const Json& json, const std::string& path, bool& target) {
    json.is_boolean() ? void(target = json.get<bool>()) : mismatch(path, "true or false", json);
  }
  void read(const Json& json, const std::string& path, std::string& target) {
    json.is_string() ? void(target = json.get<std::string>()) : mismatch(path, "a text", json);
  }
  void read(const Json& json, const std::string& path, result::ContactMode& target) {
    const auto mode = json.is_string() ? result::contact_mode_named(json.get<std::string>()) : std::nullopt;
    mode ? void(target = *mode) : mismatch(path, "a mode of a contact", json);
  }
  /// Calls visit(entry, its number) for the entries of a list, up to the first error.
  template <class Visit>
  void for_each_entry(const Json& json, const std::string& path, Visit visit) {
    if (!is_list(json)) return mismatch(path, "a list", json);
    std::size_t number = 0;
    for_each_piece(json, [&](const Json& piece) {
      for (auto entry = piece.begin(); entry != piece.end() && !error_; ++entry) visit(*entry, number++);
      return !error_;
    });
  }
  template <class Element>
  void read(const Json& json, const std::string& path, std::vector<Element>& target) {
    target.clear();
    if (json.is_array()) target.reserve(json.size());
    // Paths only where they are needed: a trajectory has millions of numbers.
    for_each_entry(json, path, [&](const Json& entry, std::size_t) { read(entry, path, target.emplace_back()); });
  }
  template <class Number>
  void read(const Json& json, const std::string& path, result::Table<Number>& target) {
    read_rows<result::RowVector<Number>>(json, path, target);
  }
  template <class Number>
  void read(const Json& json, const std::string& path, result::SteadyTable<Number>& target) {
    read_rows<result::RowVector<Number>>(json, path, target);
  }
  template <class Value>
  void read(const Json& json, const std::string& path, result::SteadyList<Value>& target) {
    for_each_entry(json, path, [&](const Json& entry, std::size_t) {
      Value value{};
      read(entry, path, value);
      target.push_back(std::move(value));
    });
  }
  template <class Element, std::size_t size>
  void read(const Json& json, const std::string& path, std::array<Element, size>& target) {
    std::vector<Element> values;
    read(json, path, values);
    if (error_) return;
    if (values.size() != size) {
      fail(path, fmt::format("expected {} entries, found {}", size, values.size()));
      return;
    }
    std::move(values.begin(), values.end(), target.begin());
  }
  template <class Value>
  void read(const Json& json, const std::string& path, std::optional<Value>& target) {
    target.reset();
    if (json.is_null()) return;
    Value value{};
    read(json, path, value);
    target = std::move(value);
  }

  void mismatch(const std::string& path, std::string_view expected, const Json& found) {
    constexpr std::size_t shown = 40;
    const auto text = is_list(found) ? "array" : found.is_object() ? "object" : found.dump();
    fail(path, fmt::format("expected {}, found {}", expected, text.substr(0, shown)));
  }

 private:
  /// Rows of one length; which one it must be is asked later.
  template <class Row, class Table>
  void read_rows(const Json& json, const std::string& path, Table& target) {
    target = {};
    Row row;
    for_each_entry(json, path, [&](const Json& entry, std::size_t number) {
      read(entry, path, row);
      if (number > 0 && row.size() != target.width()) {
        fail(fmt::format("{}/{}", path, number),
             fmt::format("expected {} entries, found {}", target.width(), row.size()));
      }
      if (!error_) target.push_back(row);
    });
  }

  std::string file_;
  std::optional<Error> error_;
};

}  // namespace saltus::io
