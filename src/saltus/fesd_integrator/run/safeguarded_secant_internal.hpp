// The length of elements at whose end a value is zero: secant steps inside a bracket.
#pragma once

#include <limits>
#include <optional>

namespace saltus::fesd_integrator {

/// Finds h > 0 with v(h) = 0 for a value that is positive below its zero: the caller evaluates v at h() and tells it
/// (take), until it is done. Secant steps start from a given h and slope; one that leaves the bracket (lower: v > 0;
/// upper: v <= 0) halves it, or doubles h while nothing is above.
/// Values within the noise of v are polished: divided by a small slope they are a time that is known better than that.
class SafeguardedSecant {
 public:
  struct Start {
    double h = 0.0;
    double slope = 0.0;    ///< d v / d h, about
    double longest = 0.0;  ///< beyond this h no zero is looked for
    double time = 0.0;     ///< of h = 0
    int elements = 1;      ///< of length h: the end is at time + elements h
  };
  explicit SafeguardedSecant(const Start& start) : start_(start), h_(start.h), slope_(start.slope) {}

  enum class State { searching, found, none };
  [[nodiscard]] double h() const { return h_; }
  /// Returns whether v(h()) is the first value that is asked for.
  [[nodiscard]] bool is_first() const { return taken_ == 0; }
  /// Takes `value`, v(h()), and `noise`, its rounding level. In every state but `searching` h() stays.
  State take(double value, double noise);

 private:
  [[nodiscard]] bool is_polished(double value, double noise);
  [[nodiscard]] std::optional<double> next(double value) const;

  Start start_;
  double h_ = 0.0, slope_ = 0.0;
  double lower_ = 0.0, upper_ = std::numeric_limits<double>::infinity();
  double h_before_ = 0.0, value_before_ = 0.0;
  int taken_ = 0;
  int polished_ = 0;  ///< steps taken from values within their noise
};

}  // namespace saltus::fesd_integrator
