#include "saltus/base/told_together.hpp"

#include <algorithm>
#include <cstddef>
#include <string_view>

namespace saltus {
namespace {

constexpr std::size_t fewest = 4;  // are told together
constexpr std::size_t named = 3;   // of the others

/// The first name in quotes, with them; empty if there is none.
std::string_view name_in(std::string_view text) {
  const auto begin = std::min(text.find('\''), text.size());
  const auto end = text.find('\'', std::min(begin + 1, text.size()));
  return end == std::string_view::npos ? std::string_view() : text.substr(begin, end + 1 - begin);
}

/// Without its place, "model.toml:4: ", and without its first name in quotes; empty if it has none.
std::string kind_of(std::string_view text) {
  const auto colon = std::min(text.find(": "), text.size());
  const auto number = text.substr(0, colon).find_last_not_of("0123456789") + 1;  // npos + 1 is 0
  if (number < colon && (number == 0 || text[number - 1] == ':')) text.remove_prefix(colon);
  const auto name = name_in(text);
  if (name.empty()) return {};
  const auto begin = static_cast<std::size_t>(name.data() - text.data());
  return std::string(text.substr(0, begin)) + '#' + std::string(text.substr(begin + name.size()));
}

struct Group {
  std::string kind;
  std::vector<std::string> texts;
};

std::string told(const Group& group) {
  const std::size_t others = group.texts.size() - 1;
  std::string names;
  for (std::size_t i = 1; i <= std::min(named, others); ++i) {
    names += (names.empty() ? ": " : ", ") + std::string(name_in(group.texts[i]));
  }
  if (others > named) names += ", …";
  return group.texts.front() + " (and " + std::to_string(others) + " more like it" + names + ")";
}

}  // namespace

std::vector<std::string> told_together(const std::vector<std::string>& texts) {
  std::vector<Group> groups;
  for (const auto& text : texts) {
    auto kind = kind_of(text);
    auto group =
        std::find_if(groups.begin(), groups.end(), [&](const Group& one) { return !kind.empty() && one.kind == kind; });
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
