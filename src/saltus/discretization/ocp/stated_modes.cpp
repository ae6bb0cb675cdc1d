#include <algorithm>
#include <cmath>
#include <utility>

#include "saltus/discretization/ocp/stated_modes_internal.hpp"

namespace saltus::discretization {
namespace {

using mpcc::ActiveSide;

/// Multipliers off their surfaces are no smaller: a side that is zero has to be the smaller one.
constexpr double least_multiplier = 1e-3;

linalg::Vector between(const linalg::Vector& a, const linalg::Vector& b, double share) {
  return linalg::Vector((1.0 - share) * a + share * b);
}

}  // namespace

StatedModes::Modes StatedModes::modes_between(const Sample& a, const Sample& b) const {
  const auto& kernel = made_.kernel;
  const linalg::Vector sum = between(a.psi, b.psi, 0.5);
  Modes modes;
  for (const auto& pair : kernel.pairs) {
    const double value = sum[pair.selection];
    if (pair.is_region) {
      modes.push_back(ActiveSide::H);
      continue;
    }
    const double beyond = pair.complement ? value : -value;
    modes.push_back(beyond > on_surface ? ActiveSide::G : ActiveSide::H);
  }
  int first = 0;
  for (const auto& [selection, count] : kernel.simplex_parts) {
    while (!kernel.pairs[at(first)].is_region || kernel.pairs[at(first)].selection != selection) ++first;
    const double least = sum.segment(selection, count).min();
    for (int i = 0; i < count; ++i) {
      modes[at(first + i)] = sum[selection + i] > least + on_surface ? ActiveSide::G : ActiveSide::H;
    }
  }
  return modes;
}

/// A contact that closes does so in no time: while its rate is negative all else is as before, then as behind it.
void StatedModes::add_collisions(const Modes& before, const Modes& behind, Stretches& stretches) const {
  for (const auto& gap : made_.kernel.closing_gaps) {
    const bool was_open = before[at(gap.closed)] == ActiveSide::G;
    const bool is_closed = behind[at(gap.closed)] == ActiveSide::H;
    if (!was_open || !is_closed) continue;
    for (Modes modes : {before, behind}) {
      modes[at(gap.open)] = modes[at(gap.closing)] = ActiveSide::G;
      modes[at(gap.closed)] = ActiveSide::H;
      for (int k = gap.held; k >= 0 && k <= gap.held + 1; ++k) modes[at(k)] = before[at(k)];
      modes[at(gap.closing + (made_.kernel.pairs[at(gap.closing)].complement ? -1 : 1))] = ActiveSide::H;
      stretches.push_back({.modes = std::move(modes), .length = small_share, .stands = true});
    }
  }
}

Stretches StatedModes::stretches(const std::vector<Sample>& samples) {
  Stretches stretches;
  for (std::size_t i = 0; i + 1 < samples.size(); ++i) {
    auto modes = modes_between(samples[i], samples[i + 1]);
    if (!last_.empty()) add_collisions(last_, modes, stretches);
    last_ = modes;
    stretches.push_back({.modes = std::move(modes), .length = samples[i + 1].share - samples[i].share});
  }
  return stretches;
}

std::vector<StatedModes::Sample> StatedModes::samples(std::size_t k) const {
  const auto& kernel = made_.kernel;
  const int elements = made_.interval[k].elements;
  const int per_element = kernel.layout.stages + (kernel.tableau.ends_at_last_stage() ? 0 : 1);
  const std::size_t first = at(made_.interval[k].first_element * per_element);
  const auto state = [&](std::size_t row) {
    return linalg::Vector(linalg::ConstView(guess_.states[row].data(), kernel.states));
  };
  std::vector<Sample> list;
  const auto add = [&](double share, linalg::Vector x) {
    auto psi = indicator_(k, share, x);
    list.push_back({share, std::move(x), std::move(psi)});
  };
  add(0.0,
      first == 0 ? linalg::Vector(linalg::ConstView(guess_.initial_state.data(), kernel.states)) : state(first - 1));
  for (int row = 0; row < elements * per_element; ++row) {
    const int m = row % per_element;
    const double c = m < kernel.layout.stages ? kernel.tableau.c[m] : 1.0;
    add((row / per_element + c) / elements, state(first + at(row)));
  }
  return list;
}

void StatedModes::write() {
  for (std::size_t k = 0; k < made_.interval.size(); ++k) {
    const auto& interval = made_.interval[k];
    const auto known = samples(k);
    auto list = stretches(known);
    const double bound = interval.lengths.empty() ? 1.0 : made_.w_bounds.upper[interval.lengths.front()];
    if (!fit(list, interval.elements, bound)) continue;
    double sum = 0.0;
    for (const auto& stretch : list) sum += stretch.length;
    if (const int speed = interval.shared[at(made_.kernel.shared.speed())]; speed >= 0) w_[speed] = sum;
    auto e = at(interval.first_element);
    double share = 0.0;
    for (const auto& stretch : list) {
      for (int i = 0; i < stretch.elements; ++i, ++e) {
        if (const int h = made_.element[e].length; h >= 0) w_[h] = stretch.of_element() / sum;
        const double passes = stretch.stands ? 0.0 : stretch.of_element();
        write_element(e, stretch.modes, k, known, share, passes);
        share += passes;
      }
    }
  }
}

void StatedModes::write_element(std::size_t e, const Modes& modes, std::size_t k, const std::vector<Sample>& known,
                                double share, double passes) {
  const auto& layout = made_.kernel.layout;
  const auto& c = made_.kernel.tableau.c;
  for (int point = 0; point < layout.points(); ++point) {
    const double here = std::min(share + (point < layout.stages ? c[point] : 1.0) * passes, 1.0);
    const linalg::Vector x = state_at(known, here);
    const linalg::Vector psi = indicator_(k, here, x);
    if (point < layout.stages) {
      if (made_.kernel.options.representation == Representation::integral) {
        w_.segment(made_.element[e].variable(layout.stage.at(point)), layout.stage.size) = x;
      }
      write_selections(e, modes, point);
    }
    write_multipliers(e, modes, point, psi);
  }
}

linalg::Vector StatedModes::state_at(const std::vector<Sample>& known, double share) {
  std::size_t i = 1;
  while (i + 1 < known.size() && known[i].share < share) ++i;
  const auto &a = known[i - 1], &b = known[i];
  return between(a.x, b.x, (share - a.share) / (b.share - a.share));
}

void StatedModes::write_selections(std::size_t e, const Modes& modes, int stage) {
  const auto& kernel = made_.kernel;
  for (std::size_t p = 0; p < kernel.pairs.size(); ++p) {
    const auto& pair = kernel.pairs[p];
    double& value = w_[made_.element[e].variable(kernel.layout.selection.at(stage, pair.selection))];
    if (pair.is_region) {
      value = modes[p] == ActiveSide::G ? 0.0 : 1.0;
    } else if (!pair.complement) {
      value = modes[p] == ActiveSide::G ? 0.0 : modes[p + 1] == ActiveSide::G ? 1.0 : 0.5;
    }
  }
}

void StatedModes::write_multipliers(std::size_t e, const Modes& modes, int point, const linalg::Vector& psi) {
  const auto& kernel = made_.kernel;
  for (std::size_t p = 0; p < kernel.pairs.size(); ++p) {
    const double value = std::max(std::abs(psi[kernel.pairs[p].selection]), least_multiplier);
    w_[made_.element[e].variable(kernel.layout.lambda.at(point, static_cast<int>(p)))] =
        modes[p] == ActiveSide::G ? value : 0.0;
  }
}

}  // namespace saltus::discretization
