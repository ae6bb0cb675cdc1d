#include "saltus/fesd_integrator/element/active_set.hpp"

#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/base/contains.hpp"
#include "saltus/base/contracts.hpp"

namespace saltus::fesd_integrator {
ActiveSet::ActiveSet(std::span<const Part> parts, std::vector<int> modes)
    : modes_(std::move(modes)), fixed_(modes_.size(), 0.0), references_(modes_.size(), -1) {
  for (const Part& part : parts) {
    int reference = -1;
    for (int j = part.first; j < part.first + part.count; ++j) {
      const bool slides = modes_[at(j)] == 0;
      if (part.simplex && slides && reference < 0) {
        reference = j;
        fixed_[at(j)] = 1.0;
      } else if (slides) {
        sliding_.push_back({j, reference, {j, reference}});
      }
      if (!part.simplex && !slides) fixed_[at(j)] = modes_[at(j)] > 0 ? 1.0 : 0.0;
    }
    if (!part.simplex) continue;
    SALTUS_ASSERT(reference >= 0);
    for (int j = part.first; j < part.first + part.count; ++j) references_[at(j)] = reference;
  }
  for (const Part& part : parts) {
    int active = 0;
    for (int j = part.first; j < part.first + part.count; ++j) active += modes_[at(j)] == 0 ? 1 : 0;
    for (int j = part.first; j < part.first + part.count; ++j) {
      if (modes_[at(j)] != 0) {
        conditions_.push_back({Condition::Kind::side, j});
      } else if (!part.simplex || active > 1) {
        conditions_.push_back({Condition::Kind::lower, j});
        if (!part.simplex) conditions_.push_back({Condition::Kind::upper, j});
      }
    }
  }
}

void ActiveSet::selections(const double* unknown, double* all) const {
  for (std::size_t j = 0; j < fixed_.size(); ++j) all[j] = fixed_[j];
  for (std::size_t k = 0; k < sliding_.size(); ++k) {
    all[at(sliding_[k].selection)] = unknown[k];
    if (sliding_[k].reference >= 0) all[at(sliding_[k].reference)] -= unknown[k];
  }
}

void ActiveSet::unknowns(const double* all, double* unknown) const {
  for (std::size_t k = 0; k < sliding_.size(); ++k) unknown[k] = all[at(sliding_[k].selection)];
}

std::vector<double> ActiveSet::middle() const {
  std::vector<double> unknown(sliding_.size(), 0.5);
  for (std::size_t k = 0; k < unknown.size(); ++k) {
    if (sliding_[k].reference >= 0) unknown[k] = 1.0 / static_cast<double>(sliding_.size() + 1);
  }
  return unknown;
}

void ActiveSet::set_balances(std::vector<switching::Balance> balances) {
  balances_ = std::move(balances);
  undetermined_.assign(modes_.size(), false);
  for (const auto& balance : balances_) {
    for (const std::size_t k : balance.rows) undetermined_[at(sliding_[k].selection)] = true;
  }
}

void ActiveSet::set_resting(std::vector<Surface> surfaces, const std::vector<int>& unasked) {
  resting_ = std::move(surfaces);
  std::erase_if(conditions_, [&](const Condition& condition) {
    return condition.kind == Condition::Kind::side && contains(unasked, condition.selection);
  });
}

void ActiveSet::hold(int selection, Surface surface) {
  for (Sliding& entry : sliding_) {
    if (entry.selection == selection) entry.surface = surface;
  }
  if (surface.reference >= 0) return;
  const int other = surface.indicator;
  std::erase_if(sliding_, [&](const Sliding& entry) { return entry.selection == other; });
  std::erase_if(conditions_, [&](const Condition& condition) { return condition.selection == other; });
  fixed_[at(other)] = 0.5;
}

double ActiveSet::side(int selection, const double* indicator) const {
  const int reference = references_[at(selection)];
  if (reference >= 0) return indicator[at(selection)] - indicator[at(reference)];
  return modes_[at(selection)] * indicator[at(selection)];
}

}  // namespace saltus::fesd_integrator
