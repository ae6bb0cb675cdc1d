#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <new>
#include <utility>
#include <zlib.h>

#include "saltus/report/packed_rows_internal.hpp"
#include "saltus/report/packing_internal.hpp"

namespace saltus::report {
namespace {

using nlohmann::json;

json put_away(const json& list, std::vector<double>& numbers) {
  const std::size_t first = numbers.size();
  for (const json& value : list) numbers.push_back(number_of(value));
  return {{"$n", {first, list.size()}}};
}

/// Objects with the keys of the first, which is one.
bool are_alike(const json& list) {
  const auto& first = list.front().get_ref<const json::object_t&>();
  return std::all_of(list.begin(), list.end(), [&](const json& entry) {
    const auto* object = entry.get_ptr<const json::object_t*>();
    return object != nullptr && object->size() == first.size() &&
           std::equal(object->begin(), object->end(), first.begin(),
                      [](const auto& a, const auto& b) { return a.first == b.first; });
  });
}

json rows_taken_out(json rows, std::vector<double>& numbers) {
  for (json& column : rows["columns"]) {
    if (column.is_array() && all_numbers(column)) {
      column = put_away(column, numbers);
    } else if (column.is_object()) {
      json& list = column[column.contains("$codes") ? "$codes" : "of"];
      list = put_away(list, numbers);
    }
  }
  return rows;
}

json by_columns(json list, std::vector<double>& numbers, const GoOn& go_on) {
  PackedRows rows;
  for (json& entry : list) {
    if (rows.size() % 1024 == 0 && go_on && !go_on()) break;
    rows.add(std::move(entry));
  }
  return rows_taken_out(rows.take(), numbers);
}

json taken_out(json value, std::vector<double>& numbers, const GoOn& go_on) {
  if (value.is_object() && value.contains("$rows")) return rows_taken_out(std::move(value), numbers);
  if (value.is_array() && value.size() >= least_packed) {
    if (all_numbers(value)) return put_away(value, numbers);
    const bool of_points = value.front().is_object() && value.front().contains("$points");
    if (value.front().is_object() && !of_points && are_alike(value)) {
      return by_columns(std::move(value), numbers, go_on);
    }
  }
  if (value.is_structured()) {
    for (json& part : value) part = taken_out(std::move(part), numbers, go_on);
  }
  return value;
}

std::string deflated(std::string_view bytes, const GoOn& go_on) {
  z_stream stream{};
  // Negative: raw deflate, without the header and the checksum of zlib.
  if (deflateInit2(&stream, 6, Z_DEFLATED, -15, 9, Z_DEFAULT_STRATEGY) != Z_OK) throw std::bad_alloc();
  std::string packed;
  std::vector<char> buffer(std::size_t{1} << 20U);
  std::size_t read = 0;
  int state = Z_OK;
  while (state != Z_STREAM_END && (!go_on || go_on())) {
    if (stream.avail_in == 0) {
      const std::size_t part = std::min<std::size_t>(bytes.size() - read, std::size_t{1} << 30U);
      // zlib does not write into its input; its type is from times without const.
      stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data() + read));
      stream.avail_in = static_cast<uInt>(part);
      read += part;
    }
    stream.next_out = reinterpret_cast<Bytef*>(buffer.data());
    stream.avail_out = static_cast<uInt>(buffer.size());
    state = deflate(&stream, read == bytes.size() ? Z_FINISH : Z_NO_FLUSH);
    packed.append(buffer.data(), buffer.size() - stream.avail_out);
  }
  deflateEnd(&stream);
  return packed;
}

std::string base64(std::string_view bytes) {
  constexpr std::string_view letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      group = (group << 8U) | (k < count ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) text += k <= count ? letters[(group >> (18 - 6 * k)) & 63U] : '=';
  }
  return text;
}

}  // namespace

Packed pack(json data, const GoOn& go_on) {
  Packed packed;
  packed.skeleton = taken_out(std::move(data), packed.numbers, go_on);
  return packed;
}

std::string shuffled_bytes(const std::vector<double>& numbers) {
  std::string bytes(8 * numbers.size(), '\0');
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    auto bits = std::bit_cast<std::uint64_t>(numbers[i]);
    for (std::size_t k = 0; k < 8; ++k, bits >>= 8U) bytes[k * numbers.size() + i] = static_cast<char>(bits & 255U);
  }
  return bytes;
}

std::string deflated_base64(std::string_view bytes, const GoOn& go_on) { return base64(deflated(bytes, go_on)); }

}  // namespace saltus::report
