// A result against its reference, event by event.
#pragma once

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "problems/references.hpp"
#include "saltus/result/result.hpp"

namespace saltus::problems {

// Relative above 1: the states of the catalogue are of order one, the times reach 1000 (irma), where an error of the
// state of order atol moves an event by atol divided by a speed of 1e-3 and less.
inline void expect_near(double found, double reference, double tolerance, const std::string& what) {
  if (std::isnan(reference)) {
    EXPECT_TRUE(std::isnan(found)) << what;
  } else {
    EXPECT_NEAR(found, reference, tolerance * std::max(1.0, std::abs(reference))) << what;
  }
}

inline void expect_near(const std::vector<double>& found, const std::vector<double>& reference, double tolerance,
                        const std::string& what) {
  ASSERT_EQ(found.size(), reference.size()) << what;
  for (std::size_t i = 0; i < found.size(); ++i) {
    expect_near(found[i], reference[i], tolerance, what + ", component " + std::to_string(i + 1));
  }
}

inline void expect_alternatives(const result::Event& event, const ReferenceEvent& reference, const std::string& what) {
  EXPECT_EQ(event.unique, reference.unique) << what;
  std::set<std::vector<int>> found, expected;
  for (const result::Alternative& other : event.alternatives) found.insert(other.mode);
  for (const ReferenceAlternative& other : reference.alternatives) expected.insert(other.mode);
  EXPECT_EQ(found, expected) << what;
  EXPECT_EQ(event.alternatives.size(), reference.alternatives.size()) << what;
}

inline void expect_event(const result::Event& event, const ReferenceEvent& reference, double tolerance,
                         const std::string& what) {
  EXPECT_EQ(std::string(result::name(event.kind)), reference.kind) << what;
  EXPECT_EQ(event.surfaces, reference.surfaces) << what;
  EXPECT_EQ(event.mode_before, reference.mode_before) << what;
  ASSERT_TRUE(event.mode_after.has_value()) << what;
  EXPECT_EQ(*event.mode_after, reference.mode_after) << what;
  EXPECT_EQ(event.regions_after, reference.regions_after) << what;
  EXPECT_FALSE(event.reason.empty()) << what;
  expect_near(event.t, reference.t, tolerance, what + ", time");
  expect_near(event.x, reference.x, tolerance, what + ", state");
  expect_near(event.x_after, reference.x_after, tolerance, what + ", state behind");
  // Contacts put the state on closed gaps and velocities of sticking ones on 0.
  const bool moves_nothing = event.kind != result::EventKind::jump && event.kind != result::EventKind::accumulation &&
                             event.contact_modes_after.empty();
  if (moves_nothing) {
    EXPECT_EQ(event.x, event.x_after) << what;
  }
  expect_alternatives(event, reference, what);
}

inline void expect_reference(const result::Result& result, const ReferenceProblem& problem, double tolerance) {
  ASSERT_EQ(result.status.termination, result::Termination::completed) << result.status.message;
  ASSERT_EQ(result.events.size(), problem.events.size());
  for (std::size_t i = 0; i < problem.events.size(); ++i) {
    expect_event(result.events[i], problem.events[i], tolerance, "event " + std::to_string(i + 1));
  }
  EXPECT_EQ(result.final.t, problem.until);
  EXPECT_EQ(result.final.mode, problem.final_mode);
  expect_near(result.final.x, problem.final_x, tolerance, "end state");
  expect_near(result.final.alpha, problem.final_alpha, tolerance, "alpha at the end");
  expect_near(result.final.theta, problem.final_theta, tolerance, "theta at the end");
}

}  // namespace saltus::problems
