// What stays constant within a simulation step: selections of functions of time, cells of floor, tables and samples.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "saltus/discretization/point_functions.hpp"
#include "saltus/fesd_integrator/element/facts.hpp"

namespace saltus::fesd_integrator {

/// Holds the values of Dcs::held from a time on, and the time of their next change.
class HeldValues {
 public:
  /// Both must outlive it.
  HeldValues(const discretization::PointFunctions& functions, const std::vector<HeldFact>& facts);

  [[nodiscard]] const double* data() const { return values_.data(); }
  /// Takes values that were found before.
  void put(const std::vector<double>& values) { values_ = values; }
  /// Finds the values just behind a time; `reach` is a length that is small against what happens, at whose thousand
  /// millionth part signs are looked at. Returns whether something has changed.
  enum class Change { none, some };
  Change set_behind(double t, double reach, const double* x);
  /// Returns the first time in (t, end] at which one of the arguments leaves its sign or its cell; `end` if none does.
  /// Signs between the points where they are looked at are those of interpolants of degree 8 in a quarter of the
  /// interval.
  [[nodiscard]] double next_change(double t, double end, const double* x);
  /// Returns what that is; nullopt if none does. Of several at the same time the first.
  [[nodiscard]] std::optional<std::size_t> next_changing() const { return next_changing_; }

 private:
  [[nodiscard]] double distance(std::size_t symbol, int bound) const;
  void update_arguments(double t, const double* x);
  [[nodiscard]] double refined(std::size_t symbol, int bound, double lower, double upper, const double* x);

  const discretization::PointFunctions& functions_;
  const std::vector<HeldFact>& facts_;
  std::vector<double> values_, arguments_, next_;
  std::vector<double> signs_;  ///< of the arguments of selections
  std::vector<long> cells_;
  std::optional<std::size_t> next_changing_;
};

}  // namespace saltus::fesd_integrator
