#include "saltus/solver/homotopy/steering.hpp"

#include "saltus/base/enum_names.hpp"

namespace saltus::solver::homotopy {
namespace {

constexpr EnumNames<Steering::linf> steerings("direct", "l1", "linf");

}  // namespace

std::string_view name(Steering steering) { return steerings(steering); }

}  // namespace saltus::solver::homotopy
