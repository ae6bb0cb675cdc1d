// The format of one array of NumPy (.npy).
#pragma once

#include <cstddef>
#include <string>

namespace saltus::io {

/// Returns what numpy.load reads before the numbers of a column (NEP 1): the version 1.0, of a multiple of 64 bytes.
/// @param type  as in numpy.dtype.str: "<f8", "|i1", "<U12"
[[nodiscard]] std::string npy_head(const std::string& type, std::size_t count);

/// Returns the code points of UTF-8, of which an array of words has four bytes each; what is none of it becomes the
/// sign for that.
[[nodiscard]] std::u32string code_points(const std::string& text);

}  // namespace saltus::io
