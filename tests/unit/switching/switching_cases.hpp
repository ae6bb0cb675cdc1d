// tests/data/switching_cases.json: projected fields with known outcomes.
#pragma once

#include <array>
#include <cstddef>
#include <fstream>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "plane_frames.hpp"
#include "source_folder.hpp"

namespace saltus::switching {

struct CaseOutcome {
  std::array<int, 2> mode{};
  std::array<double, 2> lambda{};  ///< of sliding surfaces: 2 alpha - 1; else the sign
};

struct SwitchingCase {
  std::string id, leaf, situation;
  Velocities f{};
  std::vector<CaseOutcome> expected;
  std::array<double, 2> lambda_event{};
  std::array<int, 2> incoming{};
  bool spiral_out = false;
  nlohmann::json all;  ///< with what is special to a situation
};

inline constexpr std::array<const char*, 4> corner_keys{"--", "+-", "-+", "++"};

inline nlohmann::json all_cases() {
  std::ifstream file(tests::source_folder("tests/data/switching_cases.json"));
  return nlohmann::json::parse(file)["cases"];
}

/// The cases of two surfaces.
inline std::vector<SwitchingCase> plane_cases() {
  std::vector<SwitchingCase> cases;
  const auto data = all_cases();
  for (const auto& item : data) {
    if (!item.contains("f2")) continue;
    SwitchingCase one{item["id"], item["leaf"], item["situation"], {}, {}, {}, {}, item.value("spiral_out", false),
                      item};
    for (std::size_t k = 0; k < 4; ++k) {
      one.f[0][k] = item["f1"][corner_keys[k]];
      one.f[1][k] = item["f2"][corner_keys[k]];
    }
    if (item.contains("incoming")) one.incoming = item["incoming"].get<std::array<int, 2>>();
    if (item.contains("lambda_event")) one.lambda_event = item["lambda_event"].get<std::array<double, 2>>();
    for (const auto& outcome : item["expected"]) {
      if (outcome["mode"].is_string()) continue;  // a spiral
      one.expected.push_back({outcome["mode"], outcome["lambda"]});
    }
    cases.push_back(std::move(one));
  }
  return cases;
}

}  // namespace saltus::switching
