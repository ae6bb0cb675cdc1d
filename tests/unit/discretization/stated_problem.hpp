// A problem of optimal control from the text of its model.
#pragma once

#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "saltus/io/toml/toml_model.hpp"
#include "saltus/model/ocp.hpp"
#include "saltus/pipeline/optimal_control/ocp_problem.hpp"

namespace saltus::discretization {

inline pipeline::StatedProblem stated_problem(const std::string& text) {
  auto file = io::parse_model(text, "model.toml");
  EXPECT_TRUE(file) << (file ? "" : to_text(file.error()));
  auto ocp = model::build_ocp(file->description);
  EXPECT_TRUE(ocp) << (ocp ? "" : to_text(ocp.error()));
  auto stated = pipeline::state_problem(*ocp, *file->optimize);
  EXPECT_TRUE(stated) << (stated ? "" : to_text(stated.error()));
  return std::move(*stated);
}

}  // namespace saltus::discretization
