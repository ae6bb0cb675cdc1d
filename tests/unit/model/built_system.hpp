// Systems that are stated in C++, for tests.
#pragma once

#include <gtest/gtest.h>

#include "saltus/base/error.hpp"
#include "saltus/model/builder.hpp"
#include "saltus/model/system.hpp"

namespace saltus::model {

/// The system of a builder, which must be right.
inline System finished(Builder& builder) {
  auto system = builder.build();
  EXPECT_TRUE(system.has_value()) << (system ? "" : to_text(system.error()));
  return system ? *system : System{};
}

}  // namespace saltus::model
