#include "saltus/foreign/parse.hpp"

#include <exception>

#include <fmt/format.h>

#include "saltus/foreign/make_problem.hpp"
#include "saltus/foreign/readers_internal.hpp"

namespace saltus::foreign {
namespace {

Error unknown_format(const std::string& text, const std::string& file, std::size_t first) {
  const bool is_empty = first == std::string::npos;
  return {
      ErrorCode::parse_failure,
      is_empty ? "the file is empty" : "this is neither an AMPL .nl text (first letter g) nor JSON (first letter {)",
      !is_empty && text[first] == 'b' ? "a binary .nl file? write it as text, in AMPL `write gNAME;`"
                                      : "saltus mpcc reads .nl text, and JSON of NOSBENCH and mpecopt",
      {file, is_empty ? 0 : 1, 0},
      {}};
}

Expected<Statement> statement_in(const std::string& text, const std::string& file, const Names& names) {
  const auto first = text.find_first_not_of(" \t\r\n\xef\xbb\xbf");
  const char letter = first == std::string::npos ? '\0' : text[first];
  if (letter == '{') return parse_json(text.substr(first), file);
  if (letter == 'g' || (letter == 'b' && first + 1 < text.size() && text[first + 1] >= '0' && text[first + 1] <= '9')) {
    return parse_nl(text, file, names);
  }
  return tl::unexpected(unknown_format(text, file, first));
}

}  // namespace

Expected<std::unique_ptr<Problem>> parse(const std::string& text, const std::string& file, const Names& names) {
  try {
    auto statement = statement_in(text, file, names);
    if (!statement) return tl::unexpected(statement.error());
    return make_problem(std::move(*statement));
  } catch (const std::exception& failure) {
    return tl::unexpected(Error{ErrorCode::invalid_model,
                                fmt::format("the expressions of the file cannot be used: {}", failure.what()),
                                "please report this with the file",
                                {file, 0, 0},
                                {}});
  }
}

}  // namespace saltus::foreign
