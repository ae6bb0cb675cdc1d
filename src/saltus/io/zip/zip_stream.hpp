// A zip archive that is written while it is made.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "saltus/io/atomic_file.hpp"

namespace saltus::io {

/// Writes deflated entries one after the other, in the form that has room for any size (zip64). Reference: APPNOTE.TXT
/// 6.3.
class ZipStream {
 public:
  /// The sink must outlive it.
  explicit ZipStream(Sink sink) : sink_(sink) {}
  /// Writes an entry of what the writer writes; false if the sink wants no more. Memory: a few pieces.
  bool add(const std::string& name, Writer content);
  /// Writes the list of the entries; false if the sink did not take everything.
  bool finish();

 private:
  struct Entry {
    std::string name;
    std::uint32_t check = 0;
    std::uint64_t size = 0, packed = 0, offset = 0;
  };
  bool put(std::string_view bytes);

  Sink sink_;
  std::vector<Entry> entries_;
  std::uint64_t offset_ = 0;
  bool good_ = true;
};

}  // namespace saltus::io
