#include "saltus/event_integrator/record/pieces.hpp"

#include <utility>

#include "saltus/base/at.hpp"

namespace saltus::event_integrator {
namespace {

bool equal(const std::vector<HeldGuard>& a, const std::vector<HeldGuard>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const HeldGuard& one, const HeldGuard& other) {
    return one.hold.jump == other.hold.jump && one.hold.function == other.hold.function;
  });
}

/// But for where they begin.
bool equal(const PieceMode& a, const PieceMode& b) {
  return a.state.mode == b.state.mode && a.state.alpha == b.state.alpha && a.state.sliding == b.state.sliding &&
         (a.state.sliding.size() != 1 || a.state.corner_alpha == b.state.corner_alpha) &&
         a.state.higher == b.state.higher && a.state.resting == b.state.resting &&
         a.state.activities == b.state.activities && a.start == b.start && a.cells == b.cells && equal(a.held, b.held);
}

}  // namespace

/// Without sliding a mode is what it is, whenever it begins: of the last ones each is kept once.
std::size_t PieceLog::number_of(PieceMode mode, long events) {
  auto& modes = pieces_.modes;
  constexpr std::size_t remembered = 8;
  const bool slides = !mode.state.sliding.empty();
  const std::size_t lookups = !slides                               ? std::min(remembered, modes.size())
                              : !modes.empty() && events == events_ ? 1
                                                                    : 0;
  for (std::size_t k = 1; k <= lookups; ++k) {
    if (equal(modes[modes.size() - k], mode)) return modes.size() - k;
  }
  if (!slides) mode.x.clear();
  numbers_ += 3 * mode.state.mode.size() + mode.cells.size() + mode.x.size();
  modes.push_back(std::move(mode));
  events_ = events;
  return modes.size() - 1;
}

void PieceLog::add(const evaluation::ModelKernel& kernel, const Position& here, const ModeField& field,
                   const Holding& holding, long events, const ode::DenseStep& step, double end) {
  numbers_ += numbers_per_state_ * here.x.size();
  if (here.t < open_until_ || !(here.t < end) || numbers_ > most_numbers) return;
  PieceMode mode{here.state, field.start(), holding.guards(), {}, here.t, here.x};
  for (int c = 0; c < kernel.cells(); ++c) mode.cells.push_back(kernel.cell(c));
  const std::size_t number = number_of(std::move(mode), events);
  pieces_.list.push_back({step, end, number});
}

Pieces PieceLog::take_from(double begin) {
  std::erase_if(pieces_.list, [&](const Piece& piece) { return piece.end <= begin; });
  return std::move(pieces_);
}

}  // namespace saltus::event_integrator
