// The members of plain records by their names in a result file, once for their writer and their reader.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "saltus/io/json/json_reader_internal.hpp"

namespace saltus::io {

/// Says when a member is written, and whether a file may be without it.
enum class Presence {
  always,
  later,        ///< written always; files of earlier versions have none
  if_any,       ///< left out where it is empty
  not_negative  ///< null where it is below 0
};

template <class Record, class Value>
struct RecordMember {
  const char* name;
  Value Record::*place;
  Presence presence;
};

template <class Record, class Value>
[[nodiscard]] constexpr RecordMember<Record, Value> field(const char* name, Value Record::*place,
                                                          Presence presence = Presence::always) {
  return {name, place, presence};
}

/// Has the members of a record, in the order of the file, as `list`: a tuple of RecordMember.
template <class Record>
struct RecordMembers;

template <class Value>
concept Listed = requires {
  RecordMembers<Value>::list;
};

template <class Value>
inline constexpr bool is_optional = false;
template <class Value>
inline constexpr bool is_optional<std::optional<Value>> = true;

template <class List>
concept ListOfRecords = Listed<typename List::value_type>;
template <class List>
concept ListOfWords = std::is_enum_v<typename List::value_type>;

/// Reads the words of an enum, a value of which messages call `what`.
template <class Enum>
struct EnumWords {
  std::optional<Enum> (*named)(std::string_view word);
  std::string_view what;
};
template <class Enum>
inline constexpr EnumWords<Enum> enum_words{};

using Numbers = std::vector<std::pair<std::string, double>>;

/// Makes an object of numbers by name.
[[nodiscard]] Json numbers_json(const Numbers& numbers);
void read_numbers(JsonReader& reader, const Json& json, const std::string& path, Numbers& numbers);

template <class Record>
[[nodiscard]] Json record_json(const Record& record);
template <class Record>
void read_record(JsonReader& reader, const Json& json, const std::string& path, Record& record);

/// Writes what a member may be: a record, a list of records, a word, a value or null, or what JSON has itself.
template <class Value>
[[nodiscard]] Json value_json(const Value& value) {
  if constexpr (Listed<Value>) {
    return record_json(value);
  } else if constexpr (std::is_enum_v<Value>) {
    return Json(name(value));
  } else if constexpr (is_optional<Value>) {
    return value ? value_json(*value) : Json();
  } else if constexpr (ListOfRecords<Value> || ListOfWords<Value>) {
    Json list = Json::array();
    for (const auto& entry : value) list.push_back(value_json(entry));
    return list;
  } else if constexpr (std::is_same_v<Value, Numbers>) {
    return numbers_json(value);
  } else {
    return Json(value);
  }
}

template <class Value>
[[nodiscard]] bool is_empty(const Value& value) {
  if constexpr (is_optional<Value>) {
    return !value.has_value();
  } else if constexpr (requires { value.empty(); }) {
    return value.empty();
  } else {
    return false;
  }
}

template <class Record, class Value>
void write_member(Json& json, const Record& record, const RecordMember<Record, Value>& member) {
  const Value& value = record.*member.place;
  if (member.presence == Presence::if_any && is_empty(value)) return;
  if constexpr (std::is_same_v<Value, int>) {
    json[member.name] = member.presence == Presence::not_negative && value < 0 ? Json() : Json(value);
  } else {
    json[member.name] = value_json(value);
  }
}

/// Writes these members, which need not be all of the record.
template <class Record, class List>
[[nodiscard]] Json members_json(const Record& record, const List& list) {
  Json json = Json::object();
  std::apply([&](const auto&... members) { (write_member(json, record, members), ...); }, list);
  return json;
}

template <class Record>
Json record_json(const Record& record) {
  return members_json(record, RecordMembers<Record>::list);
}

/// Reads a count or an index: a whole number from 0.
template <class Count>
void read_count(JsonReader& reader, const Json& json, const std::string& path, Count& count) {
  constexpr auto largest = std::numeric_limits<Count>::max();
  std::int64_t number = 0;
  reader.read(json, path, number);
  if (number < 0) {
    reader.fail(path, fmt::format("expected a number from 0, found {}", number));
  } else if (std::cmp_greater(number, largest)) {
    reader.fail(path, fmt::format("expected a number up to {}, found {}", largest, number));
  } else {
    count = static_cast<Count>(number);
  }
}

/// Reads every entry of a list by read_one(reader, json, path).
template <class Part, class Read>
void read_list(JsonReader& reader, const Json& json, const std::string& path, std::vector<Part>& parts, Read read_one) {
  reader.for_each_entry(json, path, [&](const Json& entry, std::size_t i) {
    parts.push_back(read_one(reader, entry, fmt::format("{}/{}", path, i)));
  });
}

/// Reads what value_json() writes.
template <class Value>
void read_value(JsonReader& reader, const Json& json, const std::string& path, Value& value) {
  if constexpr (Listed<Value>) {
    read_record(reader, json, path, value);
  } else if constexpr (std::is_enum_v<Value>) {
    static_assert(!enum_words<Value>.what.empty());
    reader.read_word(json, path, enum_words<Value>, value);
  } else if constexpr (std::is_same_v<Value, int> || std::is_same_v<Value, std::size_t>) {
    read_count(reader, json, path, value);
  } else if constexpr (is_optional<Value>) {
    value.reset();
    if (!json.is_null()) read_value(reader, json, path, value.emplace());
  } else if constexpr (ListOfRecords<Value>) {
    value.clear();
    read_list(reader, json, path, value, [](JsonReader& inner, const Json& entry, const std::string& here) {
      typename Value::value_type one{};
      read_value(inner, entry, here, one);
      return one;
    });
  } else if constexpr (std::is_same_v<Value, Numbers>) {
    read_numbers(reader, json, path, value);
  } else {
    reader.read(json, path, value);
  }
}

/// Reads the member `key`.
template <class Value>
void read_part(JsonReader& reader, const Json& json, const std::string& path, const char* key, Value& value) {
  if (const auto* found = reader.member(json, path, key)) read_value(reader, *found, path + "/" + key, value);
}

/// Reads the member `key` if there is one.
template <class Value>
void read_part_if_there(JsonReader& reader, const Json& json, const std::string& path, const char* key, Value& value) {
  if (json.is_object() && json.contains(key)) read_value(reader, json[key], path + "/" + key, value);
}

template <class Record, class Value>
void read_one_member(JsonReader& reader, const Json& json, const std::string& path,
                     const RecordMember<Record, Value>& member, Record& record) {
  auto& value = record.*member.place;
  switch (member.presence) {
    case Presence::always:
      return read_part(reader, json, path, member.name, value);
    case Presence::later:
    case Presence::if_any:
      return read_part_if_there(reader, json, path, member.name, value);
    case Presence::not_negative:
      break;
  }
  const auto* found = reader.member(json, path, member.name);
  if (found != nullptr && !found->is_null()) read_value(reader, *found, path + "/" + member.name, value);
}

/// Reads these members, which need not be all of the record.
template <class Record, class List>
void read_members(JsonReader& reader, const Json& json, const std::string& path, const List& list, Record& record) {
  std::apply([&](const auto&... members) { (read_one_member(reader, json, path, members, record), ...); }, list);
}

template <class Record>
void read_record(JsonReader& reader, const Json& json, const std::string& path, Record& record) {
  read_members(reader, json, path, RecordMembers<Record>::list, record);
}

}  // namespace saltus::io
