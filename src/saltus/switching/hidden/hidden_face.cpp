#include <algorithm>
#include <cmath>

#include "saltus/base/at.hpp"
#include "saltus/switching/hidden/hidden_face_internal.hpp"

namespace saltus::switching {
HiddenFace::HiddenFace(int surfaces, ProjectedField g, Interpolation interpolation)
    : surfaces_(surfaces),
      g_(g),
      interpolation_(interpolation),
      tabulated_(surfaces <= largest_table && interpolation == Interpolation::multi_affine),
      kappa_(at(surfaces)),
      speed_(at(surfaces)),
      alpha_(at(surfaces)),
      selections_(at(surfaces)),
      here_(at(surfaces)),
      there_(at(surfaces)) {
  std::vector<double> largest(at(surfaces));
  const auto look = [&](const double* values) {
    for (std::size_t j = 0; j < largest.size(); ++j) largest[j] = std::max(largest[j], std::abs(values[j]));
  };
  if (tabulated_) {
    table_ = MultiAffine(surfaces, g);
    evaluations_ += static_cast<long>(table_.corners());
    for (int j = 0; j < surfaces; ++j) {
      for (std::size_t corner = 0; corner < table_.corners(); ++corner) {
        largest[at(j)] = std::max(largest[at(j)], std::abs(table_.value(j, corner)));
      }
    }
  } else {
    // 2^m corners are too many: those with equal selections, and each surface alone on the other side.
    for (const double base : {0.0, 1.0}) {
      std::fill(alpha_.begin(), alpha_.end(), base);
      for (int i = -1; i < surfaces; ++i) {
        if (i >= 0) alpha_[at(i)] = 1.0 - base;
        g(alpha_.data(), here_.data());
        look(here_.data());
        if (i >= 0) alpha_[at(i)] = base;
      }
    }
    evaluations_ += 2 * (surfaces + 1);
  }
  for (std::size_t j = 0; j < largest.size(); ++j) {
    kappa_[j] = largest[j] > 0.0 ? 1.0 / largest[j] : 1.0;
    speed_[j] = largest[j] > 0.0 ? 1.0 : 0.0;
  }
}

void HiddenFace::set_scaling(const std::vector<double>& scaling) {
  for (std::size_t j = 0; j < scaling.size(); ++j) {
    kappa_[j] *= scaling[j];
    speed_[j] *= scaling[j];
  }
}

void HiddenFace::enter(const std::vector<int>& zone) {
  free_.clear();
  std::size_t fixed = 0;
  for (int j = 0; j < surfaces_; ++j) {
    if (zone[at(j)] == 0) free_.push_back(j);
    if (zone[at(j)] > 0) fixed |= std::size_t{1} << j;
    alpha_[at(j)] = zone[at(j)] > 0 ? 1.0 : 0.0;
  }
  if (!tabulated_) return;
  face_.resize(surfaces_, static_cast<int>(free_.size()));
  for (std::size_t corner = 0; corner < face_.corners(); ++corner) {
    std::size_t whole = fixed;
    for (std::size_t i = 0; i < free_.size(); ++i) whole |= (corner >> i & 1U) << free_[i];
    for (int j = 0; j < surfaces_; ++j) face_.set_value(j, corner, kappa_[at(j)] * table_.value(j, whole));
  }
}

void HiddenFace::velocity(const double* u, double* v) const {
  ++evaluations_;
  if (tabulated_) {
    if (free_.size() == at(surfaces_)) return face_.evaluate(u, v);
    for (std::size_t i = 0; i < free_.size(); ++i) selections_[i] = u[free_[i]];
    face_.evaluate(selections_.data(), v);
    return;
  }
  for (const int j : free_) alpha_[at(j)] = u[j];
  g_(alpha_.data(), v);
  for (int j = 0; j < surfaces_; ++j) v[j] *= kappa_[at(j)];
}

void HiddenFace::derivatives(const double* u, const double* v, double* result) const {
  const std::size_t n = free_.size();
  std::copy(u, u + surfaces_, here_.begin());
  for (std::size_t p = 0; p < n; ++p) {
    double& component = here_[at(free_[p])];
    const double before = component;
    const double after = difference_end(before, interpolation_);
    component = after;
    velocity(here_.data(), there_.data());
    component = before;
    for (int j = 0; j < surfaces_; ++j) result[at(j) * n + p] = (there_[at(j)] - v[j]) / (after - before);
  }
}

}  // namespace saltus::switching
