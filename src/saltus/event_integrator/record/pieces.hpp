// What a run leaves of its steps: their polynomials, and the modes that they are in.
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

#include "saltus/event_integrator/field/mode_field.hpp"
#include "saltus/event_integrator/jumps/holding.hpp"
#include "saltus/event_integrator/mode/position.hpp"
#include "saltus/ode/stepper.hpp"

namespace saltus::event_integrator {

/// Holds what field, selections and projections are made from in a part of a run, beside (t, x).
struct PieceMode {
  ModeState state;
  std::vector<double> start;  ///< ModeField::start()
  std::vector<HeldGuard> held;
  std::vector<long> cells;
  /// Where it begins, while it slides: which of several roots it is on follows from there.
  double t = 0.0;
  std::vector<double> x;
};

/// Holds a step, or the part of it up to an event.
struct Piece {
  ode::DenseStep step;
  double end = 0.0;
  std::size_t mode = 0;  ///< number in Pieces::modes
};

/// Holds pieces in their order. Between them are gaps where the solution was not a polynomial.
struct Pieces {
  std::vector<Piece> list;
  std::vector<PieceMode> modes;

  /// Returns the piece that a time lies in, its end not included; null in a gap.
  [[nodiscard]] const Piece* find(double t) const {
    const auto behind = std::upper_bound(list.begin(), list.end(), t,
                                         [](double time, const Piece& piece) { return time < piece.step.t; });
    if (behind == list.begin() || !(t < (behind - 1)->end)) return nullptr;
    return &*(behind - 1);
  }
};

/// Collects the pieces of a run, up to a gigabyte of numbers; what comes behind is left open.
class PieceLog {
 public:
  explicit PieceLog(ode::Method method) : numbers_per_state_(static_cast<std::size_t>(ode::dense_degree(method)) + 2) {}

  /// Adds the step from the position up to a time, unless it is left open.
  /// @param events  recorded so far
  void add(const evaluation::ModelKernel& kernel, const Position& here, const ModeField& field, const Holding& holding,
           long events, const ode::DenseStep& step, double end);
  /// Leaves what comes before a time to be simulated again.
  void leave_open(double until) { open_until_ = until; }
  /// Returns the pieces from a time on.
  [[nodiscard]] Pieces take_from(double begin);

 private:
  [[nodiscard]] std::size_t number_of(PieceMode mode, long events);

  static constexpr std::size_t most_numbers = std::size_t{1} << 27U;
  std::size_t numbers_per_state_;  ///< of a step
  std::size_t numbers_ = 0;
  Pieces pieces_;
  double open_until_ = -std::numeric_limits<double>::infinity();
  long events_ = -1;  ///< before the last mode
};

}  // namespace saltus::event_integrator
