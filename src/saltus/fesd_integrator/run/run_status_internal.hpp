// Counts what a run has done, and how it ends.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <utility>

#include "saltus/fesd_integrator/integration.hpp"

namespace saltus::fesd_integrator {

/// Keeps the first reason to stop, which is the status; a run without one is completed.
class RunStatus {
 public:
  /// Both must outlive it.
  RunStatus(const IntegrationOptions& options, const StepObserver& observer) : options_(options), observer_(observer) {}

  void stop(double t, result::Termination termination, std::string message);
  [[nodiscard]] bool stopped() const { return status_.has_value(); }

  /// Counts an element that ends at t; whether the run goes on.
  [[nodiscard]] bool count_step(double t);
  /// Counts a try that is divided. A run that gets no further ends, too, and tells its observer until then.
  void count_rejected(double t, std::size_t events);
  void check_events(double t, std::size_t events);
  void show_progress(double t, std::size_t events, std::span<const double> x = {});

  [[nodiscard]] result::Statistics& statistics() { return statistics_; }
  /// Notes what is said of a run that gets to its end all the same; the first remark stays.
  void remark(std::string message);
  [[nodiscard]] bool has_remark() const { return remark_.has_value(); }
  /// Returns the status of a run that has got to t.
  [[nodiscard]] result::Status at_end(double t) const;

 private:
  [[nodiscard]] bool within_max_steps(double t);

  const IntegrationOptions& options_;
  const StepObserver& observer_;
  result::Statistics statistics_;
  std::optional<result::Status> status_;
  std::optional<std::string> remark_;
};

}  // namespace saltus::fesd_integrator
