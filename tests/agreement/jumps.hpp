// Models with jumps, stated in the tests.
#pragma once

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "problems/simulator.hpp"

namespace saltus::problems {

using result::Event;
using result::EventKind;
using result::Result;
using result::Termination;

/// A model file without its table [model].
inline Result simulated(const std::string& text, const Accuracy& accuracy = fine) {
  return simulate_text("[model]\nname = \"jumps\"\n" + text, accuracy);
}

inline std::vector<Event> jumps_of(const Result& result, const std::string& name = "") {
  std::vector<Event> found;
  for (const auto& event : result.events) {
    if (event.kind == EventKind::jump && (name.empty() || event.name == name)) found.push_back(event);
  }
  return found;
}

inline void expect_times(const std::vector<Event>& events, const std::vector<double>& times, double tolerance) {
  ASSERT_EQ(events.size(), times.size());
  for (std::size_t i = 0; i < times.size(); ++i) EXPECT_NEAR(events[i].t, times[i], tolerance) << "event " << i + 1;
}

/// A clock and two counters.
inline constexpr const char* counter = R"toml(
[states]
x = 0
n = 0
a = 0
[dynamics]
x = "1"
n = "0"
a = "0"
)toml";

inline std::vector<Event> limits_of(const Result& result) {
  std::vector<Event> found;
  for (const auto& event : result.events) {
    if (event.kind == EventKind::accumulation) found.push_back(event);
  }
  return found;
}

/// Falls from y = 10 with gravity 9.8.
inline std::string ball(const std::string& restitution, double until) {
  return "[parameters]\ne = " + restitution + R"toml(
[states]
y = 10
v = 0
[dynamics]
y = "v"
v = "-9.8"
[[jumps]]
name = "bounce"
when = "y"
direction = "down"
set = { v = "-e*v" }
[simulate]
until = )toml" +
         std::to_string(until) + "\n";
}

}  // namespace saltus::problems
