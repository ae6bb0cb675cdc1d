// MODEL and --set of the command line -> model file with the settings applied.
#pragma once

#include <string>
#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/io/toml_model.hpp"
#include "saltus/model/description.hpp"

namespace saltus::cli {

struct ModelInput {
  std::string path;
  io::ModelFile file;
  std::vector<model::Override> overrides;
};

/// @param model     path or catalogue name
/// @param settings  NAME=VALUE each; dotted names reach any key of the file, others replace a parameter, an initial
///                  value or a control's constant value
[[nodiscard]] Expected<ModelInput> read_input(const std::string& model, const std::vector<std::string>& settings);

}  // namespace saltus::cli
