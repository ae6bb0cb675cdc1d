// Which rows of the trajectory are written between the ends of elements.
#pragma once

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "saltus/fesd_integrator/element/element_piece.hpp"
#include "saltus/fesd_integrator/record/recorder.hpp"
#include "saltus/fesd_integrator/run/context_internal.hpp"
#include "saltus/fesd_integrator/run/element_interior_internal.hpp"
#include "saltus/fesd_integrator/run/position_internal.hpp"
#include "saltus/ode/straight_lines.hpp"

namespace saltus::fesd_integrator {

/// Writes rows at the times (or values of a clock) that were asked for, or at ends of elements. With `straight` it adds
/// times inside them that keep straight lines close. Every time is emitted once, in ascending order.
class OutputRows {
 public:
  /// All must outlive it.
  OutputRows(const RunContext& context, const Position& position, ElementInterior& interior, Recorder& recorder)
      : context_(context), position_(position), interior_(interior), recorder_(recorder) {}

  /// Chooses, before rows of an element, times inside it where `straight` asks for them.
  void begin_element(const Element& element, const std::vector<double>& selections);
  /// Writes rows inside an element, up to a time.
  void emit(const Element& element, const std::vector<double>& selections, double until);
  /// Writes the row at the position, unless an event has put it there.
  void emit_here();
  /// Returns the elements that have been emitted, if they were asked for.
  [[nodiscard]] std::vector<ElementPiece> take_pieces() { return std::move(pieces_); }
  /// Gives times between the position and a time the row of the position.
  void pass(double until);

 private:
  void keep(const Element& element, const std::vector<double>& selections, double until);
  void emit_clock_times(const Element& element, const std::vector<double>& selections, double until);
  /// Time inside an element at which the clock has this value, from theta to `last`, where it has `end`.
  [[nodiscard]] double theta_of(double value, const Element& element, const std::vector<double>& selections,
                                double last, double end);
  [[nodiscard]] double clock_at(const Element& element, const std::vector<double>& selections, double theta);
  void columns_at(const Element& element, const std::vector<double>& selections, double theta, double* columns);
  void row_inside(double t);
  [[nodiscard]] bool at_times() const { return context_.options.rows == IntegrationOptions::Rows::at_times; }

  const RunContext& context_;
  const Position& position_;
  ElementInterior& interior_;
  Recorder& recorder_;
  std::size_t next_ = 0;  ///< in the times asked for, or in chosen_
  std::optional<ode::ColumnRanges> ranges_;
  ode::StraightLines lines_;
  std::vector<double> chosen_, tolerance_;
  std::vector<ElementPiece> pieces_;  ///< up to a gigabyte of numbers
  std::size_t numbers_ = 0;
};

}  // namespace saltus::fesd_integrator
