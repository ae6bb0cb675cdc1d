#include "saltus/io/zip/npy.hpp"

#include <fmt/format.h>

namespace saltus::io {

std::string npy_head(const std::string& type, std::size_t count) {
  constexpr std::size_t alignment = 64, before = 10;
  std::string text = fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': ({},), }}", type, count);
  text.append(alignment - (before + text.size() + 1) % alignment, ' ') += '\n';
  std::string head("\x93NUMPY\x01\x00", 8);
  head += static_cast<char>(text.size() & 0xffU);
  head += static_cast<char>(text.size() >> 8U);
  return head + text;
}

std::u32string code_points(const std::string& text) {
  std::u32string points;
  for (std::size_t i = 0; i < text.size();) {
    const auto byte = static_cast<unsigned char>(text[i]);
    const std::size_t length = byte < 0x80 ? 1 : byte < 0xe0 ? 2 : byte < 0xf0 ? 3 : 4;
    char32_t point = length == 1 ? byte : byte & (0x7fU >> length);
    bool good = byte < 0x80 || byte >= 0xc0;
    for (std::size_t k = 1; k < length; ++k) {
      const auto next = i + k < text.size() ? static_cast<unsigned char>(text[i + k]) : 0U;
      good = good && (next & 0xc0U) == 0x80U;
      point = (point << 6U) | (next & 0x3fU);
    }
    points += good ? point : U'\ufffd';
    i += good ? length : 1;
  }
  return points;
}

}  // namespace saltus::io
