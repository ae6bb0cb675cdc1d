// Options as what discretization, reformulation and evaluation know.
#pragma once

#include "saltus/discretization/fesd_options.hpp"
#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/pipeline/options/simulate_options.hpp"
#include "saltus/reformulation/reformulation_options.hpp"

namespace saltus::pipeline {

[[nodiscard]] reformulation::ReformulationOptions reformulation_options(const ElementOptions& options);
[[nodiscard]] discretization::FesdOptions fesd_options(const ElementOptions& wanted);
[[nodiscard]] evaluation::NativeCode native_code(Native native);

}  // namespace saltus::pipeline
