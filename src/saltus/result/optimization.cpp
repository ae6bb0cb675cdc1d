#include "saltus/result/optimization.hpp"

#include <array>

namespace saltus::result {
namespace {

constexpr std::array phases{HomotopyPhase::relaxed, HomotopyPhase::branch, HomotopyPhase::lpcc};
constexpr std::array types{StationarityType::S, StationarityType::M, StationarityType::C, StationarityType::A,
                           StationarityType::W};

template <class Values>
auto value_named(const Values& values, std::string_view wanted) -> std::optional<typename Values::value_type> {
  for (const auto value : values) {
    if (name(value) == wanted) return value;
  }
  return std::nullopt;
}

}  // namespace

std::string_view name(HomotopyPhase phase) {
  switch (phase) {
    case HomotopyPhase::relaxed:
      return "relaxed";
    case HomotopyPhase::branch:
      return "branch";
    case HomotopyPhase::lpcc:
      return "lpcc";
  }
  __builtin_unreachable();
}

std::optional<HomotopyPhase> homotopy_phase_named(std::string_view name_of_one) {
  return value_named(phases, name_of_one);
}

std::string_view name(StationarityType type) {
  switch (type) {
    case StationarityType::S:
      return "S";
    case StationarityType::M:
      return "M";
    case StationarityType::C:
      return "C";
    case StationarityType::A:
      return "A";
    case StationarityType::W:
      return "W";
  }
  __builtin_unreachable();
}

std::optional<StationarityType> stationarity_type_named(std::string_view name_of_one) {
  return value_named(types, name_of_one);
}

}  // namespace saltus::result
