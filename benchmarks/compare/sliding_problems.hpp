// Stick-slip and relay feedback as an expert writes them: every mode, sliding included, has its own field by hand.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

namespace compare {

/// Problem 8 (models/stick-slip.toml): the block sticks where both friction laws point at the belt's speed, |q| < 1.
class StickSlip {
 public:
  static constexpr std::size_t n = 2;
  static constexpr std::size_t functions = 1;
  static constexpr std::size_t modes = 3;
  static constexpr bool monotone = false;
  static constexpr double until = 1000.0;
  using State = std::array<double, n>;

  [[nodiscard]] static State start() { return {0.04, -0.01}; }
  [[nodiscard]] static constexpr double longest_step() { return until; }
  [[nodiscard]] std::size_t mode() const { return static_cast<std::size_t>(mode_); }

  void operator()(const double* x, double* slope) const {
    slope[0] = x[1];
    switch (mode_) {
      case Mode::slower:
        slope[1] = -x[0] + 1.0 / (1.2 - x[1]);
        return;
      case Mode::faster:
        slope[1] = -x[0] - 1.0 / (0.8 + x[1]);
        return;
      case Mode::stuck:
        slope[1] = 0.0;
        return;
    }
  }
  void jacobian(const double* x, double* columns) const {
    columns[0] = 0.0;
    columns[1] = mode_ == Mode::stuck ? 0.0 : -1.0;
    columns[2] = 1.0;
    const double gap = mode_ == Mode::slower ? 1.2 - x[1] : 0.8 + x[1];
    columns[3] = mode_ == Mode::stuck ? 0.0 : 1.0 / (gap * gap);
  }
  /// Positive in the mode, negative behind its end.
  [[nodiscard]] double value(std::size_t, const double* x) const {
    switch (mode_) {
      case Mode::slower:
        return belt - x[1];
      case Mode::faster:
        return x[1] - belt;
      case Mode::stuck:
        return 1.0 - x[0];
    }
    __builtin_unreachable();
  }
  [[nodiscard]] double rate(std::size_t, const double*, const double* slope) const {
    switch (mode_) {
      case Mode::slower:
        return -slope[1];
      case Mode::faster:
        return slope[1];
      case Mode::stuck:
        return -slope[0];
    }
    __builtin_unreachable();
  }
  [[nodiscard]] bool left(const double* x) const { return value(0, x) < 0.0; }

  void cross(std::size_t, double* x) {
    switch (mode_) {
      case Mode::slower:
      case Mode::faster:
        x[1] = belt;
        mode_ = std::abs(x[0]) < 1.0 ? Mode::stuck : mode_ == Mode::slower ? Mode::faster : Mode::slower;
        return;
      case Mode::stuck:
        x[0] = 1.0;
        mode_ = Mode::slower;
        return;
    }
  }

 private:
  enum class Mode { slower, faster, stuck };
  static constexpr double belt = 0.2;
  Mode mode_ = Mode::slower;
};

/// Problem 10 (models/relay-feedback.toml): slides on x1 = 0 while |x2| < 1.
class Relay {
 public:
  static constexpr std::size_t n = 3;
  static constexpr std::size_t functions = 2;
  static constexpr std::size_t modes = 3;
  static constexpr bool monotone = false;
  static constexpr double until = 10.0;
  using State = std::array<double, n>;

  [[nodiscard]] static State start() { return {0.0, -0.001, -0.02}; }
  /// Off the surface the system swings with period 0.25: longer steps leap over short visits.
  [[nodiscard]] double longest_step() const { return mode_ == Mode::sliding ? until : 0.05; }
  [[nodiscard]] std::size_t mode() const { return static_cast<std::size_t>(mode_); }

  void operator()(const double* x, double* slope) const {
    if (mode_ == Mode::sliding) {
      slope[0] = 0.0;
      slope[1] = x[2] + 2.0 * x[1];
      slope[2] = -x[1];
      return;
    }
    const double relay = side();
    slope[0] = -a1 * x[0] + x[1] - relay;
    slope[1] = -a2 * x[0] + x[2] + 2.0 * relay;
    slope[2] = -a3 * x[0] - relay;
  }
  void jacobian(const double*, double* columns) const {
    const bool sliding = mode_ == Mode::sliding;
    const std::array<double, 9> free_columns{-a1, -a2, -a3, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0};
    const std::array<double, 9> sliding_columns{0.0, 0.0, 0.0, 0.0, 2.0, -1.0, 0.0, 1.0, 0.0};
    for (std::size_t i = 0; i < 9; ++i) columns[i] = sliding ? sliding_columns[i] : free_columns[i];
  }
  /// Positive in the mode, negative behind its end.
  [[nodiscard]] double value(std::size_t k, const double* x) const {
    if (mode_ == Mode::sliding) return k == 0 ? 1.0 - x[1] : 1.0 + x[1];
    return k == 0 ? side() * x[0] : 1.0;
  }
  [[nodiscard]] double rate(std::size_t k, const double*, const double* slope) const {
    if (mode_ == Mode::sliding) return k == 0 ? -slope[1] : slope[1];
    return k == 0 ? side() * slope[0] : 0.0;
  }
  [[nodiscard]] bool left(const double* x) const { return value(0, x) < 0.0 || value(1, x) < 0.0; }

  void cross(std::size_t k, double* x) {
    if (mode_ == Mode::sliding) {
      x[1] = k == 0 ? 1.0 : -1.0;
      mode_ = k == 0 ? Mode::above : Mode::below;
      return;
    }
    x[0] = 0.0;
    mode_ = std::abs(x[1]) < 1.0 ? Mode::sliding : mode_ == Mode::below ? Mode::above : Mode::below;
  }

 private:
  enum class Mode { below, above, sliding };
  [[nodiscard]] double side() const { return mode_ == Mode::above ? 1.0 : -1.0; }
  static constexpr double a1 = 2.0 * 0.05 * 25.0 + 1.0;
  static constexpr double a2 = 2.0 * 0.05 * 25.0 + 25.0 * 25.0;
  static constexpr double a3 = 25.0 * 25.0;
  Mode mode_ = Mode::sliding;
};

}  // namespace compare
