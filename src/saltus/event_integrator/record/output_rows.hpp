// Rows of the trajectory: at requested times, at ends of steps, and between them.
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "saltus/base/function_ref.hpp"
#include "saltus/event_integrator/field/mode_field.hpp"
#include "saltus/event_integrator/jumps/holding.hpp"
#include "saltus/event_integrator/mode/position.hpp"
#include "saltus/event_integrator/options.hpp"
#include "saltus/event_integrator/record/pieces.hpp"
#include "saltus/event_integrator/record/recorder.hpp"
#include "saltus/ode/straight_lines.hpp"

namespace saltus::event_integrator {

/// OutputRows knows which row is asked for next. A requested time gets its row once, before the position passes it.
class OutputRows {
 public:
  OutputRows(const evaluation::ModelKernel& kernel, const IntegrationOptions& options, const Position& here,
             ModeField& field, Holding& holding, Recorder& recorder);

  [[nodiscard]] bool at_steps() const { return options_.output.rows == OutputTimes::Rows::at_steps; }
  /// Writes a row in the mode of the position.
  void write(double t, const std::vector<double>& x);
  void write_here() { write(here_.t, here_.x); }
  /// Writes the row at the end of a step, if one is asked for.
  void write_end_of_step();
  /// Returns whether a row is asked for before a time.
  [[nodiscard]] bool any_before(double t) const { return next_ < times().size() && times()[next_] < t; }
  /// Calls write(t) for the requested times in (from, end), which are passed with that.
  template <class Write>
  void each_before(double from, double end, Write write) {
    for (; any_before(end); ++next_) {
      if (times()[next_] > from) write(times()[next_]);
    }
  }
  /// Does the same in (from, end].
  template <class Write>
  void each_until(double from, double end, Write write) {
    each_before(from, std::nextafter(end, std::numeric_limits<double>::infinity()), write);
  }
  /// Returns whether the inside of a step up to a time is asked for.
  [[nodiscard]] bool any_inside(double t) const { return pieces_ || any_before(t); }
  /// Keeps the step from the position up to a time, if steps are asked for.
  void keep(const ode::DenseStep& step, double end) {
    if (pieces_) pieces_->add(kernel_, here_, field_, holding_, recorder_.events(), step, end);
  }
  /// Leaves the inside of a step to be simulated again.
  void leave_open(double end) {
    if (pieces_) pieces_->leave_open(end);
  }
  /// Returns what has been kept from the first of some rows on; null if nothing was to be.
  [[nodiscard]] std::shared_ptr<const Pieces> take_pieces(const std::vector<double>& row_times);
  /// Writes rows from the position to `end` (not included) on a curve, which are put on the surfaces of the mode.
  void write_before(double end, FunctionRef<void(double t, double* x)> curve);
  /// Passes requested times up to the position.
  void skip_here() {
    each_until(here_.t, here_.t, [](double) {});
  }

  /// Says whether an event about to be recorded here has its row.
  enum class Arrival { written, missing };
  void arrive(Arrival row) { arrival_ = recorder_.rows() - (row == Arrival::written ? 1 : 0); }
  /// Returns the number of the row before the event.
  [[nodiscard]] std::size_t arrival() const { return arrival_; }

  [[nodiscard]] bool asks_for_lines() const { return lines_.has_value(); }
  /// Returns whether straight lines may be too far from the last attempt, without looking at it closely.
  [[nodiscard]] bool may_bend(const ode::Stepper& stepper);
  /// Writes rows before t_end that keep straight lines close to the dense output of the step from the position.
  void write_lines(double t_end, const ode::DenseStep& dense);
  /// Returns from when on rows were left out because there are very many.
  [[nodiscard]] std::optional<double> thinned_from() const { return thinned_from_; }

 private:
  /// Columns are states, inputs, outputs, selections.
  struct Lines {
    ode::ColumnRanges ranges;
    ode::StraightLines points = {};
    std::vector<double> tolerance = {}, low = {}, high = {};
  };

  [[nodiscard]] const std::vector<double>& times() const { return options_.output.times; }
  void write_on_surfaces(double t);
  [[nodiscard]] bool is_too_close(double t);
  void columns_at(double theta, const ode::DenseStep& dense, double* columns);

  const evaluation::ModelKernel& kernel_;
  const IntegrationOptions& options_;
  const Position& here_;
  ModeField& field_;
  Holding& holding_;
  Recorder& recorder_;
  std::size_t next_ = 0;
  std::size_t arrival_ = 0;
  std::vector<double> x_, slope_;  ///< of a row
  std::optional<Lines> lines_;
  std::optional<PieceLog> pieces_;
  std::optional<double> thinned_from_;
};

}  // namespace saltus::event_integrator
