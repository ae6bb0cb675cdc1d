// Rows and events of a run on their way to an observer.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "saltus/pipeline/simulate.hpp"
#include "saltus/pipeline/simulate/output_rows_internal.hpp"
#include "saltus/result/result.hpp"

namespace saltus::pipeline {

/// Hands the parts of a run to Observers::on_part, and remembers what is known of them.
class PassingOn {
 public:
  /// @param frame  a result with the names of its columns
  /// @param observers  must outlive this
  /// @param wanted     where no rows are wanted at events
  PassingOn(const Observers& observers, const result::Result& frame, std::optional<WantedRows> wanted);

  void take(result::Trajectory rows, result::Events events);
  /// Returns the last row, which is known as such only now; then what is known of all.
  [[nodiscard]] result::PassedOn end();

 private:
  void pass(result::Trajectory rows, result::Events events);
  void widen(std::span<const double> x);
  [[nodiscard]] result::Trajectory without_event_rows(const result::Trajectory& rows);

  const Observers& observers_;
  std::optional<WantedRows> wanted_;
  result::Result part_;
  result::PassedOn known_;
  result::Trajectory last_;  ///< without rows at events: the last one so far, of which it is not known whether it stays
};

}  // namespace saltus::pipeline
