#include "saltus/ode/straight_lines.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace saltus::ode {
namespace {

/// Parts are halved at most so often: 2^10 parts draw a step of a series over a hundred periods.
constexpr int most_halvings = 10;
/// Lines between samples have this part of the tolerance, those between what is chosen of them the rest. Samples are
/// halved, so a line over three of them is as long as it may be up to a third.
constexpr double share_of_samples = 0.0625;

}  // namespace

ColumnRanges::ColumnRanges(std::size_t columns, double share, const Tolerances& floor)
    : share_(share),
      floor_(floor),
      low_(columns, std::numeric_limits<double>::infinity()),
      high_(columns, -std::numeric_limits<double>::infinity()) {}

void ColumnRanges::widen(std::size_t first, std::span<const double> values) {
  double* low = low_.data() + first;
  double* high = high_.data() + first;
  for (std::size_t k = 0; k < values.size(); ++k) {
    const bool finite = values[k] - values[k] == 0.0;  // no branch: the loop is vectorised
    low[k] = std::min(low[k], finite ? values[k] : low[k]);
    high[k] = std::max(high[k], finite ? values[k] : high[k]);
  }
}

double ColumnRanges::tolerance(std::size_t column) const {
  if (!(low_[column] <= high_[column])) return floor_.atol;
  const double size = std::max(std::abs(low_[column]), std::abs(high_[column]));
  return std::max(share_ * (high_[column] - low_[column]), floor_.atol + floor_.rtol * size);
}

StraightLines::Sample StraightLines::sample(Curve curve, double theta) {
  const std::size_t place = values_.size();
  values_.resize(place + tolerance_->size());
  curve(theta, values_.data() + place);
  return {theta, place};
}

bool StraightLines::is_near_line(Sample from, Sample inside, Sample to, double share) const {
  const double part = (inside.theta - from.theta) / (to.theta - from.theta);
  for (std::size_t i = 0; i < tolerance_->size(); ++i) {
    const double left = values_[from.place + i], right = values_[to.place + i];
    const double distance = std::abs(values_[inside.place + i] - (left + part * (right - left)));
    if (distance > share * (*tolerance_)[i]) return false;
  }
  return true;
}

/// Appends samples between two, and the second one.
void StraightLines::divide(Curve curve, Sample from, Sample to, int depth) {
  const Sample middle = sample(curve, 0.5 * (from.theta + to.theta));
  bool is_line = is_near_line(from, middle, to, share_of_samples);
  if (is_line && depth == 0) {  // or it has an inflection on its chord
    constexpr double unsymmetric = 0.3;
    is_line = is_near_line(from, sample(curve, from.theta + unsymmetric * (to.theta - from.theta)), to, 0.5);
  }
  if (depth < most_halvings && !is_line) {
    divide(curve, from, middle, depth + 1);
    divide(curve, middle, to, depth + 1);
    return;
  }
  samples_.push_back(middle);
  samples_.push_back(to);
}

/// The farthest samples that lines reach.
void StraightLines::choose() {
  std::size_t kept = 0;
  for (std::size_t next = 2; next < samples_.size(); ++next) {
    bool reached = true;
    for (std::size_t inside = kept + 1; inside < next && reached; ++inside) {
      reached = is_near_line(samples_[kept], samples_[inside], samples_[next], 1.0 - share_of_samples);
    }
    if (reached) continue;
    kept = next - 1;
    points_.push_back(samples_[kept].theta);
  }
}

const std::vector<double>& StraightLines::points(Curve curve, double end, int parts,
                                                 const std::vector<double>& tolerance) {
  tolerance_ = &tolerance;
  values_.clear();
  samples_.clear();
  points_.clear();
  Sample from = sample(curve, 0.0);
  samples_.push_back(from);
  for (int k = 1; k <= parts; ++k) {
    const Sample to = sample(curve, k == parts ? end : end * (static_cast<double>(k) / parts));
    divide(curve, from, to, 0);
    from = to;
  }
  choose();
  return points_;
}

}  // namespace saltus::ode
