#include "saltus/result/kept_columns.hpp"

#include <algorithm>
#include <utility>

#include "saltus/base/contains.hpp"

namespace saltus::result {
namespace {

template <class Value>
std::vector<Value> chosen(const std::vector<Value>& all, const std::vector<std::size_t>& numbers) {
  std::vector<Value> some;
  for (const std::size_t number : numbers) {
    if (number < all.size()) some.push_back(all[number]);
  }
  return some;
}

template <class Value>
void choose(std::vector<Value>& list, const std::vector<std::size_t>& numbers) {
  list = chosen(list, numbers);
}

template <class Value>
void choose(std::optional<std::vector<Value>>& list, const std::vector<std::size_t>& numbers) {
  if (list) choose(*list, numbers);
}

Event as_in_rows(Event event, const KeptColumns& kept) {
  choose(event.x, kept.states), choose(event.x_after, kept.states);
  choose(event.mode_before, kept.switching_functions), choose(event.mode_after, kept.switching_functions);
  choose(event.alpha_before, kept.switching_functions), choose(event.alpha_after, kept.switching_functions);
  for (auto& other : event.alternatives) {
    choose(other.mode, kept.switching_functions), choose(other.alpha, kept.switching_functions);
  }
  return event;
}

}  // namespace

bool fits(std::string_view pattern, std::string_view name) {
  std::size_t p = 0, n = 0, star = std::string_view::npos, behind = 0;
  while (n < name.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      behind = n;
    } else if (p < pattern.size() && pattern[p] == name[n]) {
      ++p, ++n;
    } else if (star != std::string_view::npos) {
      p = star + 1;
      n = ++behind;  // the star takes one letter more
    } else {
      return false;
    }
  }
  return pattern.find_first_not_of('*', p) == std::string_view::npos;
}

tl::expected<std::vector<std::size_t>, std::string> numbers_of(const std::vector<std::string>& patterns,
                                                               const std::vector<std::string>& all) {
  std::vector<char> wanted(all.size(), 0);
  for (const auto& pattern : patterns) {
    const auto own = std::find(all.begin(), all.end(), pattern);
    bool found = own != all.end();
    if (found) wanted[static_cast<std::size_t>(own - all.begin())] = 1;
    for (std::size_t i = 0; own == all.end() && i < all.size(); ++i) {
      if (!fits(pattern, all[i])) continue;
      wanted[i] = 1;
      found = true;
    }
    if (!found) return tl::unexpected(pattern);
  }
  std::vector<std::size_t> numbers;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (wanted[i] != 0) numbers.push_back(i);
  }
  return numbers;
}

std::vector<std::string> states_in_rows(const Result& result) {
  return result.kept ? chosen(result.states, result.kept->states) : result.states;
}

std::vector<std::string> functions_in_rows(const Result& result) {
  return result.kept ? chosen(result.switching_functions, result.kept->switching_functions)
                     : result.switching_functions;
}

std::optional<std::size_t> column_of_state(const Result& result, std::size_t state) {
  if (!result.kept) return state;
  const auto& kept = result.kept->states;
  const auto place = std::lower_bound(kept.begin(), kept.end(), state);
  if (place == kept.end() || *place != state) return std::nullopt;
  return static_cast<std::size_t>(place - kept.begin());
}

void keep_columns(const KeptColumns& kept, Trajectory& trajectory) {
  trajectory.x.keep_columns(kept.states);
  trajectory.alpha.keep_columns(kept.switching_functions);
  trajectory.mode.keep_columns(kept.switching_functions);
}

Result as_in_rows(const Result& result) {
  Result view = result;
  if (!result.kept) return view;
  const auto& kept = *result.kept;
  view.kept.reset();
  choose(view.states, kept.states);
  choose(view.switching_functions, kept.switching_functions);
  choose(view.final.x, kept.states);
  choose(view.final.mode, kept.switching_functions), choose(view.final.alpha, kept.switching_functions);
  Events events;
  for (const auto& event : result.events) events.push_back(as_in_rows(event, kept));
  view.events = std::move(events);
  std::erase_if(view.surfaces, [&](const Surface& surface) {
    return std::any_of(surface.states.begin(), surface.states.end(),
                       [&](const std::string& name) { return !contains(view.states, name); });
  });
  for (auto& family : view.families) {
    choose(family.to.mode, kept.switching_functions), choose(family.to.alpha, kept.switching_functions);
  }
  if (view.sensitivities) {
    for (auto& row : view.sensitivities->x0) choose(row, kept.states);
    choose(view.sensitivities->x0, kept.states), choose(view.sensitivities->p, kept.states);
  }
  for (auto& branch : view.branches) branch = as_in_rows(branch);
  return view;
}

}  // namespace saltus::result
