#include "saltus/base/error.hpp"

#include <algorithm>
#include <cctype>
#include <numeric>

namespace saltus {
namespace {

/// Edits that turn one name into the other: letters inserted, deleted, replaced or swapped with their neighbour
/// (optimal string alignment), compared without case.
std::size_t edit_distance(const std::string& a, const std::string& b) {
  const auto same = [](char x, char y) {
    return std::tolower(static_cast<unsigned char>(x)) == std::tolower(static_cast<unsigned char>(y));
  };
  std::vector<std::size_t> above_last(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::swap(above_last, last);
    std::swap(last, row);
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = last[j - 1] + (same(a[i - 1], b[j - 1]) ? 0 : 1);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, replaced});
      const bool swapped = i > 1 && j > 1 && same(a[i - 1], b[j - 2]) && same(a[i - 2], b[j - 1]);
      if (swapped) row[j] = std::min(row[j], above_last[j - 2] + 1);
    }
  }
  return row.back();
}

std::string joined(const std::vector<std::string>& names, const std::string& separator, const std::string& quote) {
  std::string text;
  for (const auto& name : names) text += (text.empty() ? "" : separator) + quote + name + quote;
  return text;
}

/// Longer messages quote something that nobody would read to its end: the middle is left out.
constexpr std::size_t longest_shown = 2000;

/// Where a character of UTF-8 begins, at or before a place.
std::size_t character_start(const std::string& text, std::size_t place) {
  while (place > 0 && place < text.size() && (static_cast<unsigned char>(text[place]) & 0xC0U) == 0x80U) --place;
  return place;
}

/// Part of an error fit for a terminal: no control characters (names in quotes may contain them), not endless.
std::string shown(const std::string& text) {
  std::string result;
  const bool whole = text.size() <= longest_shown;
  const std::size_t head = whole ? text.size() : character_start(text, longest_shown / 2);
  const std::size_t tail = whole ? text.size() : character_start(text, text.size() - longest_shown / 4);
  const auto append = [&](std::size_t begin, std::size_t end) {
    constexpr const char* hexadecimal = "0123456789abcdef";
    for (std::size_t i = begin; i < end; ++i) {
      const auto byte = static_cast<unsigned char>(text[i]);
      if (byte >= 0x20U && byte != 0x7FU) {
        result += text[i];
      } else {
        result += std::string("\\x") + hexadecimal[byte >> 4U] + hexadecimal[byte & 0xFU];
      }
    }
  };
  append(0, head);
  if (!whole) result += " … ";
  append(tail, text.size());
  return result;
}

}  // namespace

std::string to_text(const Error& error) {
  std::string text;
  if (!error.location.file.empty()) {
    text += shown(error.location.file);
    if (error.location.line > 0) text += ":" + std::to_string(error.location.line);
    if (error.location.column > 0) text += ":" + std::to_string(error.location.column);
    text += ": ";
  }
  text += "error: " + shown(error.message);
  for (const auto& frame : error.context) text += "\n  " + shown(frame);
  if (!error.remedy.empty()) text += "\n  " + shown(error.remedy);
  return text;
}

std::vector<std::string> nearest_names(const std::string& name, const std::vector<std::string>& known) {
  std::vector<std::pair<std::size_t, std::string>> ranked;
  std::vector<std::string> longer_or_shorter;
  for (const auto& candidate : known) {
    // A third of the letters may differ: "mu" ~ "mue" is a slip, "mu" ~ "x0" is not.
    const auto [shorter, longer] = std::minmax({name.size(), candidate.size()});
    const std::size_t allowed = std::max<std::size_t>(1, longer / 3);
    const bool begins_alike = name.starts_with(candidate) || candidate.starts_with(name);
    if (begins_alike && shorter >= 4 && longer <= 5 * shorter) longer_or_shorter.push_back(candidate);
    if (longer - shorter > allowed) continue;  // so many letters are missing at least; names may be of any length
    const std::size_t distance = edit_distance(name, candidate);
    // Without a letter in common it is another name: "x" suggests nothing about "t".
    const bool related = distance < std::max(name.size(), candidate.size());
    if (related && distance <= allowed) ranked.emplace_back(distance, candidate);
  }
  std::stable_sort(ranked.begin(), ranked.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<std::string> names;
  for (const auto& [distance, candidate] : ranked) names.push_back(candidate);
  if (names.empty()) names = std::move(longer_or_shorter);
  names.resize(std::min<std::size_t>(names.size(), 3));
  return names;
}

std::string suggest(const std::string& name, const std::vector<std::string>& known) {
  return suggestion(nearest_names(name, known), known);
}

std::string suggestion(const std::vector<std::string>& nearest, const std::vector<std::string>& known) {
  if (!nearest.empty()) return "did you mean " + joined(nearest, " or ", "'") + "?";
  return known.empty() ? "" : "known: " + joined(known, ", ", "");
}

}  // namespace saltus
