#include "saltus/solver/homotopy/steering.hpp"

namespace saltus::solver::homotopy {

std::string_view name(Steering steering) {
  switch (steering) {
    case Steering::direct:
      return "direct";
    case Steering::l1:
      return "l1";
    case Steering::linf:
      return "linf";
  }
  return {};
}

std::optional<Steering> steering_named(std::string_view name_of_one) {
  for (const Steering steering : all_steerings) {
    if (name(steering) == name_of_one) return steering;
  }
  return std::nullopt;
}

}  // namespace saltus::solver::homotopy
