#include "outcomes.hpp"

#include <cmath>
#include <cstddef>
#include <exception>
#include <map>
#include <string_view>

#include <fmt/format.h>

#include "random_systems_model.hpp"
#include "region_systems.hpp"

namespace saltus::robustness {
namespace {

constexpr double rtol_of_outcomes = 1e-8;

/// FNV-1a, folded to 16 bits: a list of events that has changed looks the same once in 65536 times.
class Hash {
 public:
  void add(std::string_view text) {
    for (const char letter : text) add(static_cast<unsigned char>(letter));
    add(0);
  }
  [[nodiscard]] std::uint32_t folded() const { return (value_ >> 16U) ^ (value_ & 0xffffU); }

 private:
  void add(unsigned char letter) { value_ = (value_ ^ letter) * 16777619U; }
  std::uint32_t value_ = 2166136261U;
};

std::string rounded(double value) {
  if (!std::isfinite(value)) return fmt::format("{}", value);
  if (std::abs(value) >= 1.0) return fmt::format("{:.7g}", value);
  // 0.0 + x: no negative zero.
  return fmt::format("{:.7g}", 0.0 + std::round(value * 1e7) / 1e7);
}

std::string without_run(std::uint64_t seed, std::string_view status) {
  return fmt::format("{},{},0,,0000,0,0,", seed, status);
}

template <class Run>
std::string line_or_refusal(std::uint64_t seed, const Run& run) {
  try {
    return run();
  } catch (const std::exception&) {
    return without_run(seed, "refused");
  }
}

}  // namespace

std::string outcome_columns() { return "seed,status,events,kinds,hash,times,end,x"; }

std::string outcome_line(std::uint64_t seed, const result::Result& result) {
  std::map<result::EventKind, std::size_t> kinds;
  Hash hash;
  double times = 0.0, end = 0.0;
  for (const auto& event : result.events) {
    ++kinds[event.kind];
    hash.add(result::name(event.kind));
    hash.add(event.name.value_or(""));
    for (const auto& surface : event.surfaces) hash.add(surface);
    times += event.t;
  }
  std::string counts, state;
  for (const auto& [kind, count] : kinds) {
    counts += fmt::format("{}{}:{}", counts.empty() ? "" : ";", result::name(kind), count);
  }
  for (std::size_t i = 0; i < result.final.x.size(); ++i) {
    end += static_cast<double>(i + 1) * result.final.x[i];
    state += (i > 0 ? ";" : "") + rounded(result.final.x[i]);
  }
  return fmt::format("{},{},{},{},{:04x},{},{},{}", seed, result::name(result.status.termination), result.events.size(),
                     counts, hash.folded(), rounded(times), rounded(end), state);
}

std::string outcome_of(Family family, std::uint64_t seed) {
  constexpr Integrator integrators[] = {Integrator::dopri5, Integrator::dop853, Integrator::taylor};
  return line_or_refusal(seed, [&] {
    const RandomSystem system = draw(family, seed);
    const Model model(system);
    if (model.has_equal_surfaces()) return without_run(seed, "equal_surfaces");
    return outcome_line(seed, model.run({integrators[seed % 3], rtol_of_outcomes}, system.start));
  });
}

std::string outcome_of(HybridFamily family, std::uint64_t seed) {
  constexpr HybridIntegrator integrators[] = {HybridIntegrator::dopri5, HybridIntegrator::dop853,
                                              HybridIntegrator::taylor};
  return line_or_refusal(seed, [&] {
    const Hybrid system = draw(family, seed);
    return outcome_line(seed, HybridModel(system).run(integrators[seed % 3], rtol_of_outcomes, system.start));
  });
}

std::string outcome_of_regions(std::uint64_t seed) {
  constexpr int orders[] = {5, 8, 16};
  return line_or_refusal(seed, [&] {
    const RegionSystem system = draw_regions(seed);
    return outcome_line(seed, RegionModel(system).run(orders[seed % 3], rtol_of_outcomes, system.start));
  });
}

}  // namespace saltus::robustness
