// Numbers of a page, taken out of its JSON, deflated, and written as text.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "saltus/report/html.hpp"
#include "saltus/report/json_internal.hpp"

namespace saltus::report {

/// Arrays of numbers shorter than this stay in the JSON: people can read them, and nothing is gained.
inline constexpr std::size_t least_packed = 24;

/// Holds JSON and the numbers that were in it. numbers.js puts them together again.
///
/// An array of numbers becomes {"$n": [first, count]}, null as NaN. A long array of objects that have the same keys
/// becomes {"$rows": count, "columns": {key: values}}; of a column the values are an array of numbers, or
/// {"$table": width, "of": numbers} where all are arrays of one length, or {"$codes": numbers, "of": list} where few of
/// them differ. Columns that are kept by points ({"$points": [places, values], "size": count}) stay objects.
struct Packed {
  nlohmann::json skeleton;
  std::vector<double> numbers;
};
/// @param go_on  false ends it, with a part of the data
[[nodiscard]] Packed pack(nlohmann::json data, const GoOn& go_on = {});

/// Returns the bytes of the numbers (little endian), all first bytes before all second ones and so on, which deflates
/// better.
[[nodiscard]] std::string shuffled_bytes(const std::vector<double>& numbers);

/// Does raw deflate (RFC 1951), then base64 (RFC 4648). Cost: about 30 ns per byte.
/// @param go_on  false ends it, with a part of the bytes
[[nodiscard]] std::string deflated_base64(std::string_view bytes, const GoOn& go_on = {});

}  // namespace saltus::report
