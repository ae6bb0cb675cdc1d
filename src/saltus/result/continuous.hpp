// A solution as a function of time.
#pragma once

#include <memory>
#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/result/progress.hpp"
#include "saltus/result/result.hpp"

namespace saltus::result {

/// Says which value is meant where there are two, at an event.
enum class Side { before, behind };

/// Makes rows of a solution inside its steps.
class Interior {
 public:
  virtual ~Interior() = default;
  /// Returns rows at those of these times, ascending, for which it has a polynomial.
  [[nodiscard]] virtual Trajectory rows(const std::vector<double>& times) = 0;
  /// Simulates once more, with rows at these times among others.
  [[nodiscard]] virtual Expected<Trajectory> again(const std::vector<double>& times, const StepObserver& observer) = 0;
};

/// Evaluates x(t), inputs, outputs, selections and modes at any times of a solution. For any number of threads, one
/// after the other.
///
/// The values are those of the run's rows at the same times bit for bit.
class Continuous {
 public:
  /// @param rows  both of every event, the first and the last of the solution; others are of use
  Continuous(Trajectory rows, std::unique_ptr<Interior> interior);
  ~Continuous();

  /// Returns one row per time, in their order; an Error for a time that is NaN or outside the span by more than
  /// roundings.
  /// @param observer  of a run that is simulated once more, where steps have no polynomials; may be empty
  [[nodiscard]] Expected<Trajectory> at(const std::vector<double>& times, Side side = Side::behind,
                                        const StepObserver& observer = {});

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// Returns the Error for a time outside a span.
[[nodiscard]] Error outside(double t, double from, double until);

/// Returns the end of a span that a time is beyond by a few roundings, as T (i + 1)/N may be; else the time.
[[nodiscard]] double moved_to_end(double t, double from, double until);

/// Appends the row of a time, the first or the last one of several, to `values`; false if there is none.
bool append_row_at(double t, Side side, const Trajectory& rows, Trajectory& values);

}  // namespace saltus::result
