// The stages of explicit Runge-Kutta steps in C, with the model's right-hand side inside.
#pragma once

#include <string>

#include "saltus/evaluation/native_steps.hpp"

namespace saltus::evaluation {

/// Holds names of the functions that the sources below define; each of type ode::StagesFunction.
struct StagesNames {
  std::string dopri5, dop853;
};
inline const StagesNames field_stages{"saltus_dopri5", "saltus_dop853"};
inline const StagesNames sliding_stages{"saltus_sliding_dopri5", "saltus_sliding_dop853"};

/// Returns C code of the stages of both explicit methods, for n >= 1 states: along the field, whose data are its
/// constants, and along the sliding motion of SlidingConstants. `field` is the name of a function as DirectField,
/// defined before.
[[nodiscard]] std::string field_stages_source(const std::string& field, int n);
[[nodiscard]] std::string sliding_stages_source(const std::string& field, int n);

}  // namespace saltus::evaluation
