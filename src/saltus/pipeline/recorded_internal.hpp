// Options read back from their record.
#pragma once

#include <optional>
#include <string>
#include <variant>

#include "saltus/result/result.hpp"

namespace saltus::pipeline {

/// Returns the value in force of a word or a number; nullopt if there is none of that key (below [simulate]) and type.
template <class Value>
[[nodiscard]] std::optional<Value> recorded(const result::OptionRecord& record, const std::string& key) {
  for (const auto& [name, value] : record) {
    if (const auto* found = std::get_if<Value>(&value); name == "simulate." + key && found != nullptr) return *found;
  }
  return std::nullopt;
}

}  // namespace saltus::pipeline
