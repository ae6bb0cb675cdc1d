#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "saltus/io/json/json_document_internal.hpp"

namespace saltus::io {
namespace {

constexpr std::string_view white = " \t\r\n";

/// Returns the place of the quotation mark that ends what one at `quote` begins.
std::size_t end_of_words(std::string_view text, std::size_t quote) {
  std::size_t end = quote + 1;
  while (text[end] != '"') end += text[end] == '\\' ? 2U : 1U;
  return end;
}

/// Returns the place behind an entry or a member: of a comma, or of the bracket that closes its list or object.
std::size_t end_of_part(std::string_view text, std::size_t begin) {
  std::size_t depth = 0;
  for (std::size_t i = begin;; ++i) {
    switch (text[i]) {
      case '"':
        i = end_of_words(text, i);
        break;
      case '[':
      case '{':
        ++depth;
        break;
      case ']':
      case '}':
        if (depth-- == 0) return i;
        break;
      case ',':
        if (depth == 0) return i;
        break;
      default:
        break;
    }
  }
}

/// A tree of a text whose syntax is right, but for long lists.
/// @param levels  of objects in objects that are looked through for such lists: what is below is a tree in any case
Json tree_of(std::string_view text, int levels = 8) {
  text.remove_prefix(text.find_first_not_of(white));
  if (text.size() <= bytes_at_once || levels == 0) return Json::parse(text);
  if (text.front() == '[') return Json::binary(text);
  if (text.front() != '{') return Json::parse(text);
  Json object = Json::object();
  for (std::size_t begin = 1; (begin = text.find_first_not_of(white, begin)), text[begin] != '}';) {
    const std::size_t end = end_of_part(text, begin);
    const std::size_t behind_key = end_of_words(text, begin) + 1;
    const auto key = Json::parse(text.substr(begin, behind_key - begin)).get<std::string>();
    const std::size_t value = text.find(':', behind_key) + 1;
    object[key] = tree_of(text.substr(value, end - value), levels - 1);
    begin = text[end] == ',' ? end + 1 : end;
  }
  return object;
}

Error syntax_error(const std::string& text, const std::string& file, std::size_t byte) {
  const auto before = std::string_view(text).substr(0, byte > 0 ? byte - 1 : 0);
  const auto line = 1 + std::count(before.begin(), before.end(), '\n');
  const auto line_start = before.rfind('\n') + 1;  // npos + 1 is 0: the first line
  return {ErrorCode::parse_failure,
          text.empty() ? "the file is empty" : "not valid JSON",
          "expected a result file written by saltus simulate or saltus optimize with --out FILE.json",
          {file, static_cast<int>(line), static_cast<int>(before.size() - line_start + 1)},
          {}};
}

std::optional<Error> find_syntax_error(const std::string& text, const std::string& file) {
  if (Json::accept(text)) return std::nullopt;
  try {
    const auto keep_nothing = [](int, Json::parse_event_t, Json&) { return false; };
    const Json nothing = Json::parse(text, keep_nothing);
  } catch (const Json::parse_error& failure) {
    return syntax_error(text, file, failure.byte);
  } catch (const Json::exception&) {  // a number beyond the range of a double
  }
  return syntax_error(text, file, 1);
}

}  // namespace

Expected<Json> parse_document(const std::string& text, const std::string& file) {
  if (auto error = find_syntax_error(text, file)) return tl::unexpected(std::move(*error));
  return tree_of(text);
}

void for_each_piece(const Json& list, FunctionRef<bool(const Json& piece)> visit) {
  if (!list.is_binary()) {
    static_cast<void>(visit(list));
    return;
  }
  const std::string_view text = list.get_binary();
  std::size_t begin = 1;
  while ((begin = text.find_first_not_of(white, begin)), text[begin] != ']') {
    std::size_t end = end_of_part(text, begin);
    Json piece = Json::array();
    if (end - begin > bytes_at_once) {
      piece.push_back(tree_of(text.substr(begin, end - begin)));
    } else {
      for (std::size_t next = end;
           text[next] == ',' && (next = end_of_part(text, next + 1)) - begin <= bytes_at_once;) {
        end = next;
      }
      piece = Json::parse(fmt::format("[{}]", text.substr(begin, end - begin)));
    }
    if (!visit(piece)) return;
    begin = text[end] == ',' ? end + 1 : end;
  }
}

}  // namespace saltus::io
