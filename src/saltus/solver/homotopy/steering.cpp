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

}  // namespace saltus::solver::homotopy
