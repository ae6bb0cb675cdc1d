#include "saltus/result/turned.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace saltus::result {
namespace {

/// 0 or 1, up to what a state has drifted while time stood still; else nothing.
std::optional<int> side_of(double value) {
  constexpr double drift = 1e-6;
  for (const int side : {0, 1}) {
    if (std::abs(value - side) < drift) return side;
  }
  return std::nullopt;
}

}  // namespace

std::optional<std::string_view> turned(const Event& event, const Result& result) {
  if (event.kind != EventKind::jump || !event.name) return std::nullopt;
  const auto& states = result.states;
  const auto found = std::find(states.begin(), states.end(), *event.name);
  const auto state = static_cast<std::size_t>(found - states.begin());
  if (found == states.end() || state >= std::min(event.x.size(), event.x_after.size())) return std::nullopt;
  if (state < result.final.x.size() && !side_of(result.final.x[state])) return std::nullopt;
  const auto before = side_of(event.x[state]), after = side_of(event.x_after[state]);
  if (!before || !after || *before == *after) return std::nullopt;
  return *after == 1 ? "on" : "off";
}

}  // namespace saltus::result
