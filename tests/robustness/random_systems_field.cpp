#include "random_systems_field.hpp"

#include <algorithm>
#include <limits>

#include "saltus/linalg/factors.hpp"

namespace saltus::robustness {
namespace {

/// A number and its derivative along a direction.
struct Dual {
  double value = 0.0;
  double derivative = 0.0;
  Dual() = default;
  Dual(double v, double d = 0.0) : value(v), derivative(d) {}
};
Dual operator+(const Dual& a, const Dual& b) { return {a.value + b.value, a.derivative + b.derivative}; }
Dual operator-(const Dual& a, const Dual& b) { return {a.value - b.value, a.derivative - b.derivative}; }
Dual operator-(const Dual& a) { return {-a.value, -a.derivative}; }
Dual operator*(const Dual& a, const Dual& b) {
  return {a.value * b.value, a.derivative * b.value + a.value * b.derivative};
}
Dual sin(const Dual& a) { return {std::sin(a.value), std::cos(a.value) * a.derivative}; }

double value_of(double a) { return a; }
double value_of(const Dual& a) { return a.value; }

/// Answers with given selections and notes the switching functions.
template <class Scalar>
struct FixedSwitches {
  std::vector<double> alpha;
  const std::vector<bool>& read_anew;
  std::vector<Scalar> psi;
  double kink_distance = std::numeric_limits<double>::infinity();

  FixedSwitches(const std::vector<double>& selections, const std::vector<bool>& read)
      : alpha(selections), read_anew(read), psi(selections.size()) {}

  Scalar step(std::size_t surface, const Scalar& e) {
    psi[surface] = e;
    if (read_anew[surface]) {
      alpha[surface] = value_of(e) > 0.0 ? 1.0 : 0.0;
      kink_distance = std::min(kink_distance, std::abs(value_of(e)));
    }
    return alpha[surface];
  }
  Scalar max(const Scalar& a, const Scalar& b) {
    kink_distance = std::min(kink_distance, std::abs(value_of(a) - value_of(b)));
    return value_of(a) > value_of(b) ? a : b;
  }
  Scalar abs(const Scalar& a) { return max(a, -a); }
};

}  // namespace

OwnField::OwnField(const RandomSystem& system, const std::vector<int>& mode)
    : system_(system), selections_(mode.size()), read_anew_(mode.size()) {
  for (std::size_t j = 0; j < mode.size(); ++j) {
    selections_[j] = mode[j] > 0 ? 1.0 : mode[j] < 0 ? 0.0 : 0.5;
    if (mode[j] == 0) sliding_.push_back(j);
  }
  for (std::size_t j = 0; j < mode.size(); ++j) {
    const auto& inner = system.inner[j];
    read_anew_[j] = mode[j] != 0 && std::any_of(inner.begin(), inner.end(), [&](auto i) { return mode[i] == 0; });
  }
}

FieldValue OwnField::at_selections(double t, const std::vector<double>& x, const std::vector<double>& alpha) const {
  FixedSwitches<double> switches(alpha, read_anew_);
  FieldValue value;
  value.xdot = rates(system_, t, x, switches);
  value.alpha = std::move(switches.alpha);
  value.psi = std::move(switches.psi);
  value.kink_distance = switches.kink_distance;
  return value;
}

/// d psi / dt of all surfaces along the field of `value`.
std::vector<double> OwnField::psi_rates(double t, const std::vector<double>& x, const FieldValue& value) const {
  std::vector<Dual> direction;
  for (std::size_t i = 0; i < x.size(); ++i) direction.emplace_back(x[i], value.xdot[i]);
  FixedSwitches<Dual> switches(value.alpha, read_anew_);
  static_cast<void>(rates(system_, Dual(t, 1.0), direction, switches));
  std::vector<double> rates_of_psi;
  for (const auto& psi : switches.psi) rates_of_psi.push_back(psi.derivative);
  return rates_of_psi;
}

namespace {

/// Largest number in sight: d psi/dt is a sum of such, and rounded like them where the sum vanishes (two-fold points).
double size_of_terms(const std::vector<double>& x, const FieldValue& lower, const FieldValue& upper) {
  double size = 1.0;
  for (const auto* numbers : {&x, &lower.xdot, &upper.xdot}) {
    for (const double number : *numbers) size = std::max(size, std::abs(number));
  }
  return size;
}

}  // namespace

FieldValue OwnField::slide_on_one(double t, const std::vector<double>& x, std::vector<double> alpha) const {
  const std::size_t j = sliding_.front();
  const double guess = alpha[j];
  alpha[j] = 0.0;
  const FieldValue lower = at_selections(t, x, alpha);
  alpha[j] = 1.0;
  const FieldValue upper = at_selections(t, x, alpha);
  FieldValue value = lower;
  value.kink_distance = std::min(lower.kink_distance, upper.kink_distance);
  value.below = psi_rates(t, x, lower)[j];
  value.above = psi_rates(t, x, upper)[j];
  value.imbalance = std::abs((1.0 - guess) * value.below + guess * value.above) /
                    (1e-6 * size_of_terms(x, lower, upper) + std::abs(value.below) + std::abs(value.above));
  const double selection = value.below / (value.below - value.above);
  value.alpha[j] = selection;
  for (std::size_t i = 0; i < x.size(); ++i) value.xdot[i] += selection * (upper.xdot[i] - lower.xdot[i]);
  return value;
}

FieldValue OwnField::slide_on_several(double t, const std::vector<double>& x, std::vector<double> alpha) const {
  const auto m = static_cast<linalg::Index>(sliding_.size());
  const auto velocities = [&](const std::vector<double>& selections) {
    const auto all = psi_rates(t, x, at_selections(t, x, selections));
    linalg::Vector own(m);
    for (linalg::Index i = 0; i < m; ++i) own[i] = all[sliding_[static_cast<std::size_t>(i)]];
    return own;
  };
  // d psi_I/dt at selections, and its derivatives: differences between the faces of the cube.
  const auto linearise = [&](const std::vector<double>& selections) {
    linalg::Matrix matrix(m, m);
    for (linalg::Index column = 0; column < m; ++column) {
      auto corner = selections;
      double& selection = corner[sliding_[static_cast<std::size_t>(column)]];
      selection = 1.0;
      const linalg::Vector upper = velocities(corner);
      selection = 0.0;
      matrix.col(column) = upper - velocities(corner);
    }
    return matrix;
  };
  const linalg::Matrix guessed = linearise(alpha);
  const double imbalance = velocities(alpha).abs().over_each(guessed.abs().row_sums().add_to_all(1e-6)).max();
  for (int iteration = 0; iteration < 4; ++iteration) {
    const linalg::Vector change = linalg::FullLu(linearise(alpha)).solve(velocities(alpha));
    for (linalg::Index i = 0; i < m; ++i) alpha[sliding_[static_cast<std::size_t>(i)]] -= change[i];
    if (change.max_abs() < 1e-13) break;
  }
  FieldValue value = at_selections(t, x, alpha);
  value.imbalance = imbalance;
  value.pivot = linalg::FullLu(guessed).last_pivot();
  // A surface that no selection moves has a row of zeros.
  double lengths = 1.0;
  for (const double length : guessed.row_norms()) lengths *= length;
  value.determinant = lengths > 0.0 ? linalg::determinant(-guessed) / lengths : 0.0;
  return value;
}

FieldValue OwnField::operator()(double t, const std::vector<double>& x, const std::vector<double>& guess) const {
  std::vector<double> alpha = selections_;
  if (sliding_.empty()) return at_selections(t, x, alpha);
  for (const auto j : sliding_) alpha[j] = guess[j];
  if (sliding_.size() == 1) return slide_on_one(t, x, std::move(alpha));
  return slide_on_several(t, x, std::move(alpha));
}

}  // namespace saltus::robustness
