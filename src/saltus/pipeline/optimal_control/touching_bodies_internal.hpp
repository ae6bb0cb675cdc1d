// States of bodies that touch, put where they touch.
#pragma once

#include <vector>

#include "saltus/evaluation/contact_functions.hpp"
#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/result/result.hpp"

namespace saltus::pipeline {

/// Puts states onto the gaps that are closed there, and where nothing goes through another body: the event engine takes
/// a gap of more than a rounding for open, and one below zero for what cannot be.
class TouchingBodies {
 public:
  /// The kernel must outlive it.
  explicit TouchingBodies(const evaluation::ModelKernel& kernel);

  /// Returns modes by gaps and rates alone: closed or open. Without contacts there are none.
  [[nodiscard]] std::vector<result::ContactMode> modes_at(double t, const std::vector<double>& x);
  void project(double t, const std::vector<result::ContactMode>& modes, std::vector<double>& x);
  /// Returns the impulses that turn the velocities of x into those of x_after, by contact, as an event tells them: of
  /// the contacts that are closed at x the least ones.
  [[nodiscard]] std::vector<std::vector<double>> impulses(double t, const std::vector<double>& x,
                                                          const std::vector<double>& x_after);

 private:
  void evaluate(double t, const std::vector<double>& x);
  void correct(const std::vector<int>& rows, const linalg::Vector& values, const std::vector<int>& states,
               std::vector<double>& x) const;

  const evaluation::ModelKernel& kernel_;
  std::vector<double> alpha_;
  evaluation::ContactValues values_;
};

}  // namespace saltus::pipeline
