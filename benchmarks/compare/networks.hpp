// Gene networks as an expert writes them down for speed: between two switches x_i' = production_i - decay_i x_i with a
// constant production, so every x_i moves monotonically and only the next threshold ahead of it can be reached.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>

namespace compare {

enum class Watch {
  relevant,  ///< the next threshold ahead of every component
  all,       ///< every threshold of the model after every step
};

/// `Network` provides n, total (number of thresholds), decay, thresholds(i) ascending, start(), and produce(level): the
/// productions where level[i] thresholds of component i lie below x_i.
template <class Network, Watch watch>
class NetworkProblem {
 public:
  static constexpr std::size_t n = Network::n;
  static constexpr std::size_t functions = watch == Watch::relevant ? Network::n : Network::total;
  static constexpr std::size_t modes = 1;
  static constexpr bool monotone = true;
  static constexpr double until = Network::until;
  using State = std::array<double, n>;

  NetworkProblem() {
    const State x = start();
    for (std::size_t i = 0; i < n; ++i) {
      level_[i] = 0;
      for (const double threshold : Network::thresholds(i)) level_[i] += x[i] > threshold ? 1 : 0;
    }
    std::size_t j = 0;
    for (std::size_t i = 0; i < n; ++i) {
      first_[i] = j;
      for (const double threshold : Network::thresholds(i)) {
        component_[j] = i;
        threshold_[j] = threshold;
        side_[j] = x[i] > threshold ? 1.0 : -1.0;
        ++j;
      }
    }
    first_[n] = j;
    look_ahead(x);
  }

  [[nodiscard]] static State start() { return Network::start(); }
  [[nodiscard]] static constexpr std::size_t mode() { return 0; }
  [[nodiscard]] static constexpr double longest_step() { return until; }

  void operator()(const double* x, double* slope) const {
    for (std::size_t i = 0; i < n; ++i) slope[i] = production_[i] - Network::decay[i] * x[i];
  }
  void jacobian(const double*, double* columns) const {
    for (std::size_t i = 0; i < n * n; ++i) columns[i] = 0.0;
    for (std::size_t i = 0; i < n; ++i) columns[i * n + i] = -Network::decay[i];
  }

  /// Positive in the mode, negative behind its end.
  [[nodiscard]] double value(std::size_t k, const double* x) const {
    if constexpr (watch == Watch::relevant) {
      return std::isfinite(bound_[k]) ? direction_[k] * (bound_[k] - x[k]) : 1.0;
    } else {
      return side_[k] * (x[component_[k]] - threshold_[k]);
    }
  }
  [[nodiscard]] double rate(std::size_t k, const double*, const double* slope) const {
    if constexpr (watch == Watch::relevant) {
      return -direction_[k] * slope[k];
    } else {
      return side_[k] * slope[component_[k]];
    }
  }

  [[nodiscard]] bool left(const double* x) const {
    int behind = 0;  // not a bool with early exit: these loops vectorise
    if constexpr (watch == Watch::relevant) {
      for (std::size_t k = 0; k < n; ++k) behind |= direction_[k] * (bound_[k] - x[k]) < 0.0 ? 1 : 0;
    } else {
      for (std::size_t i = 0; i < n; ++i) {
        const double own = x[i];
        for (std::size_t j = first_[i]; j < first_[i + 1]; ++j) {
          behind |= side_[j] * (own - threshold_[j]) < 0.0 ? 1 : 0;
        }
      }
    }
    return behind != 0;
  }

  void cross(std::size_t k, double* x) {
    const std::size_t i = watch == Watch::relevant ? k : component_[k];
    const bool up = watch == Watch::relevant ? direction_[k] > 0.0 : side_[k] < 0.0;
    const auto crossed = static_cast<std::size_t>(up ? level_[i] : level_[i] - 1);
    x[i] = Network::thresholds(i)[crossed];
    level_[i] += up ? 1 : -1;
    side_[first_[i] + crossed] = up ? 1.0 : -1.0;
    State state;
    for (std::size_t m = 0; m < n; ++m) state[m] = x[m];
    look_ahead(state);
  }

 private:
  void look_ahead(const State& x) {
    production_ = Network::produce(level_);
    for (std::size_t i = 0; i < n; ++i) {
      const auto thresholds = Network::thresholds(i);
      const auto level = static_cast<std::size_t>(level_[i]);
      constexpr double never = std::numeric_limits<double>::infinity();
      if (production_[i] > Network::decay[i] * x[i]) {
        direction_[i] = 1.0;
        bound_[i] = level < thresholds.size() ? thresholds[level] : never;
      } else {
        direction_[i] = -1.0;
        bound_[i] = level > 0 ? thresholds[level - 1] : -never;
      }
    }
  }

  std::array<int, n> level_{};
  State production_{}, direction_{}, bound_{};
  std::array<double, Network::total> threshold_{}, side_{};
  std::array<std::size_t, Network::total> component_{};
  std::array<std::size_t, n + 1> first_{};
};

/// IRMA with u = 1: parameters as in models/irma.toml.
struct Irma {
  static constexpr std::size_t n = 5;
  static constexpr std::size_t total = 7;
  static constexpr double until = 1000.0;
  static constexpr std::array<double, n> decay{0.05, 0.04, 0.05, 0.02, 0.6};
  static std::array<double, n> start() { return {0.011, 0.09, 0.04, 0.05, 0.015}; }
  static std::span<const double> thresholds(std::size_t i) {
    static constexpr std::array<double, total> all{0.01, 0.01, 0.06, 0.08, 0.035, 0.04, 0.01};
    static constexpr std::array<std::size_t, n + 1> first{0, 1, 4, 5, 6, 7};
    return std::span<const double>(all).subspan(first[i], first[i + 1] - first[i]);
  }
  static std::array<double, n> produce(const std::array<int, n>& level) {
    const double low = level[1] > 0 ? 1.0 : 0.0;
    return {1.1e-4 + (level[3] > 0 ? 9e-4 : 0.0), 3e-4 + (level[0] > 0 ? 0.15 : 0.0),
            6e-4 + (level[1] > 1 ? 0.018 : 0.0), 5e-4 * low + 0.03 * low * (level[2] > 0 ? 0.0 : 1.0),
            7.5e-4 + (level[1] > 2 ? 0.015 : 0.0)};
  }
};

}  // namespace compare
