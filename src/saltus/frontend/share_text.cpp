#include "saltus/frontend/share_text.hpp"

#include <algorithm>
#include <utility>

#include "saltus/io/json/json_result.hpp"

namespace saltus::frontend {
namespace {

/// Where the first line of a table ends; headings may have line ends in quotes.
std::size_t end_of_headings(std::string_view text) {
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '"') quoted = !quoted;
    if (text[i] == '\n' && !quoted) return i + 1;
  }
  return text.size();
}

std::size_t place_of_status(const std::vector<std::string>& headings) {
  return static_cast<std::size_t>(std::find(headings.begin(), headings.end(), "status") - headings.begin());
}

std::vector<std::string> from(const std::vector<std::string>& list, std::size_t place) {
  return {list.begin() + static_cast<std::ptrdiff_t>(place), list.end()};
}

}  // namespace

TextLines fields_of(std::string_view text) {
  TextLines lines(1);
  std::string field;
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (quoted) {
      if (c == '"' && i + 1 < text.size() && text[i + 1] == '"') {
        field += text[++i];
      } else if (c == '"') {
        quoted = false;
      } else {
        field += c;
      }
    } else if (c == '"') {
      quoted = true;
    } else if (c == ',' || c == '\n') {
      lines.back().push_back(std::move(field));
      field.clear();
      if (c == '\n') lines.emplace_back();
    } else if (c != '\r') {
      field += c;
    }
  }
  if (lines.back().empty() && field.empty()) lines.pop_back();
  return lines;
}

void JoinedHeadings::add(const std::vector<std::string>& headings) {
  const std::size_t status = place_of_status(headings);
  if (headings.size() > most_) {
    most_ = headings.size();
    changed_.assign(headings.begin(), headings.begin() + static_cast<std::ptrdiff_t>(status));
    if (!changed_.empty()) changed_[0] = "run";
  }
  others_.add(from(headings, status));
}

std::vector<std::string> JoinedHeadings::all() const {
  auto all = changed_;
  all.insert(all.end(), others_.all().begin(), others_.all().end());
  return all;
}

std::vector<std::size_t> JoinedHeadings::places_in(const std::vector<std::string>& headings) const {
  const std::size_t status = place_of_status(headings);
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < changed_.size(); ++i) places.push_back(i);
  for (const std::size_t place : others_.places_in(from(headings, status)))
    places.push_back(place == JoinedNames::missing ? place : place + status);
  return places;
}

std::vector<std::string> headings_of(std::string_view text) {
  const auto lines = fields_of(text.substr(0, end_of_headings(text)));
  return lines.empty() ? std::vector<std::string>() : lines.front();
}

std::string rows_of(std::string_view text, const JoinedHeadings& whole) {
  const auto rows = text.substr(end_of_headings(text));
  const auto headings = headings_of(text);
  const auto places = whole.places_in(headings);
  bool same = places.size() == headings.size();
  for (std::size_t k = 0; same && k < places.size(); ++k) same = places[k] == k;
  if (same) return std::string(rows);
  std::string moved;
  for (const auto& line : fields_of(rows)) {
    for (std::size_t k = 0; k < places.size(); ++k) {
      if (k > 0) moved += ',';
      moved += places[k] == JoinedNames::missing ? "nan" : io::csv_field(line.at(places[k]));
    }
    moved += '\n';
  }
  return moved;
}

}  // namespace saltus::frontend
