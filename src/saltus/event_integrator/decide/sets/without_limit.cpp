#include "saltus/event_integrator/decide/sets/without_limit.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>

#include <fmt/format.h>

#include "saltus/event_integrator/mode/selections_at.hpp"
#include "saltus/event_integrator/mode/small_internal.hpp"

namespace saltus::event_integrator {
namespace {

/// The component of f that differs most between points with one choice of listed selections.
struct Range {
  std::size_t state = 0;
  double low = 0.0, high = 0.0;
  [[nodiscard]] double width() const { return high - low; }
};

/// f near x: on the axes at a distance, both ways, with all other states beside theirs by next to nothing.
class Around {
 public:
  Around(const SwitchingContext& s, double t, const std::vector<double>& x, const std::vector<double>& alpha)
      : s_(s), t_(t), x_(x), alpha_(alpha), f_(x.size()) {}

  Range range(double distance) {
    ranges_.clear();
    for (std::size_t axis = 0; axis < x_.size(); ++axis) {
      for (const double way : {distance, -distance}) {
        for (const double beside : {1e-12 * distance, -1e-12 * distance}) look(axis, way, beside);
      }
    }
    Range widest;
    for (const auto& [selections, ranges] : ranges_) {
      for (const auto& range : ranges) {
        if (range.width() > widest.width()) widest = range;
      }
    }
    return widest;
  }

 private:
  void look(std::size_t axis, double way, double beside) {
    std::vector<double> x = x_;
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += i == axis ? way : beside;
    const auto alpha = selections_at(s_.kernel, t_, x.data(), alpha_);
    s_.kernel.field(t_, x.data(), alpha.data(), f_.data());
    if (!is_finite(f_)) return;
    std::vector<double> listed;
    for (std::size_t j = 0; j < alpha.size(); ++j) {
      if (s_.layout.surfaces[j].role == model::SwitchingRole::listed) listed.push_back(alpha[j]);
    }
    const auto [known, first] = ranges_.try_emplace(std::move(listed));
    for (std::size_t i = 0; i < f_.size(); ++i) {
      if (first) known->second.push_back({i, f_[i], f_[i]});
      auto& range = known->second[i];
      range.low = std::min(range.low, f_[i]);
      range.high = std::max(range.high, f_[i]);
    }
  }

  const SwitchingContext& s_;
  double t_;
  const std::vector<double>& x_;
  const std::vector<double>& alpha_;
  std::vector<double> f_;
  std::map<std::vector<double>, std::vector<Range>> ranges_;
};

}  // namespace

std::optional<std::string> without_limit(const SwitchingContext& s, double t, const std::vector<double>& x,
                                         const std::vector<double>& alpha, double distance) {
  constexpr std::size_t most_states = 100;
  if (x.size() > most_states || s.kernel.cells() > 0 || !s.kernel.region_groups().empty()) return std::nullopt;
  Around around(s, t, x, alpha);
  const Range far = around.range(distance);
  const Range near = around.range(1e-3 * distance);
  // Half of it at a thousandth of the distance; and not a rounding of large terms.
  const bool differs =
      near.width() >= 0.5 * far.width() && near.width() > 1e-3 * std::max(std::abs(near.low), std::abs(near.high));
  if (!differs) return std::nullopt;
  return fmt::format(
      "the rate of '{}' has no limit at the state reached at t = {:.17g}: it takes values from {:.3g} to {:.3g} around "
      "it at a distance of {:.3g} as at {:.3g} (a quotient that is 0/0 there, as in controllers of homogeneity degree "
      "0), so that it does not say what follows; end the simulation before, or add a small number, such as 1e-3, to "
      "the "
      "denominator (the model is stiff then: integrator = \"radau5\")",
      s.layout.state_names[near.state], t, near.low, near.high, 1e-3 * distance, distance);
}

}  // namespace saltus::event_integrator
