// A model whose [optimize] the tests write.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "saltus/io/toml/toml_model.hpp"

namespace saltus::io {

inline constexpr std::string_view optimize_head =
    "[model]\nname = 'm'\n[parameters]\nk = { initial = 1, lower = 0.1, upper = 5, free = true, unit = 'N', label = "
    "'k' }\n"
    "[states]\nq = { initial = 0, lower = -1, upper = 1, free = true }\nv = 0\ntau = 0\n"
    "[controls]\nu = { lower = -5, upper = 5 }\n[dynamics]\nq = 'v'\nv = 'u - sign(v)'\ntau = 1\n";
inline constexpr int head_lines = 14;

inline const std::string smallest = "[optimize]\nhorizon = 5\ncontrol_intervals = 4\n";

inline Expected<ModelFile> parsed(const std::string& rest) {
  return parse_model(std::string(optimize_head) + rest, "m.toml");
}

/// The file of the test, in a folder of its own.
inline std::string written(const std::string& name, const std::string& text) {
  const auto folder = std::filesystem::path(testing::TempDir()) / "saltus-toml-optimize";
  std::filesystem::create_directories(folder);
  std::ofstream(folder / name) << text;
  return (folder / name).string();
}

}  // namespace saltus::io
