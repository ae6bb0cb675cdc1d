#include "saltus/fesd_integrator/decide/rests.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/base/contains.hpp"
#include "saltus/fesd_integrator/decide/surface_modes.hpp"
#include "saltus/linalg/matrix.hpp"

namespace saltus::fesd_integrator {
namespace {

using linalg::Vector;

Vector gradient_of(const Surface& surface, const discretization::StageValues& at_point) {
  Vector gradient = Vector::zero(index(at_point.f.size()));
  const auto add = [&](int row, double factor) {
    visit_row(at_point.pattern->indicator_x, at_point.indicator_x, at(row),
              [&](std::size_t i, double value) { gradient[index(i)] += factor * value; });
  };
  add(surface.indicator, surface.reference < 0 ? 1.0 : -1.0);
  if (surface.reference >= 0) add(surface.reference, 1.0);
  return gradient;
}

/// f in region a less f in region b.
Vector jump_of(int a, int b, const discretization::StageValues& at_point) {
  Vector jump = Vector::zero(index(at_point.f.size()));
  for (const auto& [selection, factor] : {std::pair{a, 1.0}, std::pair{b, -1.0}}) {
    visit_column(at_point.pattern->f_selection, at_point.f_selection, at(selection),
                 [&jump, factor = factor](std::size_t i, double value) { jump[index(i)] += factor * value; });
  }
  return jump;
}

/// How much the number of a region on side -1 of a surface is above that beside it on side 1.
int step_across(const Part& part, int surface) { return 1 << (part.surfaces - 1 - surface); }

/// The region that is on this side of a surface, and else where `region` is.
int region_on(const Part& part, int region, int surface, int side) {
  return region + (part.side(region, surface) - side) / 2 * step_across(part, surface);
}

}  // namespace

Rests::Rests(const discretization::StageKernel& kernel, std::span<const Part> parts)
    : kernel_(kernel), parts_(parts), functions_(kernel.selections()) {
  for (auto* values : {&values_, &ahead_, &behind_}) kernel.size(*values);
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const Part& part = parts[p];
    const int number = static_cast<int>(p);
    first_of_.push_back(static_cast<int>(functions_.size()));
    for (int j = part.first; j < part.first + part.count; ++j) functions_[at(j)] = {number, {j}};
    for (int k = 0; k < part.surfaces; ++k) {
      functions_.push_back({number, {part.first, part.first + step_across(part, k)}, k});
    }
  }
  governors_.assign(functions_.size(), -1);
  sides_.assign(functions_.size(), 0);
  held_sides_.assign(functions_.size(), 0);
}

std::vector<int> Rests::zeros_among(const std::vector<int>& members) const {
  std::vector<int> zeros;
  for (const int j : members) {
    if (!parts_[at(functions_[at(j)].part)].simplex) zeros.push_back(j);
  }
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    const auto modes = surface_modes(parts_[p], [&](int region) { return contains(members, region); });
    const bool some = std::any_of(members.begin(), members.end(),
                                  [&](int j) { return functions_[at(j)].part == static_cast<int>(p); });
    for (std::size_t k = 0; some && k < modes.size(); ++k) {
      if (modes[k] == 0) zeros.push_back(first_of_[p] + static_cast<int>(k));
    }
  }
  return zeros;
}

/// The values in the middle of all selections, and a little ahead of the point and behind it along f.
void Rests::find_slopes(const Place& place) {
  selections_.assign(kernel_.selections(), 0.5);
  for (const Part& part : parts_) {
    if (part.simplex) std::fill_n(selections_.begin() + part.first, part.count, 1.0 / part.count);
  }
  kernel_.evaluate(place.t, place.x.data(), selections_.data(), place.held, values_);
  double fastest = 0.0;
  for (const double rate : values_.f) fastest = std::max(fastest, std::abs(rate));
  constexpr double small = 1e-6;
  step_ = fastest > 0.0 ? small * place.size / fastest : 0.0;
  std::vector<double> x(place.x.size());
  for (const double sign : {1.0, -1.0}) {
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = place.x[i] + sign * step_ * values_.f[i];
    kernel_.evaluate(place.t, x.data(), selections_.data(), place.held, sign > 0.0 ? ahead_ : behind_);
  }
}

/// Whether d psi_j / dt is zero and has the gradient of psi_r times c > 0, but for a multiple of that of psi_j.
bool Rests::follows(int j, int r, double size) const {
  const Surface& surface = functions_[at(j)].surface;
  const Vector own = gradient_of(surface, values_), other = gradient_of(functions_[at(r)].surface, values_);
  Vector slope = Vector::zero(own.size());
  if (step_ > 0.0) slope = (gradient_of(surface, ahead_) - gradient_of(surface, behind_)) / (2.0 * step_);
  for (linalg::Index k = 0; k < own.size(); ++k) {
    visit_column(values_.pattern->f_x, values_.f_x, static_cast<std::size_t>(k),
                 [&](std::size_t i, double value) { slope[k] += own[index(i)] * value; });
  }
  const double rate = own.dot(linalg::ConstView(values_.f));
  constexpr double zero = 1e-9;
  if (std::abs(rate) > zero * size * slope.max_abs()) return false;
  const double oo = own.squared_norm(), ou = own.dot(other), uu = other.squared_norm();
  const double determinant = oo * uu - ou * ou;
  if (!(determinant > 1e-12 * oo * uu)) return false;
  const double of_own = (uu * own.dot(slope) - ou * other.dot(slope)) / determinant;
  const double of_other = (oo * other.dot(slope) - ou * own.dot(slope)) / determinant;
  constexpr double rounding = 1e-6;  // of differences
  const Vector rest = slope - of_own * own - of_other * other;
  return of_other > 0.0 && rest.max_abs() <= rounding * slope.max_abs();
}

/// The sides of `of` on which the selection of `other` acts on nothing.
std::vector<int> Rests::idle_sides(const Place& place, int of, int other) {
  std::vector<int> idle;
  const bool simplex = parts_[at(functions_[at(of)].part)].simplex;
  for (const int side : {1, -1}) {
    bool acts = false;
    if (simplex) {
      acts = acts_on(side, of, other);
    } else {
      selections_[at(of)] = side > 0 ? 1.0 : 0.0;
      kernel_.evaluate(place.t, place.x.data(), selections_.data(), place.held, ahead_);
      selections_[at(of)] = 0.5;
      visit_column(ahead_.pattern->f_selection, ahead_.f_selection, at(other),
                   [&](std::size_t, double value) { acts = acts || value != 0.0; });
    }
    if (!acts) idle.push_back(side);
  }
  return idle;
}

/// Whether regions on this side of a surface that are on both sides of another one differ.
bool Rests::acts_on(int side, int of, int other) const {
  const Part& part = parts_[at(functions_[at(of)].part)];
  const int own = functions_[at(of)].number, across = functions_[at(other)].number;
  for (int region = part.first; region < part.first + part.count; ++region) {
    if (part.side(region, own) != side || part.side(region, across) != 1) continue;
    if (!jump_of(region, region_on(part, region, across, -1), values_).is_zero()) return true;
  }
  return false;
}

/// What the sides of psi_j are apart in the rate of psi_r, on this side of it.
double Rests::jump_on(int side, int j, int r) const {
  const Part& part = parts_[at(functions_[at(j)].part)];
  const int own = functions_[at(j)].number;
  const int above = region_on(part, part.first, functions_[at(r)].number, side);
  const Vector gradient = gradient_of(functions_[at(r)].surface, values_);
  return std::abs(gradient.dot(jump_of(above, region_on(part, above, own, -1), values_)));
}

void Rests::find(const Place& place, const std::vector<int>& members) {
  std::fill(governors_.begin(), governors_.end(), -1);
  const auto zeros = zeros_among(members);
  if (zeros.size() < 2) return;
  find_slopes(place);
  std::vector<std::pair<int, int>> pairs;
  for (const int j : zeros) {
    if (functions_[at(j)].surface.value(values_.indicator_t.data()) != 0.0) continue;
    const auto r = std::find_if(zeros.begin(), zeros.end(), [&](int k) {
      return k != j && functions_[at(k)].part == functions_[at(j)].part && follows(j, k, place.size);
    });
    if (r != zeros.end()) pairs.emplace_back(j, *r);
  }
  for (const auto& [j, r] : pairs) {
    const auto idle = idle_sides(place, j, r), own = idle_sides(place, r, j);
    if (idle.empty() || (!own.empty() && own != idle)) continue;
    governors_[at(j)] = r;
    sides_[at(j)] = own.empty() ? 0 : -idle.front();
    const bool simplex = parts_[at(functions_[at(j)].part)].simplex;
    if (simplex && own.empty()) held_sides_[at(j)] = jump_on(1, j, r) > jump_on(-1, j, r) ? 1 : -1;
  }
}

bool Rests::any() const {
  return std::any_of(governors_.begin(), governors_.end(), [](int governor) { return governor >= 0; });
}

bool Rests::allow(const std::vector<int>& functions, std::span<const int> modes) const {
  for (std::size_t k = 0; k < modes.size(); ++k) {
    const int j = functions[k];
    if (j < 0) continue;
    const auto end = functions.begin() + index(modes.size());
    const auto found = std::find(functions.begin(), end, governor(j));
    if (governor(j) < 0 || found == end) continue;
    const int mode = modes[at(found - functions.begin())];
    if (modes[k] != (mode != 0 ? mode : sides_[at(j)])) return false;
  }
  return true;
}

void Rests::put_into(ActiveSet& set) const {
  std::vector<Surface> resting;
  std::vector<int> unasked;
  for (std::size_t j = 0; j < set.modes().size(); ++j) {
    const int governor = governors_[j];
    if (governor < 0 || set.modes()[at(governor)] != 0) continue;
    if ((set.modes()[j] == 0) != (sides_[j] == 0)) continue;
    if (sides_[j] == 0) set.hold(static_cast<int>(j), {governor});
    resting.push_back(functions_[j].surface);
    unasked.push_back(static_cast<int>(j));
  }
  for (std::size_t p = 0; p < parts_.size(); ++p) put_into_simplex(static_cast<int>(p), set, resting, unasked);
  set.set_resting(std::move(resting), unasked);
}

/// The same of regions: which of them are active says what slides.
void Rests::put_into_simplex(int p, ActiveSet& set, std::vector<Surface>& resting, std::vector<int>& unasked) const {
  const Part& part = parts_[at(p)];
  const auto modes = surface_modes(part, [&](int region) { return set.modes()[at(region)] == 0; });
  std::vector<std::pair<int, int>> held;  // a surface, and the one that its regions keep instead
  std::vector<int> at_rest;               // surfaces whose side is nothing of a region's own
  const int reference = set.reference(part.first);
  for (int k = 0; k < part.surfaces; ++k) {
    const int j = function(p, k);
    if (governor(j) < 0) continue;
    const int other = functions_[at(governor(j))].number;
    if (holds(j) ? modes[at(k)] != 0 || modes[at(other)] != held_sides_[at(j)]
                 : modes[at(k)] != sides_[at(j)] || modes[at(other)] != 0) {
      continue;
    }
    at_rest.push_back(k);
    resting.push_back({region_on(part, reference, k, 1), region_on(part, reference, k, -1)});
    if (!holds(j)) continue;
    at_rest.push_back(other);
    held.emplace_back(k, other);
  }
  if (at_rest.empty()) return;
  const auto kept = [&](int region) {
    for (const auto& [k, other] : held) region = region_on(part, region, other, part.side(region, k));
    for (const auto& [k, other] : held) region = region_on(part, region, k, 1);
    return region;
  };
  const auto sliding = set.sliding();
  for (const Sliding& entry : sliding) {
    if (entry.selection < part.first || entry.selection >= part.first + part.count) continue;
    set.hold(entry.selection, {kept(entry.selection), kept(entry.reference)});
  }
  for (int region = part.first; region < part.first + part.count; ++region) {
    const bool beside = std::any_of(at_rest.begin(), at_rest.end(),
                                    [&](int k) { return part.side(region, k) != part.side(reference, k); });
    if (beside) unasked.push_back(region);
  }
}

}  // namespace saltus::fesd_integrator
