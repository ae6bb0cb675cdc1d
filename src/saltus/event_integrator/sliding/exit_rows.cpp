#include "saltus/event_integrator/sliding/exit_rows.hpp"

#include <algorithm>
#include <cstddef>

#include "saltus/base/at.hpp"

namespace saltus::event_integrator {

const evaluation::AffineRow* ExitRows::of(int surface, double side, const evaluation::FixedState& fixed,
                                          const std::vector<double>& alpha, Rows rows) {
  known_.resize(2 * at(kernel_.switching_functions()));
  auto& [entries, oldest] = known_[2 * at(surface) + (side == 0.0 ? 0 : 1)];
  if (rows == Rows::changing) entries.clear();
  const auto& neighbours = kernel_.neighbours(surface);
  const auto is_same = [&](const Entry& entry) {
    const auto has_selection = [&](double beside, int other) { return beside == alpha[at(other)]; };
    return entry.motion == kernel_.motion() && entry.fixed.component == fixed.component &&
           entry.fixed.value == fixed.value &&
           std::equal(entry.beside.begin(), entry.beside.end(), neighbours.begin(), has_selection);
  };
  auto entry = std::find_if(entries.begin(), entries.end(), is_same);
  if (entry == entries.end()) {
    constexpr std::size_t most = 4;  // solutions come back to their modes
    const bool is_full = entries.size() == most;
    entry = is_full ? entries.begin() + index(oldest++ % most) : entries.emplace(entries.end());
    entry->motion = kernel_.motion();
    entry->fixed = fixed;
    entry->beside.clear();
    for (const int other : neighbours) entry->beside.push_back(alpha[at(other)]);
    alpha_ = alpha;
    alpha_[at(surface)] = side;
    entry->is_row = kernel_.lie_row(surface, fixed, alpha_.data(), entry->row);
  }
  return entry->is_row ? &entry->row : nullptr;
}

}  // namespace saltus::event_integrator
