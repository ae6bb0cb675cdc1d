// In which cells the arguments of floor, tables and sampled inputs are, and how they move on.
#pragma once

#include <vector>

#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/event_integrator/search/event_search.hpp"

namespace saltus::event_integrator {

/// Says what a move of cells does to the model at that point.
enum class CellChange {
  none,
  kink,  ///< fields and switching functions are continuous, their derivatives are not
  jump,  ///< values jump: all signs are read anew
};

/// Keeps the kernel's cells where the solution is. "In this cell" is a mode, like being on a surface: it changes where
/// an event function says so, never because a rounded value lies on the other side of a break.
class Cells {
 public:
  explicit Cells(evaluation::ModelKernel& kernel);

  [[nodiscard]] bool empty() const { return index_.empty(); }

  /// Puts every cell where its argument is: at a break (to rounding) the one it moves into along the field with these
  /// selections. For starts, and behind jumps of the state.
  CellChange locate(double t, const double* x, const std::vector<double>& alpha);
  /// Moves the cells whose ends were reached, and those whose arguments jump with them.
  CellChange leave(const std::vector<EventFunction>& functions, const std::vector<std::size_t>& reached, double t,
                   const double* x, const std::vector<double>& alpha);

  /// Returns whether an end of a cell is reached to rounding, and values jump there.
  [[nodiscard]] bool jumps_at(const EventFunction& end, double t, const double* x, const std::vector<double>& alpha);

  /// Returns whether some argument was undefined when it was looked at; locate_undefined() looks at those again.
  [[nodiscard]] bool any_undefined() const;
  CellChange locate_undefined(double t, const double* x, const std::vector<double>& alpha);

  /// Returns the cells of all arguments, to be put back for a look at the time before.
  [[nodiscard]] const std::vector<long>& indices() const { return index_; }
  void put(const std::vector<long>& indices);

  /// Returns whether a function holds constants of a cell that moved last.
  [[nodiscard]] bool moved_in(int function) const;
  /// Returns the names of the cells that moved last and jump, joined by commas.
  [[nodiscard]] std::string moved_names(const model::Layout& layout) const;

 private:
  CellChange place(int cell, double t, const double* x, const std::vector<double>& alpha);
  CellChange move(int cell, long target);

  evaluation::ModelKernel& kernel_;
  std::vector<long> index_;
  std::vector<bool> moved_;
  std::vector<bool> undefined_;
  std::vector<double> magnitude_, slope_;
};

/// Returns whether an event function is an end of a cell.
[[nodiscard]] inline bool is_cell_end(FunctionKind kind) {
  return kind == FunctionKind::cell_upper || kind == FunctionKind::cell_lower;
}

/// Returns, for n_psi switching functions, 1 where one that is not in the mode vanishes at (t, x) to rounding, else 0:
/// zeros that are history for what starts here.
[[nodiscard]] std::vector<int> zeros_at(const evaluation::ModelKernel& kernel, const ModeState& state, double t,
                                        const double* x);

}  // namespace saltus::event_integrator
