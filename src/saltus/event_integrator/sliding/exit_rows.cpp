#include "saltus/event_integrator/sliding/exit_rows.hpp"

#include "saltus/base/at.hpp"

namespace saltus::event_integrator {

const evaluation::AffineRow* ExitRows::of(int surface, double side, evaluation::FixedState fixed,
                                          const std::vector<double>& alpha) {
  entries_.resize(2 * at(kernel_.switching_functions()));
  Entry& entry = entries_[2 * at(surface) + (side == 0.0 ? 0 : 1)];
  const auto& neighbours = kernel_.neighbours(surface);
  bool same =
      entry.motion == kernel_.motion() && entry.fixed.component == fixed.component && entry.fixed.value == fixed.value;
  for (std::size_t k = 0; same && k < neighbours.size(); ++k) same = entry.beside[k] == alpha[at(neighbours[k])];
  if (!same) {
    entry.motion = kernel_.motion();
    entry.fixed = fixed;
    entry.beside.clear();
    for (const int other : neighbours) entry.beside.push_back(alpha[at(other)]);
    alpha_ = alpha;
    alpha_[at(surface)] = side;
    entry.is_row = kernel_.lie_row(surface, fixed, alpha_.data(), entry.row);
  }
  return entry.is_row ? &entry.row : nullptr;
}

}  // namespace saltus::event_integrator
