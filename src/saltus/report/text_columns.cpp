#include <algorithm>

#include "saltus/report/text_columns_internal.hpp"

namespace saltus::report {
namespace {

constexpr std::size_t page_width = 100;
constexpr std::size_t label_width = 12;

std::string padded(std::string text, std::size_t to) {
  const auto taken = width(text);
  return text.append(to > taken ? to - taken : 0, ' ');
}

}  // namespace

std::size_t width(std::string_view text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
}

std::string shortened(const std::string& text, std::size_t to) {
  if (width(text) <= to) return text;
  std::size_t end = 0;
  for (std::size_t characters = 0; end < text.size() && characters < to; ++end) {
    if ((static_cast<unsigned char>(text[end]) & 0xC0) != 0x80 && ++characters == to) break;
  }
  return text.substr(0, end) + "…";
}

std::string wrapped(std::string_view label, const std::vector<std::string>& pieces) {
  std::string text = padded(std::string(label), label_width);
  std::size_t column = label_width;
  for (const auto& piece : pieces) {
    if (column > label_width && column + width(piece) > page_width) {
      while (text.back() == ' ') text.pop_back();
      text += "\n" + std::string(label_width, ' ');
      column = label_width;
    }
    text += piece + "  ";
    column += width(piece) + 2;
  }
  while (!text.empty() && text.back() == ' ') text.pop_back();
  return text + "\n";
}

std::string paragraph(std::string_view label, std::string_view words) {
  std::string text = padded(std::string(label), label_width);
  std::size_t column = label_width;
  while (!words.empty()) {
    const auto end = std::min(words.find_first_of(" \n"), words.size());
    const auto word = words.substr(0, end);
    words.remove_prefix(std::min(end + 1, words.size()));
    if (word.empty()) continue;
    if (column > label_width && column + 1 + width(word) > page_width) {
      text += "\n" + std::string(label_width, ' ');
      column = label_width;
    }
    if (column > label_width) text += ' ';
    text += word;
    column += width(word) + 1;
  }
  return text + "\n";
}

std::string aligned(const std::vector<Row>& rows) {
  std::vector<std::size_t> widths(rows.front().size(), 0);
  for (const auto& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], width(row[i]));
  }
  std::string text;
  for (const auto& row : rows) {
    std::string line;
    for (std::size_t i = 0; i < row.size(); ++i) {
      if (widths[i] > 0) line += "  " + padded(row[i], widths[i]);
    }
    while (!line.empty() && line.back() == ' ') line.pop_back();
    text += line + "\n";
  }
  return text;
}

}  // namespace saltus::report
