#include "problems/consistency.hpp"

#include <algorithm>
#include <vector>

namespace saltus::problems {
namespace {

using result::Event;
using result::Result;

bool shares_a_surface(const Event& a, const Event& b) {
  return std::any_of(a.surfaces.begin(), a.surfaces.end(), [&](const std::string& surface) {
    return std::find(b.surfaces.begin(), b.surfaces.end(), surface) != b.surfaces.end();
  });
}

}  // namespace

std::string complaint(const Result& result) {
  if (result.status.termination != result::Termination::completed) return result.status.message;
  const std::vector<Event>& events = result.events;
  for (std::size_t i = 0; i + 1 < events.size(); ++i) {
    const Event &a = events[i], &b = events[i + 1];
    const std::string where = "events " + std::to_string(i + 1) + " and " + std::to_string(i + 2);
    if (!a.mode_after || !b.mode_before) return where + ": a mode is missing";
    if (*a.mode_after != *b.mode_before) return where + ": the mode changes between events";
    if (b.t < a.t) return where + ": not in order of time";
    if (b.t == a.t && shares_a_surface(a, b)) return where + ": the same surface twice at one time";
    if (a.mode_before && b.t - a.t < instant && *a.mode_before == *b.mode_after) return where + ": there and back";
  }
  return "";
}

}  // namespace saltus::problems
