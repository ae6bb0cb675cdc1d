// Which points of a curve keep straight lines between them close to it.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "saltus/base/function_ref.hpp"
#include "saltus/ode/stepper.hpp"

namespace saltus::ode {

/// Holds the smallest and largest value of every column so far, and from them how far a line may be from a column.
class ColumnRanges {
 public:
  /// @param share  of the range of a column, >= 0
  /// @param floor  what a column is known to, whatever its range
  ColumnRanges(std::size_t columns, double share, const Tolerances& floor);
  /// Widens the range by a value; those that are not finite leave the range as it is.
  void widen(std::size_t column, double value) { widen(column, {&value, 1}); }
  /// Widens the ranges of columns from `first` on, likewise.
  void widen(std::size_t first, std::span<const double> values);
  /// Returns max(share (high - low), atol + rtol max(|low|, |high|)); the second part before any value.
  [[nodiscard]] double tolerance(std::size_t column) const;
  [[nodiscard]] std::size_t size() const { return low_.size(); }

 private:
  double share_;
  Tolerances floor_;
  std::vector<double> low_, high_;
};

/// Chooses points of a curve one piece after the other: a work space.
class StraightLines {
 public:
  /// The columns of a curve at theta; those that are not finite there count as straight.
  using Curve = FunctionRef<void(double theta, double* columns)>;

  /// Finds points inside (0, end), ascending: straight lines from the curve at 0 over these to its end are within
  /// tolerance[i] of column i, as far as samples show. They are few: each is as far behind the one before it as the
  /// samples between them allow.
  /// @param parts      equal parts that are sampled at least, >= 1; further ones where the curve bends
  /// @param tolerance  one per column, >= 0
  /// @return valid until the next call. Cost: some two samples per point, and 2 parts + 1.
  [[nodiscard]] const std::vector<double>& points(Curve curve, double end, int parts,
                                                  const std::vector<double>& tolerance);

 private:
  struct Sample {
    double theta = 0.0;
    std::size_t place = 0;  ///< in values_
  };
  Sample sample(Curve curve, double theta);
  void divide(Curve curve, Sample from, Sample to, int depth);
  [[nodiscard]] bool is_near_line(Sample from, Sample inside, Sample to, double share) const;
  void choose();

  const std::vector<double>* tolerance_ = nullptr;
  std::vector<double> values_;
  std::vector<Sample> samples_;
  std::vector<double> points_;
};

}  // namespace saltus::ode
