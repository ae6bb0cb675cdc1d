#include "saltus/solver/homotopy/lead.hpp"

#include <algorithm>
#include <cmath>

namespace saltus::solver::homotopy {
namespace {

constexpr double last_mu = 1e-11;
/// mu of a relaxed problem over its sigma.
constexpr double share = 1e-2;
/// Error of the first problem over its mu.
constexpr double first_error = 0.1;
/// The monotone strategy of [waechter2006], section 2.1.
constexpr double linear = 0.2;
constexpr double superlinear = 1.5;

}  // namespace

std::optional<Level> next_level(const Schedule& schedule, const Level& solved) {
  const double last = schedule.sigma_final;
  if (solved.sigma > last) {
    const double sigma = schedule.next(solved.sigma);
    return Level{sigma, std::max(last_mu, share * sigma)};
  }
  const double smaller = std::min(linear * solved.mu, std::pow(solved.mu, superlinear));
  if (solved.mu > last_mu) return Level{last, std::max(last_mu, smaller)};
  return std::nullopt;
}

double first_tolerance(double sigma) { return first_error * share * std::min(1.0, sigma); }

}  // namespace saltus::solver::homotopy
