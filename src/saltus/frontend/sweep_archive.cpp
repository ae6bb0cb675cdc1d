// The table of a sweep as arrays of NumPy.
#include <algorithm>
#include <bit>
#include <cstdint>

#include <fmt/format.h>

#include "saltus/frontend/sweep_table.hpp"
#include "saltus/io/zip/npy.hpp"
#include "saltus/io/zip/zip_stream.hpp"

namespace saltus::frontend {
namespace {

static_assert(std::endian::native == std::endian::little, "bytes are written as they are in memory");

template <class Number>
std::string_view bytes_of(const Number* numbers, std::size_t count) {
  return {reinterpret_cast<const char*>(numbers), count * sizeof(Number)};
}

bool write_array(const std::vector<double>& values, io::Sink sink) {
  return sink(io::npy_head("<f8", values.size())) && sink(bytes_of(values.data(), values.size()));
}

bool write_array(const std::vector<std::string>& words, io::Sink sink) {
  std::size_t width = 1;
  for (const auto& word : words) width = std::max(width, io::code_points(word).size());
  bool good = sink(io::npy_head(fmt::format("<U{}", width), words.size()));
  for (std::size_t i = 0; good && i < words.size(); ++i) {
    auto points = io::code_points(words[i]);
    points.resize(width, U'\0');
    good = sink(bytes_of(points.data(), width));
  }
  return good;
}

}  // namespace

bool write_npz(const std::vector<TableColumn>& table, io::Sink sink) {
  io::ZipStream archive(sink);
  for (const auto& column : table) {
    // Names of files cannot have a slash.
    auto name = column.name + ".npy";
    std::replace(name.begin(), name.end(), '/', '|');
    const auto write = [&](io::Sink into) {
      return std::visit([&](const auto& values) { return write_array(values, into); }, column.values);
    };
    if (!archive.add(name, write)) return false;
  }
  return archive.finish();
}

}  // namespace saltus::frontend
