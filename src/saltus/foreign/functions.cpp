#include <array>

#include "saltus/foreign/functions_internal.hpp"

namespace saltus::foreign {

CachedFunction::CachedFunction(const std::string& name, const casadi::SX& w, const casadi::SX& first,
                               const casadi::SX& second)
    : function_(name, {w}, {first, second}), first_(first.numel()), second_(second.numel()) {}

void CachedFunction::at(mpcc::ConstVectorView w) {
  if (w_.size() == w.size() && w_ == w) return;
  w_ = w;
  function_(std::array<const double*, 1>{w_.data()}, std::array<double*, 2>{first_.data(), second_.data()});
}

}  // namespace saltus::foreign
