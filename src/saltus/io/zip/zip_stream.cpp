#include "saltus/io/zip/zip_stream.hpp"

#include <algorithm>
#include <new>
#include <utility>
#include <zlib.h>

namespace saltus::io {
namespace {

/// Little-endian, so many bytes.
void append_bytes(std::string& record, std::uint64_t value, int bytes) {
  for (int i = 0; i < bytes; ++i, value >>= 8) record += static_cast<char>(value & 0xffU);
}

constexpr std::uint64_t elsewhere = 0xffffffffU;  // the number stands in the zip64 part
constexpr int version = 45;                       // that knows zip64
constexpr int deflate_method = 8;
constexpr int flags = (1 << 11) | (1 << 3);    // names are UTF-8; check and sizes stand behind the bytes
constexpr std::uint64_t first_of_1980 = 0x21;  // no clock: the same result gives the same bytes

/// Deflates pieces on their way into a sink.
class Deflater {
 public:
  explicit Deflater(Sink sink) : sink_(sink) {
    // Negative: without zlib's own header. The first level packs numbers nearly as well as the last, much faster.
    if (deflateInit2(&stream_, 1, Z_DEFLATED, -15, 9, Z_DEFAULT_STRATEGY) != Z_OK) throw std::bad_alloc();
  }
  Deflater(const Deflater&) = delete;
  Deflater& operator=(const Deflater&) = delete;
  ~Deflater() { deflateEnd(&stream_); }

  void add(std::string_view piece) {
    check_ = static_cast<std::uint32_t>(crc32_z(check_, reinterpret_cast<const Bytef*>(piece.data()), piece.size()));
    size_ += piece.size();
    constexpr std::size_t longest = std::size_t{1} << 30;
    for (; !piece.empty(); piece.remove_prefix(std::min(longest, piece.size()))) {
      // zlib does not write into its input; its type is from times without const.
      stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(piece.data()));
      stream_.avail_in = static_cast<uInt>(std::min(longest, piece.size()));
      run(Z_NO_FLUSH);
    }
  }
  void finish() { run(Z_FINISH); }
  [[nodiscard]] std::uint32_t check() const { return check_; }
  [[nodiscard]] std::uint64_t size() const { return size_; }
  [[nodiscard]] std::uint64_t packed() const { return packed_; }

 private:
  void run(int flush) {
    do {
      stream_.next_out = buffer_.data();
      stream_.avail_out = static_cast<uInt>(buffer_.size());
      deflate(&stream_, flush);
      const std::size_t made = buffer_.size() - stream_.avail_out;
      packed_ += made;
      if (made > 0) static_cast<void>(sink_({reinterpret_cast<const char*>(buffer_.data()), made}));
    } while (stream_.avail_out == 0);
  }

  Sink sink_;
  z_stream stream_{};
  std::vector<Bytef> buffer_ = std::vector<Bytef>(std::size_t{1} << 16);
  std::uint32_t check_ = 0;
  std::uint64_t size_ = 0, packed_ = 0;
};

}  // namespace

bool ZipStream::put(std::string_view bytes) {
  offset_ += bytes.size();
  good_ = good_ && sink_(bytes);
  return good_;
}

bool ZipStream::add(const std::string& name, Writer content) {
  Entry entry{name, 0, 0, 0, offset_};
  std::string head("PK\x03\x04");
  append_bytes(head, version, 2);
  append_bytes(head, flags, 2);
  append_bytes(head, deflate_method, 2);
  append_bytes(head, first_of_1980 << 16, 4);
  append_bytes(head, 0, 4);
  append_bytes(head, elsewhere, 4);
  append_bytes(head, elsewhere, 4);
  append_bytes(head, name.size(), 2);
  append_bytes(head, 20, 2);
  head += name;
  append_bytes(head, 1, 2);
  append_bytes(head, 16, 2);
  append_bytes(head, 0, 8 + 8);
  put(head);
  const auto pass = [this](std::string_view bytes) { return put(bytes); };
  Deflater deflater(pass);
  const bool complete = content([&](std::string_view piece) {
    deflater.add(piece);
    return good_;
  });
  good_ = good_ && complete;
  deflater.finish();
  entry.check = deflater.check(), entry.size = deflater.size(), entry.packed = deflater.packed();
  std::string descriptor("PK\x07\x08");
  append_bytes(descriptor, entry.check, 4);
  append_bytes(descriptor, entry.packed, 8);
  append_bytes(descriptor, entry.size, 8);
  entries_.push_back(std::move(entry));
  return put(descriptor);
}

bool ZipStream::finish() {
  const std::uint64_t begin = offset_;
  for (const Entry& entry : entries_) {
    std::string record("PK\x01\x02");
    append_bytes(record, version, 2);
    append_bytes(record, version, 2);
    append_bytes(record, flags, 2);
    append_bytes(record, deflate_method, 2);
    append_bytes(record, first_of_1980 << 16, 4);
    append_bytes(record, entry.check, 4);
    append_bytes(record, elsewhere, 4);
    append_bytes(record, elsewhere, 4);
    append_bytes(record, entry.name.size(), 2);
    append_bytes(record, 28, 2);
    append_bytes(record, 0, 2 + 2 + 2 + 4);  // no comment, one disk, no attributes
    append_bytes(record, elsewhere, 4);
    record += entry.name;
    append_bytes(record, 1, 2);
    append_bytes(record, 24, 2);
    append_bytes(record, entry.size, 8);
    append_bytes(record, entry.packed, 8);
    append_bytes(record, entry.offset, 8);
    put(record);
  }
  const std::uint64_t end = offset_, count = entries_.size();
  std::string last("PK\x06\x06");
  append_bytes(last, 44, 8);
  append_bytes(last, version, 2);
  append_bytes(last, version, 2);
  append_bytes(last, 0, 8);
  append_bytes(last, count, 8);
  append_bytes(last, count, 8);
  append_bytes(last, end - begin, 8);
  append_bytes(last, begin, 8);
  last += "PK\x06\x07";
  append_bytes(last, 0, 4);
  append_bytes(last, end, 8);
  append_bytes(last, 1, 4);
  last += "PK\x05\x06";
  append_bytes(last, 0, 4);
  append_bytes(last, std::min<std::uint64_t>(count, 0xffffU), 2);
  append_bytes(last, std::min<std::uint64_t>(count, 0xffffU), 2);
  append_bytes(last, elsewhere, 4);
  append_bytes(last, elsewhere, 4);
  append_bytes(last, 0, 2);
  return put(last);
}

}  // namespace saltus::io
