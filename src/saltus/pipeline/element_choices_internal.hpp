// The options of elements as what discretization and reformulation know.
#pragma once

#include "saltus/discretization/fesd_options.hpp"
#include "saltus/pipeline/options/simulate_options.hpp"
#include "saltus/reformulation/reformulation_options.hpp"

namespace saltus::pipeline {

[[nodiscard]] reformulation::ReformulationOptions reformulation_options(const ElementOptions& options);
[[nodiscard]] discretization::FesdOptions fesd_options(const ElementOptions& wanted);

}  // namespace saltus::pipeline
