// Two ways to one decision.
#pragma once

#include <gtest/gtest.h>

#include "saltus/event_integrator/decide/transition.hpp"

namespace saltus::event_integrator {

inline void expect_same(const Transition& one, const Transition& other) {
  EXPECT_EQ(one.termination, other.termination);
  EXPECT_EQ(one.state.mode, other.state.mode);
  EXPECT_EQ(one.state.alpha, other.state.alpha);
  EXPECT_EQ(one.state.sliding, other.state.sliding);
  if (!one.state.sliding.empty()) {
    EXPECT_EQ(one.state.corner_alpha, other.state.corner_alpha);
  }
  EXPECT_EQ(one.zero_order, other.zero_order);
  EXPECT_EQ(one.unique, other.unique);
  EXPECT_EQ(one.other_choices.size(), other.other_choices.size());
  EXPECT_EQ(one.reason, other.reason);
  ASSERT_EQ(one.meeting.has_value(), other.meeting.has_value());
  if (!one.meeting) return;
  EXPECT_EQ(one.meeting->surfaces, other.meeting->surfaces);
  EXPECT_EQ(one.meeting->velocities, other.meeting->velocities);
  EXPECT_EQ(one.meeting->alpha, other.meeting->alpha);
}

}  // namespace saltus::event_integrator
