// NumPy's formats: arrays (.npy) in a zip archive without compression (.npz).
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>

#include <fmt/format.h>

#include "saltus/cli/sweep_table.hpp"

namespace saltus::cli {
namespace {

static_assert(std::endian::native == std::endian::little, "bytes are written as they are in memory");

void put(std::string& bytes, std::uint64_t value, int count) {
  for (int k = 0; k < count; ++k) bytes += static_cast<char>((value >> (8 * k)) & 0xFFU);
}

std::uint32_t crc_of(const std::string& bytes) {
  static const auto table = [] {
    std::array<std::uint32_t, 256> entries{};
    for (std::uint32_t i = 0; i < 256; ++i) {
      std::uint32_t value = i;
      for (int k = 0; k < 8; ++k) value = (value & 1U) != 0 ? 0xEDB88320U ^ (value >> 1U) : value >> 1U;
      entries[i] = value;
    }
    return entries;
  }();
  std::uint32_t crc = 0xFFFFFFFFU;
  for (const char byte : bytes) crc = table[(crc ^ static_cast<std::uint8_t>(byte)) & 0xFFU] ^ (crc >> 8U);
  return ~crc;
}

std::string array_header(const std::string& type, std::size_t count) {
  std::string text = fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': ({},), }}", type, count);
  while ((10 + text.size() + 1) % 64 != 0) text += ' ';
  text += '\n';
  std::string bytes("\x93NUMPY\x01\x00", 8);
  put(bytes, text.size(), 2);
  return bytes + text;
}

std::string array_of(const std::vector<double>& values) {
  std::string bytes = array_header("<f8", values.size());
  const auto begin = bytes.size();
  bytes.resize(begin + 8 * values.size());
  if (!values.empty()) std::memcpy(bytes.data() + begin, values.data(), 8 * values.size());
  return bytes;
}

/// Code points of UTF-8; what is none stands for itself.
std::u32string code_points(const std::string& text) {
  std::u32string points;
  for (std::size_t i = 0; i < text.size();) {
    const auto lead = static_cast<std::uint8_t>(text[i]);
    const std::size_t length = lead < 0x80 ? 1 : lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : lead >= 0xC0 ? 2 : 1;
    char32_t point = length == 1 ? lead : lead & (0xFFU >> (length + 1));
    for (std::size_t k = 1; k < length && i + k < text.size(); ++k) {
      point = (point << 6U) | (static_cast<std::uint8_t>(text[i + k]) & 0x3FU);
    }
    points += point;
    i += length;
  }
  return points;
}

std::string array_of(const std::vector<std::string>& words) {
  std::vector<std::u32string> points;
  std::size_t width = 1;
  for (const auto& word : words) {
    points.push_back(code_points(word));
    width = std::max(width, points.back().size());
  }
  std::string bytes = array_header(fmt::format("<U{}", width), words.size());
  for (auto& word : points) {
    word.resize(width, U'\0');
    for (const char32_t point : word) put(bytes, point, 4);
  }
  return bytes;
}

/// The fields that the header of a member and its entry in the directory share.
std::string member_fields(const std::string& name, const std::string& content, std::uint32_t crc) {
  std::string bytes;
  put(bytes, 20, 2);                    // version needed
  put(bytes, 0x0800, 2);                // names are UTF-8
  put(bytes, 0, 2);                     // stored
  put(bytes, 0x00210000, 4);            // 1980-01-01: the same table is the same file
  put(bytes, crc, 4);
  put(bytes, content.size(), 4);
  put(bytes, content.size(), 4);
  put(bytes, name.size(), 2);
  put(bytes, 0, 2);  // no extra field
  return bytes;
}

}  // namespace

std::string to_npz(const std::vector<TableColumn>& table) {
  std::string archive, directory;
  for (const auto& column : table) {
    const auto name = column.name + ".npy";
    const auto content = std::visit([](const auto& values) { return array_of(values); }, column.values);
    const auto fields = member_fields(name, content, crc_of(content));
    put(directory, 0x02014B50, 4);
    put(directory, 20, 2);
    directory += fields;
    put(directory, 0, 2);  // comment
    put(directory, 0, 2);  // disk
    put(directory, 0, 2);  // internal attributes
    put(directory, 0, 4);  // external attributes
    put(directory, archive.size(), 4);
    directory += name;
    put(archive, 0x04034B50, 4);
    archive += fields + name + content;
  }
  const auto begin = archive.size();
  archive += directory;
  put(archive, 0x06054B50, 4);
  put(archive, 0, 4);
  put(archive, table.size(), 2);
  put(archive, table.size(), 2);
  put(archive, directory.size(), 4);
  put(archive, begin, 4);
  put(archive, 0, 2);
  return archive;
}

}  // namespace saltus::cli
