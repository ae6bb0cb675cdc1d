// Models whose surfaces depend on each other, stated in the tests.
#pragma once

#include <cmath>
#include <cstddef>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>

namespace saltus::problems {

/// Three agents, each drawn to each other at speed 1; the third one pushed by t. Functions in units of `scale`.
inline std::string three_agents(const std::string& start, const std::string& until, double scale = 1.0) {
  return fmt::format(R"toml(
[model]
name = "three agents"
[states]
{0}
[switching]
s12 = "{2}*(x1 - x2)"
s13 = "{2}*(x1 - x3)"
s23 = "{2}*(x2 - x3)"
[dynamics]
x1 = "-sign(s12) - sign(s13)"
x2 = "sign(s12) - sign(s23)"
x3 = "sign(s13) + sign(s23) + t"
[simulate]
until = {1}
)toml",
                     start, until, scale);
}

/// Three to five agents on a random graph, each pushed by a sine; some start all at the same place.
inline std::string agents_on_a_graph(int instance, std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  const int n = 3 + instance % 3;
  std::vector<std::string> rates;
  std::string states;
  for (int i = 0; i < n; ++i) {
    states += fmt::format("x{} = {}\n", i, instance % 4 == 0 ? 0.5 : 2.0 * unit(random) - 1.0);
    rates.push_back(
        fmt::format("{}*sin({}*t + {})", 4.0 * unit(random) - 2.0, 0.5 + 1.5 * unit(random), 6.0 * unit(random)));
  }
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < i; ++j) {
      if (unit(random) < 0.2) continue;
      const double force = 0.2 + 0.8 * unit(random);
      rates[static_cast<std::size_t>(i)] += fmt::format(" - {}*sign(x{} - x{})", force, i, j);
      rates[static_cast<std::size_t>(j)] += fmt::format(" + {}*sign(x{} - x{})", force, i, j);
    }
  }
  std::string dynamics;
  for (int i = 0; i < n; ++i) dynamics += fmt::format("x{} = \"{}\"\n", i, rates[static_cast<std::size_t>(i)]);
  return fmt::format("[model]\nname = \"network\"\n[states]\n{}[dynamics]\n{}[simulate]\nuntil = 6\n", states,
                     dynamics);
}

/// Blocks in a row on springs, each on a belt of speed 0.2 with dry friction (benchmarks/large/large_models.py).
inline std::string block_chain(int n, double until) {
  std::string positions, speeds, rates;
  for (int i = 1; i <= n; ++i) {
    positions += fmt::format("q{} = {:.6f}\n", i, std::sin(1.7 * i));
    speeds += fmt::format("v{} = {:.6f}\n", i, 0.5 * std::cos(2.3 * i));
    const std::string left = i > 1 ? fmt::format("q{} + ", i - 1) : "",
                      right = i < n ? fmt::format(" + q{}", i + 1) : "";
    rates += fmt::format("v{0} = \"{1}-2.5*q{0}{2} - sign(v{0} - 0.2)\"\n", i, left, right);
  }
  std::string moves;
  for (int i = 1; i <= n; ++i) moves += fmt::format("q{0} = \"v{0}\"\n", i);
  return fmt::format("[model]\nname = \"chain\"\n[states]\n{}{}[dynamics]\n{}{}[simulate]\nuntil = {}\n", positions,
                     speeds, moves, rates, until);
}

}  // namespace saltus::problems
