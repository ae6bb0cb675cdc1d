#include "saltus/event_integrator/field/field_memory.hpp"

#include <algorithm>
#include <cstring>

namespace saltus::event_integrator {

const evaluation::FieldConstants& FieldMemory::of(const std::vector<double>& alpha, std::size_t mark) {
  const auto is_it = [&](std::size_t place) {
    const auto& known = constants_[place].alpha;
    return marks_[place] == mark && known.size() == alpha.size() &&
           std::memcmp(known.data(), alpha.data(), alpha.size() * sizeof(double)) == 0;
  };
  std::size_t place = 0;
  while (place < used_ && !is_it(place)) ++place;
  const bool known = place < used_;
  if (!known) {
    place = next_ == last_ ? (next_ + 1) % capacity : next_;
    next_ = (place + 1) % capacity;
    used_ = std::max(used_, place + 1);
    marks_[place] = mark;
  }
  last_ = place;
  // Once there is native code the constants say so.
  auto& constants = constants_[place];
  const bool holds = known && constants.direct != nullptr && constants.motion == constants.use->motion;
  if (!holds) kernel_.prepare_field(alpha.data(), constants);
  return constants;
}

}  // namespace saltus::event_integrator
