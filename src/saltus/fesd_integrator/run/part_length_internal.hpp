// How long the parts of a simulation step are: they are divided for errors, and where switches accumulate.
#pragma once

#include "saltus/fesd_integrator/accumulate/cycle_series.hpp"

namespace saltus::fesd_integrator {

/// Divides a simulation step of length H into parts of `elements` equal elements each. Parts that are too coarse get
/// shorter by the rule of step controls, h (0.8 / share)^(1/n_s), and longer again behind them; [hairer1993].
class PartLength {
 public:
  struct Shape {
    double nominal = 0.0;  ///< H
    int elements = 1;      ///< of a part
    int stages = 1;        ///< of an element: its errors are O(h^n_s)
    enum class Errors { ignored, limited };
    Errors errors = Errors::ignored;  ///< whether parts are divided for them
  };
  explicit PartLength(const Shape& shape) : shape_(shape), longest_(shape.nominal) {}

  [[nodiscard]] double nominal() const { return shape_.nominal; }
  /// Returns the length of an element by which a decision is tried where first derivatives do not decide.
  [[nodiscard]] double trial() const { return shape_.nominal / shape_.elements / 128.0; }
  /// Returns the length of the elements of a part that was not divided by switches.
  [[nodiscard]] double mean() const { return mean_; }
  void set_mean(double h) { mean_ = h; }

  /// Returns where the part ends that begins at t, in a simulation step that goes to `end`. `last_switch`: its time.
  [[nodiscard]] double end_of_part(double t, double end, double last_switch);

  /// Begins a chain of elements that is solved anew: no share of the error is known of it.
  void begin_chain() { share_ = 0.0; }
  /// Notes an element's share (Coarseness::share). True if the chain is beyond its share, and may be shorter.
  [[nodiscard]] bool is_too_coarse(double h, double share);
  /// Shortens what follows behind elements of length h that were too coarse, and lengthens it behind others.
  void shorten_behind(double h);
  void lengthen_behind(double h);

  /// Follows switches that accumulate: elements are so short that they resolve what is between two of them.
  void follow(const CycleSeries& series, double t);
  void stop_following() { between_switches_ = 0.0; }
  [[nodiscard]] bool is_following() const { return between_switches_ > 0.0; }

 private:
  [[nodiscard]] double ratio() const;

  Shape shape_;
  double mean_ = 0.0;
  double longest_ = 0.0;           ///< of a part, for its errors
  double between_switches_ = 0.0;  ///< of a part while switches accumulate; 0: any
  double share_ = 0.0;             ///< the largest of the current chain
};

}  // namespace saltus::fesd_integrator
