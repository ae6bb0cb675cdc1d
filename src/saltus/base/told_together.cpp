#include "saltus/base/told_together.hpp"

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <string_view>

namespace saltus {
namespace {

constexpr std::size_t fewest = 4;  // are told together
constexpr std::size_t named = 3;   // of the others

bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

/// The first name in quotes, with them; empty if there is none.
std::string_view name_in(std::string_view text) {
  const auto begin = std::min(text.find('\''), text.size());
  const auto end = text.find('\'', std::min(begin + 1, text.size()));
  return end == std::string_view::npos ? std::string_view() : text.substr(begin, end + 1 - begin);
}

/// Without numbers and names in quotes.
std::string kind_of(std::string_view text) {
  std::string kind;
  while (!text.empty()) {
    std::size_t left_out = 0;
    if (text.front() == '\'') left_out = name_in(text).size();
    while (left_out < text.size() && is_digit(text[left_out])) {
      left_out = std::min(text.find_first_not_of("0123456789", left_out), text.size());
      const auto next = std::min(text.find_first_not_of(".e+-", left_out), text.size());
      if (next > left_out && next < text.size() && is_digit(text[next])) left_out = next;
    }
    kind += left_out > 0 ? '#' : text.front();
    text.remove_prefix(std::max<std::size_t>(left_out, 1));
  }
  return kind;
}

struct Group {
  std::string kind;
  std::vector<std::string> texts;
};

std::string told(const Group& group) {
  const std::size_t others = group.texts.size() - 1;
  std::string names;
  for (std::size_t i = 1; i <= std::min(named, others); ++i) {
    const auto name = name_in(group.texts[i]);
    if (!name.empty()) names += (names.empty() ? ": " : ", ") + std::string(name);
  }
  if (!names.empty() && others > named) names += ", …";
  return group.texts.front() + " (and " + std::to_string(others) + " more like it" + names + ")";
}

}  // namespace

std::vector<std::string> told_together(const std::vector<std::string>& texts) {
  std::vector<Group> groups;
  for (const auto& text : texts) {
    auto kind = kind_of(text);
    auto group = std::find_if(groups.begin(), groups.end(), [&](const Group& one) { return one.kind == kind; });
    if (group == groups.end()) group = groups.insert(groups.end(), {std::move(kind), {}});
    group->texts.push_back(text);
  }
  std::vector<std::string> result;
  for (const auto& group : groups) {
    if (group.texts.size() < fewest) {
      result.insert(result.end(), group.texts.begin(), group.texts.end());
    } else {
      result.push_back(told(group));
    }
  }
  return result;
}

}  // namespace saltus
