// Shipped models of any size: their files are written, not stored.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "saltus/base/error.hpp"

namespace saltus::frontend {

/// Holds what a number of a sized model is called, and its value where none is given.
struct ModelSize {
  std::string name;
  std::int64_t value = 0;
};

using ModelSizes = std::map<std::string, std::int64_t>;

/// Describes a model whose file is written for the sizes that are asked for.
struct SizedModel {
  std::string name;
  std::string description;
  std::vector<ModelSize> sizes;  ///< the first one is the number of parts
  std::string (*write)(std::int64_t parts, std::int64_t seed);
};

/// Returns all of them, by name.
[[nodiscard]] const std::vector<SizedModel>& sized_models();

/// Returns the one of this name; nullptr if there is none.
[[nodiscard]] const SizedModel* find_sized_model(const std::string& name);

/// Returns the text of the model file: the same on every machine. Cost: linear in the number of parts.
/// @return unknown_name for a size that the model does not have, invalid_option for one out of range.
[[nodiscard]] Expected<std::string> write_sized_model(const SizedModel& model, const ModelSizes& sizes);

/// Returns what to write for a sized model where a file is wanted.
[[nodiscard]] std::string how_to_write(const SizedModel& model);

}  // namespace saltus::frontend
