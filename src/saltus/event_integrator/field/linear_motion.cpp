#include "saltus/event_integrator/field/linear_motion.hpp"

#include <algorithm>
#include <cmath>

namespace saltus::event_integrator {

const ode::LinearField* LinearMotion::of_region(const evaluation::ModelKernel& kernel,
                                                const evaluation::FieldConstants& region) {
  if (!known_) known_ = kernel.linear_field(region.alpha.data(), own_[0]);
  return *known_;
}

/// d, from the constant parts of both fields, their values at the origin: elsewhere d would have the roundings of A x.
bool LinearMotion::find_difference(const evaluation::ModelKernel& kernel, const evaluation::FieldConstants& below,
                                   const evaluation::FieldConstants& above) {
  const auto n = static_cast<std::size_t>(kernel.states());
  origin_.assign(n, 0.0);
  above_.resize(n);
  difference_.resize(n);
  kernel.prepared_field(0.0, origin_.data(), below, difference_.data());
  kernel.prepared_field(0.0, origin_.data(), above, above_.data());
  bool finite = true;
  for (std::size_t i = 0; i < n; ++i) {
    difference_[i] = above_[i] - difference_[i];
    finite = finite && std::isfinite(difference_[i]);
  }
  return finite;
}

const ode::LinearField* LinearMotion::on_surface(const evaluation::ModelKernel& kernel,
                                                 const evaluation::FieldConstants& below,
                                                 const evaluation::FieldConstants& above, Normal normal) {
  if (known_) return *known_;
  known_ = nullptr;
  const auto* field = kernel.linear_field(below.alpha.data(), own_[0]);
  if (field == nullptr) return nullptr;
  const auto* other = kernel.linear_field(above.alpha.data(), own_[1]);
  if (field != other && !(*field == *other)) return nullptr;
  if (!find_difference(kernel, below, above)) return nullptr;
  double closing = 0.0;
  for (std::size_t i = 0; i < difference_.size(); ++i) closing += normal.row[i] * difference_[i];
  if (closing == 0.0 || !std::isfinite(closing)) return nullptr;
  project(*field, normal, closing);
  known_ = &sliding_;
  return &sliding_;
}

void LinearMotion::project(const ode::LinearField& field, Normal normal, double closing) {
  const std::size_t n = field.diagonal.size();
  normal_.assign(n, 0.0);
  double rate = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const double weight = normal.row[i] / closing;
    if (weight == 0.0) continue;
    normal_[i] += weight * field.diagonal[i];
    for (std::size_t k = field.start[i]; k < field.start[i + 1]; ++k) {
      normal_[field.column[k]] += weight * field.entry[k];
    }
    if (!field.rate.empty()) rate += weight * field.rate[i];
  }
  sliding_.diagonal.resize(n);
  sliding_.rate = field.rate;
  sliding_.start.assign(1, 0);
  sliding_.column.clear();
  sliding_.entry.clear();
  const auto append = [&](std::size_t column, double entry) {
    sliding_.column.push_back(column);
    sliding_.entry.push_back(entry);
  };
  for (std::size_t i = 0; i < n; ++i) {
    // A coordinate that sliding keeps constant, or moves as the surface does, has no other motion: not a rounding of
    // it.
    const bool held = static_cast<int>(i) == normal.only;
    const double push = held ? 0.0 : difference_[i];
    sliding_.diagonal[i] = held ? 0.0 : field.diagonal[i] - push * normal_[i];
    if (push != 0.0) {
      row_.assign(n, 0.0);
      for (std::size_t k = field.start[i]; k < field.start[i + 1]; ++k) row_[field.column[k]] = field.entry[k];
      for (std::size_t j = 0; j < n; ++j) {
        const double entry = row_[j] - push * normal_[j];
        if (j != i && entry != 0.0) append(j, entry);
      }
    } else if (!held) {
      for (std::size_t k = field.start[i]; k < field.start[i + 1]; ++k) append(field.column[k], field.entry[k]);
    }
    sliding_.start.push_back(sliding_.column.size());
    if (!sliding_.rate.empty()) sliding_.rate[i] = held ? 0.0 : field.rate[i] - push * rate;
  }
}

}  // namespace saltus::event_integrator
