#include <algorithm>
#include <cmath>

#include "saltus/fesd_integrator/element/root_unknowns_internal.hpp"

namespace saltus::fesd_integrator {
namespace {

/// Below the slopes of roots of anything; keeps what is divided by them finite.
constexpr double smallest = 1e-60;

}  // namespace

RootUnknowns::RootUnknowns(const discretization::StageKernel& kernel, std::size_t stages)
    : kernel_(kernel), exponents_(kernel.root_exponents()) {
  if (exponents_.empty()) return;
  roots_.resize(stages * exponents_.size());
  residual_.resize(roots_.size());
  slope_.resize(roots_.size());
  values_.resize(stages);
  for (auto& values : values_) kernel.size(values);
  kernel.size(scratch_);
}

void RootUnknowns::start(std::size_t stage, double t, const double* x, const double* selections, const double* held) {
  double* root = roots(stage);
  auto& values = values_[stage];
  std::fill_n(root, exponents_.size(), 0.0);
  kernel_.evaluate(t, x, selections, held, root, scratch_, values);
  for (std::size_t k = 0; k < exponents_.size(); ++k) {
    root[k] = std::copysign(std::pow(std::abs(values.base[k]), exponents_[k]), values.base[k]);
  }
}

void RootUnknowns::evaluate(std::size_t stage, double t, const double* x, const double* selections, const double* held,
                            discretization::StageValues& values) {
  const double* root = roots(stage);
  auto& at = values_[stage];
  kernel_.evaluate(t, x, selections, held, root, values, at);
  const std::size_t n_x = kernel_.states(), n = exponents_.size();
  for (std::size_t k = 0; k < n; ++k) {
    const double size = std::abs(root[k]), inverse = 1.0 / exponents_[k];
    const double residual = at.base[k] - std::copysign(std::pow(size, inverse), root[k]);
    const double slope = std::max(inverse * std::pow(size, inverse - 1.0), smallest);
    residual_[stage * n + k] = residual;
    slope_[stage * n + k] = slope;
    const double* f_root = at.f_root.data() + k * n_x;
    for (std::size_t i = 0; i < n_x; ++i) {
      if (f_root[i] == 0.0) continue;
      const double per_base = f_root[i] / slope;
      values.f[i] += per_base * residual;
      for (std::size_t l = 0; l < n_x; ++l) values.f_x[l * n_x + i] += per_base * at.base_x[l * n + k];
    }
  }
}

double RootUnknowns::update(std::size_t stage, const double* step, bool felt) {
  double* root = roots(stage);
  const auto& at = values_[stage];
  const std::size_t n_x = kernel_.states(), n = exponents_.size();
  double largest = 0.0;
  for (std::size_t k = 0; k < n; ++k) {
    const double* f_root = at.f_root.data() + k * n_x;
    // Of a branch that is not taken, or while it slides: 0.
    if (std::all_of(f_root, f_root + n_x, [](double value) { return value == 0.0; })) continue;
    double change = residual_[stage * n + k];
    for (std::size_t l = 0; l < n_x; ++l) change += at.base_x[l * n + k] * step[l];
    change /= slope_[stage * n + k];
    root[k] += change;
    if (!felt) continue;
    double size = 0.0;
    for (std::size_t m = 0; m < values_.size(); ++m) size = std::max(size, std::abs(roots(m)[k]));
    if (size > 0.0) largest = std::max(largest, std::abs(change) / size);
  }
  return largest;
}

void RootUnknowns::field(std::size_t stage, double t, const double* x, const double* selections, const double* held,
                         double* f) {
  kernel_.evaluate(t, x, selections, held, roots(stage), scratch_, values_[stage]);
  std::copy(scratch_.f.begin(), scratch_.f.end(), f);
}

}  // namespace saltus::fesd_integrator
