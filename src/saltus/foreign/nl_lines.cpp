#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/text.hpp"
#include "saltus/foreign/nl_lines_internal.hpp"

namespace saltus::foreign {
namespace {

constexpr std::string_view blanks = " \t\r\f\v";

std::string shown(std::string_view text) {
  if (text.empty()) return "nothing";
  constexpr std::size_t longest = 40;
  return fmt::format("'{}{}'", text.substr(0, longest), text.size() > longest ? "..." : "");
}

}  // namespace

NlLines::NlLines(std::string_view text, std::string file)
    : rest_(text), file_(std::move(file)), lines_(std::count(text.begin(), text.end(), '\n')) {
  if (!text.empty() && text.back() != '\n') ++lines_;
}

bool NlLines::advance_if_any() {
  words_.clear();
  while (!rest_.empty() && words_.empty()) {
    const auto end = std::min(rest_.find('\n'), rest_.size());
    auto line = rest_.substr(0, std::min(end, rest_.find('#')));
    rest_.remove_prefix(std::min(end + 1, rest_.size()));
    ++line_;
    for (auto begin = line.find_first_not_of(blanks); begin != std::string_view::npos;
         begin = line.find_first_not_of(blanks)) {
      line.remove_prefix(begin);
      const auto length = std::min(line.find_first_of(blanks), line.size());
      words_.push_back(line.substr(0, length));
      line.remove_prefix(length);
    }
  }
  return !words_.empty();
}

bool NlLines::advance(std::string_view expected) {
  if (failed()) return false;
  if (advance_if_any()) return true;
  fail(fmt::format("the file ends where {} was expected", expected),
       "the file is not complete: write it again, or copy it as a whole");
  return false;
}

void NlLines::fail(std::string message, std::string remedy, ErrorCode code) {
  if (failed()) return;
  error_ = Error{code, std::move(message), std::move(remedy), {file_, line_, 0}, {}};
}

long NlLines::whole_in(std::string_view text, std::string_view what, long low, long high) {
  if (failed()) return low;
  const auto number = whole_text_as<long>(without_plus(text));
  if (number && *number >= low && *number <= high) return *number;
  if (number && low <= high) {
    fail(fmt::format("expected {} from {} to {}, found {}", what, low, high, *number));
  } else if (number) {
    fail(fmt::format("found {} {} where there can be none", what, *number));
  } else {
    fail(fmt::format("expected {}, a whole number, found {}", what, shown(text)));
  }
  return low;
}

double NlLines::number_in(std::string_view text, std::string_view what) {
  if (failed()) return 0.0;
  const auto number = whole_text_as<double>(without_plus(text));
  if (number && !std::isnan(*number)) return *number;
  fail(fmt::format("expected {}, a number, found {}", what, shown(text)));
  return 0.0;
}

long NlLines::whole(std::size_t i, std::string_view what, long low, long high) {
  return whole_in(word(i), what, low, high);
}
long NlLines::whole_behind_letter(std::string_view what, long low, long high) {
  return whole_in(word(0).substr(std::min<std::size_t>(1, word(0).size())), what, low, high);
}
double NlLines::number(std::size_t i, std::string_view what) { return number_in(word(i), what); }
double NlLines::number_behind_letter(std::string_view what) {
  return number_in(word(0).substr(std::min<std::size_t>(1, word(0).size())), what);
}

}  // namespace saltus::foreign
