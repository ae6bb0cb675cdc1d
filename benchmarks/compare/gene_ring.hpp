// The network of 500 thresholds: ten proteins in a ring, fifty thresholds each, of which the trajectory meets two. The
// numbers are those of gene_ring.py, which writes the model file.
#pragma once

#include <array>
#include <cstddef>
#include <span>

namespace compare {

template <std::size_t inactive_each_side>
struct GeneRing {
  static constexpr std::size_t n = 10;
  static constexpr std::size_t each = 2 * inactive_each_side + 2;
  static constexpr std::size_t total = n * each;
  static constexpr double until = 100.0;
  static constexpr double basal = 0.05 + 0.002 * (24 - static_cast<double>(inactive_each_side));
  static constexpr double weight_inactive = 0.002;
  static constexpr double weight_active = 0.5;

  static constexpr double gene(std::size_t i, double slope, double offset) {
    return (offset + slope * static_cast<double>(i)) / 1000.0;
  }
  static constexpr std::array<double, n> make_decay() {
    std::array<double, n> decay{};
    for (std::size_t i = 0; i < n; ++i) decay[i] = static_cast<double>(50 + (3 * i) % 10) / 50.0;
    return decay;
  }
  static constexpr std::array<double, n> decay = make_decay();

  static std::array<double, n> start() {
    std::array<double, n> x{};
    for (std::size_t i = 0; i < n; ++i) x[i] = gene(i, 80.0, 100.0);
    return x;
  }

  static constexpr std::array<std::array<double, each>, n> make_thresholds() {
    std::array<std::array<double, each>, n> all{};
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < inactive_each_side; ++j) {
        all[i][j] = static_cast<double>(j + 1) / 1000.0;
        all[i][inactive_each_side + 2 + j] = static_cast<double>(2050 + 50 * j) / 1000.0;
      }
      all[i][inactive_each_side] = gene(i, 7.0, 400.0);
      all[i][inactive_each_side + 1] = gene(i, 5.0, 600.0);
    }
    return all;
  }
  static constexpr std::array<std::array<double, each>, n> table = make_thresholds();
  static std::span<const double> thresholds(std::size_t i) { return table[i]; }

  /// What a protein adds to the production of the next one, by the number of its thresholds passed.
  static constexpr std::array<double, each + 1> make_drive() {
    std::array<double, each + 1> drive{};
    for (std::size_t j = 0; j < each; ++j) {
      const bool active = j == inactive_each_side || j == inactive_each_side + 1;
      drive[j + 1] = drive[j] + (active ? weight_active : weight_inactive);
    }
    return drive;
  }
  static constexpr std::array<double, each + 1> drive = make_drive();

  /// Every protein activates the next one; the last one represses the first.
  static std::array<double, n> produce(const std::array<int, n>& level) {
    std::array<double, n> production{};
    production[0] = basal + drive[each] - drive[static_cast<std::size_t>(level[n - 1])];
    for (std::size_t i = 1; i < n; ++i) production[i] = basal + drive[static_cast<std::size_t>(level[i - 1])];
    return production;
  }
};

}  // namespace compare
