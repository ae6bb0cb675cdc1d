#include <cmath>
#include <cstdint>

#include <casadi/core/function.hpp>

#include "saltus/reformulation/same_surface_internal.hpp"

namespace saltus::reformulation {
namespace {

/// Magnitudes of the points; the extreme ones only tell functions apart that look alike nearer by (x - 1e20, x - 2e20).
constexpr double magnitudes[] = {1, 1, 1, 1, 0.1, 0.1, 0.1, 10, 10, 10, 100, 100, 1e5, 1e10, 1e15, 1e20, 1e22};
/// The first points have positive coordinates, where logarithms and roots are defined.
constexpr std::size_t positive_points = 6;
/// Values of different roundings of one function differ by a few units of its terms, which may cancel.
constexpr double tolerance = 1e-10;
constexpr int enough_points = 6;

/// A repeatable number in (-1, 1): splitmix64.
double draw(std::uint64_t point, std::uint64_t variable) {
  std::uint64_t z = (point * 0x9e3779b97f4a7c15ULL) ^ ((variable + 1) * 0xd1b54a32d192ed03ULL);
  z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27U)) * 0x94d049bb133111ebULL;
  z ^= z >> 31U;
  return 2.0 * (static_cast<double>(z >> 11U) + 0.5) / 9007199254740992.0 - 1.0;
}

/// +1 or -1 if b is a multiple of a with that sign, 0 if it is none or too few points tell.
int same(const std::vector<double>& a, const std::vector<double>& b) {
  std::optional<std::size_t> reference;
  int seen = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    if (!std::isfinite(a[k]) || !std::isfinite(b[k])) continue;
    if (!reference) {
      if (a[k] == 0.0 || b[k] == 0.0) continue;
      reference = k;
    }
    const double left = a[k] / a[*reference], right = b[k] / b[*reference];
    if (!(std::abs(left - right) <= tolerance * (std::abs(left) + std::abs(right)))) return 0;
    ++seen;
  }
  if (seen < enough_points) return 0;
  return (a[*reference] > 0.0) == (b[*reference] > 0.0) ? 1 : -1;
}

}  // namespace

std::vector<double> SurfaceSamples::sample(const SXElem& psi, const std::vector<SXElem>& held) const {
  const auto& s = system_;
  const casadi::Function function("psi", {s.t, s.x, s.u, s.p, column(held)}, {SX(psi)});
  std::vector<double> t(1), x(s.state_names.size()), u(s.control_names.size()), at_held(held.size());
  std::vector<double> values(std::size(magnitudes));
  for (std::size_t k = 0; k < values.size(); ++k) {
    std::uint64_t variable = 0;
    for (auto* numbers : {&t, &x, &u, &at_held}) {
      for (double& number : *numbers) {
        const double unit = draw(k, variable++);
        number = magnitudes[k] * (k < positive_points ? std::abs(unit) : unit);
      }
    }
    // By pointers: matrices would take most of the time of all reformulations.
    const std::vector<const double*> point{t.data(), x.data(), u.data(), s.parameter_values.data(), at_held.data()};
    const std::vector<double*> value{&values[k]};
    function(point, value);
  }
  return values;
}

std::optional<SurfaceSamples::Match> SurfaceSamples::find(const SXElem& psi, const std::vector<SXElem>& held) const {
  const std::vector<double> values = sample(psi, held);
  for (std::size_t i = 0; i < known_.size(); ++i) {
    if (const int orientation = same(known_[i], values); orientation != 0)
      return Match{static_cast<int>(i), orientation};
  }
  return std::nullopt;
}

void SurfaceSamples::add(const SXElem& psi, const std::vector<SXElem>& held) { known_.push_back(sample(psi, held)); }

}  // namespace saltus::reformulation
