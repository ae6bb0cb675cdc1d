#include "saltus/event_integrator/field/higher_order.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "saltus/event_integrator/mode/small_internal.hpp"
#include "saltus/linalg/factors.hpp"

namespace saltus::event_integrator {
namespace {

/// Differences of velocities, which are good to about ten digits.
constexpr double velocity_digits = 1e-8;

}  // namespace

void read_nested(const std::vector<NestedSelection>& nested, std::vector<double>& alpha) {
  for (const auto& [function, inside, selections] : nested) {
    std::size_t region = 0;
    for (std::size_t i = 0; i < inside.size(); ++i) region |= std::size_t{alpha[at(inside[i])] > 0.5} << i;
    alpha[at(function)] = selections[region];
  }
}

HigherOrderField::HigherOrderField(const evaluation::ModelKernel& kernel)
    : kernel_(kernel),
      functions_(kernel),
      motion_(at(kernel.states())),
      x_(motion_.size()),
      base_(motion_.size()),
      f_(motion_.size()) {}

void HigherOrderField::enter(const HigherOrderSet& set, const std::vector<int>& sliding,
                             const std::vector<double>& alpha) {
  set_ = set;
  sliding_ = sliding;
  alpha_ = alpha;
  for (const int j : sliding_) alpha_[at(j)] = 0.5;
  functions_.set(set_.functions, alpha_);
  trial_ = alpha_;
  ranges_.clear();
  coupled_.assign(set_.balances.size(), {});
  std::size_t corners = 0;
  for (const auto& balance : set_.balances) {
    if (balance.functions.size() == 1) corners = std::max(corners, std::size_t{1} << balance.rows.size());
  }
  corners_.assign(corners, std::vector<double>(motion_.size()));
  velocities_.assign(corners, 0.0);
}

/// The selections of a region that meets at the surfaces of a balance, into trial_.
void HigherOrderField::set_corner(const Balance& balance, std::size_t corner) {
  for (std::size_t i = 0; i < balance.rows.size(); ++i) {
    trial_[at(sliding_[balance.rows[i]])] = selection(corner, i);
  }
  read_nested(set_.nested, trial_);
}

void HigherOrderField::evaluate(const Balance& balance, BalanceRange& range, double t, const double* x) {
  const std::size_t corners = std::size_t{1} << balance.rows.size();
  range = {};
  trial_ = functions_.alpha();
  for (std::size_t corner = 0; corner < corners; ++corner) {
    set_corner(balance, corner);
    kernel_.field(t, x, trial_.data(), corners_[corner].data());
    const double velocity = functions_.velocity(balance.functions.front(), corners_[corner]);
    velocities_[corner] = velocity;
    range.terms = std::max(range.terms, functions_.velocity_terms(balance.functions.front(), corners_[corner]));
    // NOTE: a NaN stays in both, whatever comes behind it.
    if (corner == 0 || !(velocity >= range.min)) {
      range.min = velocity;
      range.lowest = corner;
    }
    if (corner == 0 || !(velocity <= range.max)) {
      range.max = velocity;
      range.highest = corner;
    }
  }
}

/// Whether all selections that fulfil a balance give the same field: f is a function of its velocity then.
bool HigherOrderField::determines(const Balance& balance, const BalanceRange& range) const {
  if (balance.rows.size() < 2) return true;
  const std::size_t corners = std::size_t{1} << balance.rows.size();
  const auto& low = corners_[range.lowest];
  const auto& high = corners_[range.highest];
  for (std::size_t corner = 0; corner < corners; ++corner) {
    const double share = (velocities_[corner] - range.min) / (range.max - range.min);
    for (std::size_t i = 0; i < low.size(); ++i) {
      const double size = std::max({std::abs(low[i]), std::abs(high[i]), std::abs(corners_[corner][i])});
      const double difference = corners_[corner][i] - (low[i] + share * (high[i] - low[i]));
      if (!(std::abs(difference) <= velocity_digits * size)) return false;
    }
  }
  return true;
}

/// A balance of one function: whether the motion is determined.
bool HigherOrderField::hold_one(std::size_t b, double t, const double* x) {
  const auto& balance = set_.balances[b];
  BalanceRange range;
  evaluate(balance, range, t, x);
  range.balance = b;
  range.row = balance.rows.front();
  // Gradients by differences leave five digits less.
  range.exactness = set_.functions[balance.functions.front()].order == 0 ? 1.0 : 0x1p17;
  const double share = range.min / (range.min - range.max);
  set_corner(balance, range.lowest);
  low_ = trial_;
  set_corner(balance, range.highest);
  const auto place = [&](int j) { alpha_[at(j)] = low_[at(j)] + share * (trial_[at(j)] - low_[at(j)]); };
  for (const std::size_t row : balance.rows) place(sliding_[row]);
  for (const auto& nested : set_.nested) place(nested.function);
  ranges_.push_back(range);
  // Between two regions f of the selections is not on the line between theirs where nested ones multiply those inside.
  const std::size_t function = balance.functions.front();
  if (functions_.is_beside_root(function) || !set_.nested.empty()) {
    auto& jump = jumps_.emplace_back(Jump{function, range.max - range.min, corners_[range.highest]});
    for (std::size_t i = 0; i < jump.field.size(); ++i) jump.field[i] -= corners_[range.lowest][i];
  }
  return determines(balance, range);
}

/// As ModeField does where nothing is held with higher order, and where selections multiply each other.
void HigherOrderField::balance_beside_roots() {
  for (const auto& jump : jumps_) {
    const double factor = functions_.velocity(jump.function, motion_) / jump.velocity;
    for (std::size_t i = 0; i < motion_.size(); ++i) motion_[i] -= jump.field[i] * factor;
  }
}

/// f with the selections of a balance at 0, and what each of them adds to it at 1.
void HigherOrderField::find_jumps(const Balance& balance, linalg::Matrix& jumps, double t, const double* x) {
  const auto q = static_cast<linalg::Index>(balance.rows.size());
  trial_ = functions_.alpha();
  for (const std::size_t row : balance.rows) trial_[at(sliding_[row])] = 0.0;
  kernel_.field(t, x, trial_.data(), base_.data());
  jumps.resize(kernel_.states(), q);
  for (linalg::Index i = 0; i < q; ++i) {
    double& selection = trial_[at(sliding_[balance.rows[at(i)]])];
    selection = 1.0;
    kernel_.field(t, x, trial_.data(), f_.data());
    selection = 0.0;
    for (linalg::Index k = 0; k < jumps.rows(); ++k) jumps(k, i) = f_[at(k)] - base_[at(k)];
  }
}

/// Whether f is a function of the velocities of the held functions: what selections that leave these add to f vanishes.
bool HigherOrderField::Coupled::determines_motion() {
  const bool decided = decided_jumps.size() == jumps.size();
  if (decided && jumps == decided_jumps && effects == decided_effects) return determined;
  decided_jumps = jumps;
  decided_effects = effects;
  const linalg::Matrix rest =
      jumps - linalg::least_squares(effects.transpose(), jumps.transpose()).transpose() * effects;
  determined = true;
  for (linalg::Index i = 0; i < rest.rows() && determined; ++i) {
    determined = rest.row(i).max_abs() <= velocity_digits * jumps.row(i).max_abs();
  }
  return determined;
}

/// A balance of several functions, with an exit per pair of facets: whether the motion is determined.
bool HigherOrderField::hold_several(std::size_t b, double t, const double* x) {
  const auto& balance = set_.balances[b];
  auto& coupled = coupled_[b];
  const auto q = static_cast<linalg::Index>(balance.rows.size());
  const auto r = static_cast<linalg::Index>(balance.functions.size());
  coupled.effects.resize(r, q);
  coupled.constant.resize(r);
  find_jumps(balance, coupled.jumps, t, x);
  for (linalg::Index k = 0; k < r; ++k) {
    coupled.constant[k] = functions_.velocity(balance.functions[at(k)], base_);
  }
  for (linalg::Index k = 0; k < r; ++k) {
    const auto row = functions_.rows().row(static_cast<linalg::Index>(balance.functions[at(k)]));
    linalg::multiply(row, coupled.jumps, coupled.effects.row(k));
  }
  const bool known = coupled.range.set(coupled.effects);
  too_many_ = too_many_ || !known;
  coupled.selections = coupled.central.solve(coupled.effects, coupled.constant);
  take_selections(b);
  const auto& facets = coupled.range.facets();
  // Each surface stands for some pairs of facets, of which the nearest one says when.
  for (std::size_t i = 0; i < balance.rows.size(); ++i) {
    BalanceRange range;
    range.min = -1.0;
    range.max = 1.0;
    range.balance = b;
    range.row = balance.rows[i];
    for (std::size_t f = i; f < facets.size(); f += balance.rows.size()) {
      const auto span = coupled.range.span(f, coupled.constant);
      range.terms = std::max(range.terms, span.terms);
      const auto corner = [&](int sign) {
        std::size_t bits = 0;
        for (std::size_t k = 0; k < facets[f].sign.size(); ++k) {
          if (facets[f].sign[k] == sign) bits |= std::size_t{1} << k;
        }
        return bits;
      };
      if (span.max < range.max) {
        range.max = span.max;
        range.highest = corner(1);
        range.free_above = corner(0);
      }
      if (span.min > range.min) {
        range.min = span.min;
        range.lowest = corner(-1);
        range.free_below = corner(0);
      }
    }
    ranges_.push_back(range);
  }
  return known && coupled.determines_motion();
}

/// Those of a balance of several functions.
void HigherOrderField::take_selections(std::size_t b) {
  linalg::Index i = 0;
  for (const std::size_t row : set_.balances[b].rows) alpha_[at(sliding_[row])] = coupled_[b].selections[i++];
}

void HigherOrderField::evaluate(double t, const double* point) {
  // The field is that of the nearest point of the set: beside it, where an implicit method looks, too, it may be
  // undefined.
  std::copy(point, point + x_.size(), x_.begin());
  static_cast<void>(functions_.project(t, x_.data()));
  const double* x = x_.data();
  functions_.differentiate(t, x);
  ranges_.clear();
  jumps_.clear();
  too_many_ = false;
  bool determined = true;
  for (std::size_t b = 0; b < set_.balances.size(); ++b) {
    const bool one = set_.balances[b].functions.size() == 1;
    const bool held = one ? hold_one(b, t, x) : hold_several(b, t, x);
    determined = determined && held;
  }
  kernel_.field(t, x, alpha_.data(), motion_.data());
  balance_beside_roots();
  functions_.remove_normal_part(motion_);
  if (!determined) std::fill(motion_.begin(), motion_.end(), std::numeric_limits<double>::quiet_NaN());
  // What is recorded lies in the box.
  for (std::size_t b = 0; b < set_.balances.size(); ++b) {
    if (set_.balances[b].functions.size() == 1) continue;
    auto& coupled = coupled_[b];
    switching::bound_selections(coupled.effects, coupled.constant, coupled.selections);
    take_selections(b);
  }
}

}  // namespace saltus::event_integrator
