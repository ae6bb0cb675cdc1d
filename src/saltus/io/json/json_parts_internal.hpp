// Parts that occur in several places of a result file.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "saltus/io/json/json_reader_internal.hpp"
#include "saltus/result/comparison.hpp"
#include "saltus/result/elements.hpp"
#include "saltus/result/sensitivities.hpp"

namespace saltus::io {

template <class Value>
[[nodiscard]] Json or_null(const std::optional<Value>& value) {
  return value ? Json(*value) : Json(nullptr);
}

/// Makes an object of numbers by name.
[[nodiscard]] Json numbers_json(const std::vector<std::pair<std::string, double>>& numbers);
[[nodiscard]] Json status_json(const result::Status& status);
[[nodiscard]] Json statistics_json(const result::Statistics& statistics);
[[nodiscard]] Json sensitivities_json(const result::Sensitivities& sensitivities);
[[nodiscard]] Json elements_json(const result::Elements& elements);
[[nodiscard]] Json comparison_json(const result::Comparison& comparison);
[[nodiscard]] Json order_json(const result::OrderStudy& order);

/// Reads a count or an index: a whole number from 0.
[[nodiscard]] std::size_t read_number(JsonReader& reader, const Json& json, const std::string& path, const char* key);
void read_numbers(JsonReader& reader, const Json& json, const std::string& path,
                  std::vector<std::pair<std::string, double>>& numbers);
void read_status(JsonReader& reader, const Json& json, const std::string& path, result::Status& status);
void read_statistics(JsonReader& reader, const Json& json, const std::string& path, result::Statistics& statistics);
void read_sensitivities(JsonReader& reader, const Json& json, const std::string& path,
                        std::optional<result::Sensitivities>& sensitivities);
void read_elements(JsonReader& reader, const Json& json, const std::string& path,
                   std::optional<result::Elements>& elements);
void read_comparison(JsonReader& reader, const Json& json, const std::string& path,
                     std::optional<result::Comparison>& comparison);
void read_order(JsonReader& reader, const Json& json, const std::string& path,
                std::optional<result::OrderStudy>& order);

/// Reads every entry of a list by read_one(reader, json, path).
template <class Part, class Read>
void read_list(JsonReader& reader, const Json& json, const std::string& path, std::vector<Part>& parts, Read read_one) {
  if (!json.is_array()) {
    reader.mismatch(path, "a list", json);
    return;
  }
  for (std::size_t i = 0; i < json.size(); ++i) {
    parts.push_back(read_one(reader, json[i], fmt::format("{}/{}", path, i)));
  }
}

/// Applies a reader of a part to the member `key`.
template <class Read, class Part>
void read_part(JsonReader& reader, const Json& json, const std::string& path, const char* key, Read read, Part& part) {
  if (const auto* member = reader.member(json, path, key)) read(reader, *member, path + "/" + key, part);
}

}  // namespace saltus::io
