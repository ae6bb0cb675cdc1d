#include <string>
#include <utility>

#include "saltus/io/check/option_schema_internal.hpp"

namespace saltus::io {
namespace {

using pipeline::ListOf;

Json number_schema(const pipeline::Numbers& numbers) {
  Json json = {{"type", "number"}};
  if (numbers.whole) json["multipleOf"] = 1;
  if (numbers.above) json["exclusiveMinimum"] = *numbers.above;
  if (numbers.from) json["minimum"] = *numbers.from;
  if (numbers.below) json["exclusiveMaximum"] = *numbers.below;
  if (numbers.up_to) json["maximum"] = *numbers.up_to;
  return json;
}

Json list_schema(Json item) { return {{"type", "array"}, {"items", std::move(item)}}; }

}  // namespace

Json option_schema(const pipeline::OptionKind& kind) {
  Json parts = Json::array();
  if (kind.truth) parts.push_back({{"type", "boolean"}});
  Json single = Json::array();
  for (const auto word : kind.words) single.push_back(word);
  for (const int value : kind.values) single.push_back(value);
  if (!single.empty()) parts.push_back({{"enum", std::move(single)}});
  if (kind.number) parts.push_back(number_schema(*kind.number));
  switch (kind.list) {
    case ListOf::nothing:
      break;
    case ListOf::the_same:
      parts.push_back(list_schema(number_schema(kind.number.value_or(pipeline::Numbers{}))));
      break;
    case ListOf::increasing_numbers:
      parts.push_back(list_schema(number_schema({})));
      break;
    case ListOf::names:
      parts.push_back({{"type", "string"}});
      parts.push_back(list_schema({{"type", "string"}}));
      break;
  }
  if (parts.size() == 1) return parts.front();
  return {{"anyOf", std::move(parts)}};
}

}  // namespace saltus::io
