// Rows and events of a run on their way to an observer.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "saltus/pipeline/simulate.hpp"
#include "saltus/result/result.hpp"

namespace saltus::pipeline {

/// Hands the parts of a run to Observers::on_part, and remembers what is known of them.
class PassingOn {
 public:
  /// @param frame  a result with the names of its columns
  /// @param times  of OutputTimes, where no rows are wanted at events; they must outlive this, as the observers must
  PassingOn(const Observers& observers, const result::Result& frame, const std::vector<double>* times);

  void take(result::Trajectory rows, result::Events events);
  /// Returns the last row, which is known as such only now; then what is known of all.
  [[nodiscard]] result::PassedOn end();

 private:
  void pass(result::Trajectory rows, result::Events events);
  void widen(std::span<const double> x);
  [[nodiscard]] result::Trajectory without_event_rows(const result::Trajectory& rows);

  const Observers& observers_;
  const std::vector<double>* times_;
  result::Result part_;
  result::PassedOn known_;
  result::Trajectory last_;  ///< without rows at events: the last one so far, of which it is not known whether it stays
};

}  // namespace saltus::pipeline
