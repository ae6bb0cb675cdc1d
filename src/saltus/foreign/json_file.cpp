#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/base/docs_page.hpp"
#include "saltus/foreign/json_file_internal.hpp"

namespace saltus::foreign {
namespace {

using casadi::SX;

/// Infinity and NaN outside of strings as strings of the same length, so that places stay where they are.
std::string with_quoted_tokens(const std::string& text) {
  std::string quoted = text;
  constexpr std::array<std::pair<std::string_view, std::string_view>, 3> tokens{
      {{"-Infinity", "\"-inf\"   "}, {"Infinity", "\"inf\"   "}, {"NaN", "\"n\""}}};
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (in_string && text[i] == '\\') {
      ++i;
    } else if (text[i] == '"') {
      in_string = !in_string;
    } else if (!in_string) {
      for (const auto& [token, replacement] : tokens) {
        if (text.compare(i, token.size(), token) != 0) continue;
        quoted.replace(i, token.size(), replacement);
        i += token.size() - 1;
        break;
      }
    }
  }
  return quoted;
}

/// nullopt if it stands for none.
std::optional<double> number_of(const Json& json) {
  constexpr double huge = std::numeric_limits<double>::infinity();
  if (json.is_number()) return json.get<double>();
  if (!json.is_string()) return std::nullopt;
  const auto& word = json.get_ref<const std::string&>();
  if (word == "inf") return huge;
  if (word == "-inf") return -huge;
  if (word == "n") return std::numeric_limits<double>::quiet_NaN();
  return std::nullopt;
}

std::string json_text(const Json& json) {
  const auto text = json.dump(-1, ' ', true, Json::error_handler_t::replace);
  constexpr std::size_t longest = 40;
  return text.size() > longest ? text.substr(0, longest) + "..." : text;
}

/// The bytes behind the letters: two letters a-p per byte, low nibble first. Empty if it is something else.
std::string bytes_of(std::string_view letters) {
  const auto is_letter = [](char c) { return c >= 'a' && c <= 'p'; };
  if (letters.size() % 2 != 0 || !std::all_of(letters.begin(), letters.end(), is_letter)) return {};
  std::string bytes;
  for (std::size_t i = 0; i < letters.size(); i += 2) {
    bytes.push_back(static_cast<char>((letters[i] - 'a') | ((letters[i + 1] - 'a') << 4)));
  }
  return bytes;
}

std::int64_t whole_number_at(std::string_view bytes, std::size_t begin) {
  std::uint64_t number = 0;
  for (std::size_t i = 8; i-- > 0;) number = number << 8 | static_cast<unsigned char>(bytes[begin + i]);
  return static_cast<std::int64_t>(number);
}

/// What an exception of CasADi says, without the trail of places in its own sources.
std::string first_lines(const std::string& words) {
  std::string text = words.substr(0, 300);
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

}  // namespace

JsonFile::JsonFile(const std::string& text, std::string file) : file_(std::move(file)) {
  try {
    json_ = Json::parse(with_quoted_tokens(text));
  } catch (const Json::exception& failure) {
    const auto* syntax = dynamic_cast<const Json::parse_error*>(&failure);
    const auto byte = syntax != nullptr ? std::min(syntax->byte, text.size()) : 0;
    const auto before = std::string_view(text).substr(0, byte > 0 ? byte - 1 : 0);
    const auto line = 1 + std::count(before.begin(), before.end(), '\n');
    const auto column = before.size() - (before.rfind('\n') + 1) + 1;
    fail(byte >= text.size() ? "the file ends in the middle of its JSON text" : "not valid JSON",
         "the file is not complete or not JSON: copy it again as a whole");
    error_->location = {file_, static_cast<int>(line), static_cast<int>(column)};
    return;
  }
  if (!json_.is_object()) fail(fmt::format("expected a JSON object, found {}", json_text(json_)));
}

void JsonFile::fail(std::string message, std::string remedy, ErrorCode code) {
  if (!error_) error_ = Error{code, std::move(message), std::move(remedy), {file_, 0, 0}, {}};
}

const Json* JsonFile::member(const char* key) {
  if (failed()) return nullptr;
  if (const auto found = json_.find(key); found != json_.end()) return &*found;
  fail(fmt::format("there is no member \"{}\"", key),
       fmt::format("what it holds is in {}", docs_page("foreign-mpcc", "what-is-read")));
  return nullptr;
}

std::vector<double> JsonFile::numbers(const char* key, std::optional<std::size_t> size) {
  const auto* json = member(key);
  std::vector<double> values;
  if (json == nullptr) return std::vector<double>(size.value_or(0), 0.0);
  const auto take = [&](const Json& entry) {
    const auto number = number_of(entry);
    if (!number) fail(fmt::format("{}: expected a number, Infinity or -Infinity, found {}", key, json_text(entry)));
    values.push_back(number.value_or(0.0));
  };
  if (!json->is_array()) take(*json);
  if (json->is_array()) std::for_each(json->begin(), json->end(), take);
  if (size && values.size() != *size) {
    fail(fmt::format("{}: expected {} numbers, found {}", key, *size, values.size()),
         "one for each variable of w, for each row of g_fun, for each pair");
    values.assign(*size, 0.0);
  }
  return values;
}

std::string JsonFile::stream(const char* key, const char* what) {
  const auto* json = member(key);
  if (json == nullptr) return {};
  const auto* letters = json->is_string() ? json->get_ptr<const std::string*>() : nullptr;
  const auto bytes = letters != nullptr ? bytes_of(*letters) : std::string();
  constexpr std::int64_t mark = 123456789012345;
  constexpr std::int64_t protocol = 3;
  if (bytes.size() < 17 || whole_number_at(bytes, 0) != mark) {
    fail(fmt::format("{}: expected {} serialised by CasADi (a string of letters a to p), found {}", key, what,
                     json_text(*json)));
  } else if (const auto found = whole_number_at(bytes, 8); found != protocol) {
    fail(fmt::format("{}: serialised with protocol {} of CasADi, this version reads protocol {}", key, found, protocol),
         "write the file with CasADi 3.5 to 3.8", ErrorCode::not_available);
  } else {
    return *letters;
  }
  return {};
}

SX JsonFile::symbols(const char* key) {
  const auto text = stream(key, "an expression");
  if (failed()) return SX(0, 1);
  try {
    auto symbols = SX::densify(SX::deserialize(text));
    if (symbols.numel() == 0) return SX(0, 1);
    symbols = SX::vec(symbols);
    if (symbols.is_valid_input()) return symbols;
    fail(fmt::format("{}: expected a column of symbols, found an expression", key));
  } catch (const std::exception& failure) {
    fail(fmt::format("{}: cannot be read: {}", key, first_lines(failure.what())),
         "the file is not complete, or written by a newer CasADi than 3.8");
  }
  return SX(0, 1);
}

std::vector<SX> JsonFile::values(const char* key, const SX& w, const std::vector<double>& p) {
  const auto text = stream(key, "a function");
  // Other classes may load libraries or solvers.
  if (!failed() && bytes_of(text).substr(0, 64).find("SXFunction") == std::string::npos) {
    fail(fmt::format("{}: expected a function of SX expressions", key), "make it with casadi::SX, or expand it",
         ErrorCode::not_available);
  }
  if (failed()) return {};
  try {
    const auto function = casadi::Function::deserialize(text);
    const auto inputs = function.n_in();
    if (inputs < 1 || inputs > 2 || function.n_out() != 1) {
      fail(fmt::format(
          "{}: expected a function of w, or of w and p, with one value; this one has {} inputs and {} outputs", key,
          inputs, function.n_out()));
      return {};
    }
    if (function.numel_in(0) != w.numel() ||
        (inputs == 2 && function.numel_in(1) != static_cast<casadi_int>(p.size()))) {
      fail(fmt::format("{}: expected a function of {} variables and {} parameters, found one of {} and {}", key,
                       w.numel(), p.size(), function.numel_in(0), inputs == 2 ? function.numel_in(1) : 0));
      return {};
    }
    std::vector<SX> arguments{SX::reshape(w, function.size1_in(0), function.size2_in(0))};
    if (inputs == 2) arguments.push_back(SX::reshape(SX(casadi::DM(p)), function.size1_in(1), function.size2_in(1)));
    const auto value = SX::densify(function(arguments).front());
    std::vector<SX> scalars;
    for (const auto& element : value.nonzeros()) scalars.emplace_back(element);
    return scalars;
  } catch (const std::exception& failure) {
    fail(fmt::format("{}: cannot be read: {}", key, first_lines(failure.what())),
         "the file is not complete, or written by a newer CasADi than 3.8");
  }
  return {};
}

}  // namespace saltus::foreign
