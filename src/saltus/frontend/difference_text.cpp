#include "saltus/frontend/difference_text.hpp"

#include <algorithm>
#include <string_view>
#include <vector>

#include <fmt/format.h>

namespace saltus::frontend {
namespace {

std::string numbers_text(std::string_view title, const std::vector<result::NumberDifference>& numbers) {
  if (numbers.empty()) return "";
  std::string text = fmt::format("{}\n", title);
  for (const auto& [what, a, b] : numbers) {
    text += fmt::format("  {:<20} {:>22.15g} {:>22.15g}   difference {:.3g}\n", what, a, b, b - a);
  }
  return text;
}

}  // namespace

std::string difference_text(const result::Difference& difference, const result::Tolerances& tolerances,
                            std::size_t states_of_model) {
  std::string text = numbers_text("parameters", difference.parameters);
  if (!difference.ends.empty()) text += fmt::format("the runs ended differently: {}\n", difference.ends);
  text += numbers_text("at the end", difference.end_state) + numbers_text("on the way", difference.rows);
  if (difference.events_a != difference.events_b) {
    text += fmt::format("numbers of events: {} and {}\n", difference.events_a, difference.events_b);
  }
  if (!difference.first_event.empty()) text += fmt::format("first event that differs: {}\n", difference.first_event);
  const auto& [rtol, atol] = tolerances;
  const auto absolute = atol ? fmt::format("atol {:g}", *atol) : fmt::format("atol {:g} of each range", rtol);
  const auto states = difference.common_states == states_of_model
                          ? "states"
                          : fmt::format("{} of {} states", difference.common_states, states_of_model);
  const auto between = difference.between_times == 0
                           ? ""
                           : fmt::format(" and, to 0.2 % of the range, at {} between rows", difference.between_times);
  return text + fmt::format("{} to rtol {:g}, {} (compared: {} events, {} at {} common times{})\n",
                            difference.is_none() ? "the same" : "different", rtol, absolute,
                            std::min(difference.events_a, difference.events_b), states, difference.common_times,
                            between);
}

}  // namespace saltus::frontend
