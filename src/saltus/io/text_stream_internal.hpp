// Text on its way into a sink.
#pragma once

#include <cstddef>
#include <string>

#include "saltus/io/atomic_file.hpp"

namespace saltus::io {

/// Collects text and passes it on in long pieces.
class TextStream {
 public:
  /// The sink must outlive it.
  explicit TextStream(Sink sink) : sink_(sink) {}

  /// Returns the text that is appended to, which is passed on by one of the next two.
  [[nodiscard]] std::string& text() { return text_; }
  /// Passes on what is there if that is much; false if the sink wants no more.
  bool pass() { return text_.size() < longest ? good_ : flush(); }
  /// Passes on all; false if the sink did not take everything.
  bool flush() {
    if (good_ && !text_.empty()) good_ = sink_(text_);
    text_.clear();
    return good_;
  }

 private:
  static constexpr std::size_t longest = std::size_t{1} << 18;
  Sink sink_;
  std::string text_;
  bool good_ = true;
};

/// Returns what a writer of parts returns where its sink took all, or did not.
[[nodiscard]] inline Expected<void> taken(bool all) {
  if (all) return {};
  return tl::unexpected(Error{ErrorCode::io_failure, "not everything was taken", "", {}, {}});
}

/// Returns all that a writer writes.
[[nodiscard]] inline std::string collected(Writer writer) {
  std::string all;
  static_cast<void>(writer([&](std::string_view piece) {
    all += piece;
    return true;
  }));
  return all;
}

}  // namespace saltus::io
