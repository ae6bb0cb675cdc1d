// tests/data/switching_cases.json: projected fields with known outcomes; and the symmetries of the square, written out.
#pragma once

#include <array>
#include <cstddef>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

namespace saltus::switching {

using Velocities = std::array<std::array<double, 4>, 2>;

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
  std::ifstream file(std::string(SALTUS_SOURCE_DIR) + "/tests/data/switching_cases.json");
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

/// Reflects psi_1, psi_2, and exchanges them, in this order.
struct Relabelling {
  bool reflect_1, reflect_2, exchange;

  explicit Relabelling(unsigned i) : reflect_1((i & 1U) != 0), reflect_2((i & 2U) != 0), exchange((i & 4U) != 0) {}

  template <class T>
  [[nodiscard]] std::array<T, 2> signs(std::array<T, 2> k) const {
    if (reflect_1) k[0] = -k[0];
    if (reflect_2) k[1] = -k[1];
    if (exchange) std::swap(k[0], k[1]);
    return k;
  }

  [[nodiscard]] Velocities fields(const Velocities& f) const {
    Velocities image{};
    for (const int k1 : {-1, 1}) {
      for (const int k2 : {-1, 1}) {
        const auto corner = [](std::array<int, 2> k) { return (k[0] > 0 ? 1U : 0U) + (k[1] > 0 ? 2U : 0U); };
        const std::size_t from = corner({k1, k2});
        const auto vector = signs(std::array<double, 2>{f[0][from], f[1][from]});
        const std::size_t to = corner(signs(std::array<int, 2>{k1, k2}));
        for (std::size_t j = 0; j < 2; ++j) image[j][to] = vector[j];
      }
    }
    return image;
  }
};

}  // namespace saltus::switching
