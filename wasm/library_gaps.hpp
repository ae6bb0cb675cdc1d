// What the sources use of C++20 and the library of emscripten 3.1.6 (libc++ 13) has not: included before every source.
#pragma once

#include <version>

#if defined(_LIBCPP_VERSION) && !defined(__cpp_lib_bit_cast)
namespace std {
template <class To, class From>
[[nodiscard]] constexpr To bit_cast(const From& value) noexcept {
  return __builtin_bit_cast(To, value);
}
}  // namespace std
#endif

#if defined(_LIBCPP_VERSION) && _LIBCPP_VERSION < 200000
#include <cctype>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <string>

namespace std {
/// By strtod, which rounds correctly in musl. What only strtod takes is kept from it: blanks and a plus sign in front,
/// hexadecimal digits.
inline from_chars_result from_chars(const char* first, const char* last, double& value) {
  string text(first, last);
  if (text.empty() || text[0] == '+' || isspace(static_cast<unsigned char>(text[0])))
    return {first, errc::invalid_argument};
  text = text.substr(0, text.find_first_of("xX"));
  char* end = nullptr;
  errno = 0;
  const double read = strtod(text.c_str(), &end);
  if (end == text.c_str()) return {first, errc::invalid_argument};
  const char* behind = first + (end - text.c_str());
  if (errno == ERANGE && (isinf(read) || read == 0.0)) return {behind, errc::result_out_of_range};
  value = read;
  return {behind, errc{}};
}
}  // namespace std
#endif
