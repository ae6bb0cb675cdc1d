#include "saltus/event_integrator/field/rooted_exit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "saltus/event_integrator/mode/resolution.hpp"
#include "saltus/event_integrator/mode/small_internal.hpp"
#include "saltus/linalg/factors.hpp"

namespace saltus::event_integrator {
namespace {

/// Substeps of the extrapolated values: 1, 2, ..., the order of the result.
constexpr int most_substeps = 7;

}  // namespace

RootedExit::RootedExit(const evaluation::ModelKernel& kernel, bool affine_in_alpha, const ModeState& state, int surface)
    : kernel_(kernel),
      field_(kernel, affine_in_alpha),
      state_(state),
      surface_(surface),
      side_(state.mode[at(surface)]),
      row_(at(kernel.states())),
      values_(at(kernel.event_functions())),
      from_(row_.size()),
      x_(row_.size()),
      f_(row_.size()) {
  field_.enter(state_);
}

double RootedExit::psi(double t, const std::vector<double>& x) {
  kernel_.functions(t, x.data(), state_.alpha.data(), values_.data());
  return values_[at(surface_)];
}

void RootedExit::find_replaced(double t, const std::vector<double>& x) {
  double rate = 0.0;
  kernel_.gradient(surface_, t, x.data(), state_.alpha.data(), row_.data(), &rate);
  const auto largest =
      std::max_element(row_.begin(), row_.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
  replaced_ = static_cast<std::size_t>(largest - row_.begin());
  noise_ = std::abs(rate * t);
  for (std::size_t i = 0; i < row_.size(); ++i) noise_ += std::abs(row_[i] * x[i]);
  noise_ = rounding_of(noise_);
  if (degree_ == 0.0) find_degree(t, x);
}

/// dpsi/dt at a distance beside x, into the region, less that at x, outwards: how it falls with the root.
double RootedExit::change_beside(double t, const std::vector<double>& x, double width) {
  double square = 0.0, farthest = 0.0;
  for (const double d : row_) square += d * d;
  for (std::size_t i = 0; i < x.size(); ++i) {
    farthest = std::max(farthest, std::abs(row_[i]) / square / (1.0 + std::abs(x[i])));
  }
  const double here = velocity(t, x);
  std::vector<double> beside = x;
  for (std::size_t i = 0; i < x.size(); ++i) beside[i] += side_ * width / farthest * row_[i] / square;
  return side_ * (velocity(t, beside) - here);
}

/// psi = v^degree, in which the root is linear: of |psi|^q it is 1/q.
void RootedExit::find_degree(double t, const std::vector<double>& x) {
  // A hundred times nearer other terms change a hundredth as much.
  constexpr double width = 0x1p-20, nearer = 0x1p-7;
  const double wide = change_beside(t, x, width), narrow = change_beside(t, x, nearer * width);
  const double exponent = std::log(narrow / wide) / std::log(nearer);
  constexpr double least = 1.0, most = 8.0;
  degree_ = std::isfinite(exponent) && exponent > 0.0 ? std::clamp(1.0 / exponent, least, most) : 2.0;
  // Square roots, but for the rest of the field.
  constexpr double square_root = 0.1;
  if (std::abs(degree_ - 2.0) < square_root) degree_ = 2.0;
}

/// The state that belongs to the unknowns.
bool RootedExit::place(double t, const std::vector<double>& unknowns, std::vector<double>& x) {
  const double wanted = side_ * std::pow(unknowns[replaced_], degree_);
  const double kept = x[replaced_];
  x = unknowns;
  x[replaced_] = kept;
  // A surface that is a plane is met by the first of these, others are so nearly over a step.
  for (int iteration = 0; iteration < 4; ++iteration) {
    const double next = x[replaced_] - (psi(t, x) - wanted) / row_[replaced_];
    if (!std::isfinite(next)) return false;
    if (next == x[replaced_]) break;
    x[replaced_] = next;
  }
  return true;
}

bool RootedExit::residual(double t, double h, const std::vector<double>& unknowns, std::vector<double>& result) {
  if (!place(t, unknowns, x_)) return false;
  field_(t, x_.data(), f_.data());
  for (std::size_t i = 0; i < result.size(); ++i) result[i] = x_[i] - from_[i] - h * f_[i];
  return is_finite(result);
}

/// From from_ to t, which is h later: Newton's method with differences, from `unknowns`, which are improved.
bool RootedExit::implicit_euler(double t, double h, std::vector<double>& unknowns) {
  const std::size_t n = unknowns.size();
  const auto size = static_cast<linalg::Index>(n);
  std::vector<double> here(n), there(n);
  linalg::Matrix jacobian(size, size);
  linalg::Vector change(size);
  constexpr int most_iterations = 40;
  // Differences of this part of 1 + |x| are good to eight digits. Those of v are good to four, and so is every
  // iteration. In v the equations are nearly linear, and it may be little more than rounding of the terms of dpsi/dt.
  // Where psi is not much more than its rounding they are good to fewer.
  constexpr double part = 0x1p-26, part_of_v = 0x1p-13;
  constexpr double converged = 1e-12;
  constexpr double settled = 1e-6;  // from here on corrections that no longer fall are roundings of f
  double before = std::numeric_limits<double>::infinity();
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    if (!residual(t, h, unknowns, here)) return false;
    for (std::size_t k = 0; k < n; ++k) {
      const double kept = unknowns[k];
      const double width =
          k == replaced_ ? std::max(part_of_v * kept, std::pow(noise_, 1.0 / degree_)) : part * (1.0 + std::abs(kept));
      unknowns[k] = kept + width;
      const double taken = unknowns[k] - kept;
      if (!residual(t, h, unknowns, there)) return false;
      unknowns[k] = kept;
      for (std::size_t i = 0; i < n; ++i) {
        jacobian(static_cast<linalg::Index>(i), static_cast<linalg::Index>(k)) = (there[i] - here[i]) / taken;
      }
    }
    for (std::size_t i = 0; i < n; ++i) change[static_cast<linalg::Index>(i)] = -here[i];
    linalg::Lu(jacobian).solve_in_place(change);
    if (!change.all_finite()) return false;
    double largest = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      double step = change[static_cast<linalg::Index>(i)];
      const double scale = i == replaced_ ? unknowns[i] : 1.0 + std::abs(unknowns[i]);
      const double rounding = i == replaced_ ? noise_ * std::pow(unknowns[i], 1.0 - degree_) : 0.0;
      largest = std::max(largest, (std::abs(step) - rounding) / scale);
      // v stays positive: where it goes to zero there is no solution inside.
      if (i == replaced_) step = std::max(step, -0.75 * unknowns[i]);
      unknowns[i] += step;
    }
    if (largest <= converged || (largest <= settled && largest >= 0.25 * before)) return true;
    before = largest;
  }
  return false;
}

/// `count` equal steps from x over h.
bool RootedExit::substeps(double t, const std::vector<double>& x, double h, int count, std::vector<double>& unknowns) {
  from_ = x;
  const double part = h / count;
  for (int k = 0; k < count; ++k) {
    const double end = t + h * (static_cast<double>(k + 1) / count);
    // First guess: where the field leads to, and that of a point moved along it; not into the surface.
    double farthest = std::abs(psi(end, from_));
    x_ = from_;
    for (int pass = 0; pass < 2; ++pass) {
      field_(end, x_.data(), f_.data());
      for (std::size_t i = 0; i < f_.size(); ++i) x_[i] = from_[i] + part * f_[i];
      if (!is_finite(x_)) return false;
      farthest = std::max(farthest, std::abs(psi(end, x_)));
    }
    unknowns = x_;
    unknowns[replaced_] = std::pow(farthest, 1.0 / degree_);
    if (!(unknowns[replaced_] > 0.0) || !implicit_euler(end, part, unknowns)) return false;
    if (!place(end, unknowns, x_)) return false;
    from_ = x_;
  }
  return side_ * psi(t + h, from_) > 0.0;
}

bool RootedExit::leads_away(double t, const std::vector<double>& x, double h) {
  find_replaced(t, x);
  std::vector<double> unknowns(x.size());
  for (const double part : {1.0, 0.25, 0.0625}) {
    if (!substeps(t, x, part * h, 1, unknowns)) return false;
  }
  return true;
}

std::optional<std::vector<double>> RootedExit::step(double t, const std::vector<double>& x, double h,
                                                    const ode::Tolerances& tolerances) {
  find_replaced(t, x);
  // Row by row of the scheme of Aitken and Neville for an error in powers of h.
  std::vector<std::vector<double>> row, before;
  for (int count = 1; count <= most_substeps; ++count) {
    row.assign(1, std::vector<double>(x.size()));
    if (!substeps(t, x, h, count, row.front())) return std::nullopt;
    for (int k = 1; k < count; ++k) {
      const double ratio = static_cast<double>(count) / (count - k) - 1.0;
      const auto& here = row.back();
      std::vector<double> next(here.size());
      for (std::size_t i = 0; i < next.size(); ++i) {
        next[i] = here[i] + (here[i] - before[at(k - 1)][i]) / ratio;
      }
      row.push_back(std::move(next));
    }
    before.swap(row);
  }
  const auto& best = before.back();
  const auto& last = before[before.size() - 2];
  std::vector<double> result = x, other = x;
  if (!(best[replaced_] > 0.0) || !place(t + h, best, result) || !place(t + h, last, other)) return std::nullopt;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double allowed = tolerances.atol + tolerances.rtol * std::max(std::abs(x[i]), std::abs(result[i]));
    if (!(std::abs(result[i] - other[i]) <= allowed)) return std::nullopt;
  }
  field_.project(t + h, result.data());
  return side_ * psi(t + h, result) > 0.0 ? std::optional(std::move(result)) : std::nullopt;
}

/// row_ . f: what the field contributes to d psi/dt.
double RootedExit::velocity(double t, const std::vector<double>& x) {
  field_(t, x.data(), f_.data());
  double sum = 0.0;
  for (std::size_t i = 0; i < f_.size(); ++i) sum += row_[i] == 0.0 ? 0.0 : row_[i] * f_[i];
  return sum;
}

bool RootedExit::has_root(double t, const std::vector<double>& x) {
  find_replaced(t, x);
  // Sixteen times nearer a smooth function changes a sixteenth as much, a square root a fourth, |psi|^(3/4) an eighth.
  constexpr double width = 0x1p-20, nearer = 0x1p-4, smooth = 0x1p-3;
  const double wide = change_beside(t, x, width), narrow = change_beside(t, x, nearer * width);
  return narrow < 0.0 && narrow < smooth * wide;
}

double RootedExit::stiffness(double t, const std::vector<double>& x) {
  find_replaced(t, x);
  const double value = psi(t, x);
  double square = 0.0;
  for (const double d : row_) square += d * d;
  std::vector<double> nearer = x;
  for (std::size_t i = 0; i < nearer.size(); ++i) nearer[i] -= 0.5 * value * row_[i] / square;
  const double rate = (velocity(t, nearer) - velocity(t, x)) / (0.5 * value);
  return rate > 0.0 ? rate : 0.0;
}

}  // namespace saltus::event_integrator
