#include "saltus/result/optimization.hpp"

#include "saltus/base/enum_names.hpp"

namespace saltus::result {
namespace {

constexpr EnumNames<HomotopyPhase::lpcc> homotopy_phases("relaxed", "branch", "lpcc");
constexpr EnumNames<StationarityType::W> stationarity_types("S", "M", "C", "A", "W");

}  // namespace

std::string_view name(HomotopyPhase phase) { return homotopy_phases(phase); }
std::optional<HomotopyPhase> homotopy_phase_named(std::string_view text) { return homotopy_phases.named(text); }

std::string_view name(StationarityType type) { return stationarity_types(type); }
std::optional<StationarityType> stationarity_type_named(std::string_view text) {
  return stationarity_types.named(text);
}

}  // namespace saltus::result
