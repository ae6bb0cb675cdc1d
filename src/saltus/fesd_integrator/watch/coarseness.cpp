#include "saltus/fesd_integrator/watch/coarseness.hpp"

#include <algorithm>
#include <cmath>

namespace saltus::fesd_integrator {
namespace {

constexpr double rounding_of_others = 1e-12;  // of a component that is zero but for those of the others

}  // namespace

double Coarseness::share(const Element& element, const std::vector<double>& errors) const {
  if (!limit_) return 0.0;
  double worst = 0.0;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    if (!(errors[i] > rounding_of_others * element.size)) continue;
    const double before = largest_.empty() ? 0.0 : largest_[i];
    const double largest = std::max({before, std::abs(element.x[i]), std::abs(element.end[i])});
    worst = std::max(worst, errors[i] / (*limit_ * element.h / span_ * largest));
  }
  return worst;
}

void Coarseness::note(const Element& element, const std::vector<double>& errors) {
  const std::size_t n_x = element.x.size();
  if (largest_.empty()) {
    largest_.assign(n_x, 0.0);
    sum_ = error_ = t_ = largest_;
    for (std::size_t i = 0; i < n_x; ++i) largest_[i] = std::abs(element.x[i]);
  }
  for (std::size_t i = 0; i < n_x; ++i) {
    largest_[i] = std::max(largest_[i], std::abs(element.end[i]));
    if (!(errors[i] > rounding_of_others * element.size)) continue;
    sum_[i] += errors[i];
    if (!(errors[i] > error_[i])) continue;
    error_[i] = errors[i];
    t_[i] = element.t;
  }
}

std::optional<Coarseness::Worst> Coarseness::worst() const {
  std::optional<Worst> worst;
  for (std::size_t i = 0; i < largest_.size(); ++i) {
    if (!(largest_[i] > 0.0)) continue;
    const double sum = sum_[i] / largest_[i];
    if (!worst || sum > worst->sum) worst = Worst{i, sum, error_[i] / largest_[i], t_[i]};
  }
  return worst;
}

}  // namespace saltus::fesd_integrator
