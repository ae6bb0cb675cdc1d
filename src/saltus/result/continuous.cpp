#include "saltus/result/continuous.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <mutex>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/without_repeats.hpp"

namespace saltus::result {

Error outside(double t, double from, double until) {
  return {ErrorCode::invalid_option,
          fmt::format("t = {} lies outside the solution, which is known from {} to {}", t, from, until),
          "choose times within its span",
          {},
          {}};
}

bool append_row_at(double t, Side side, const Trajectory& rows, Trajectory& values) {
  const auto [first, last] = std::equal_range(rows.t.begin(), rows.t.end(), t);
  if (first == last) return false;
  const auto row = side == Side::before ? first - rows.t.begin() : last - rows.t.begin() - 1;
  values.append(rows, static_cast<std::size_t>(row));
  return true;
}

struct Continuous::Implementation {
  Trajectory rows;
  std::unique_ptr<Interior> interior;
  std::mutex mutex = {};
};

Continuous::Continuous(Trajectory rows, std::unique_ptr<Interior> interior)
    : implementation_(new Implementation{.rows = std::move(rows), .interior = std::move(interior)}) {}
Continuous::~Continuous() = default;

double moved_to_end(double t, double from, double until) {
  constexpr double roundings = 4.0 * std::numeric_limits<double>::epsilon();
  const double allowed = roundings * std::max(std::abs(from), std::abs(until));
  if (t < from && from - t <= allowed) return from;
  return t > until && t - until <= allowed ? until : t;
}

Expected<Trajectory> Continuous::at(const std::vector<double>& asked, Side side, const StepObserver& observer) {
  auto& [rows, interior, mutex] = *implementation_;
  const double from = rows.t.front(), until = rows.t.back();
  auto times = asked;
  for (double& t : times) t = moved_to_end(t, from, until);
  std::vector<double> inside;
  for (const double t : times) {
    if (!(from <= t && t <= until)) return tl::unexpected(outside(t, from, until));
    if (!std::binary_search(rows.t.begin(), rows.t.end(), t)) inside.push_back(t);
  }
  drop_repeats(inside);
  Trajectory found, simulated;
  if (!inside.empty()) {
    const std::lock_guard lock(mutex);
    found = interior->rows(inside);
    std::erase_if(inside, [&](double t) { return std::binary_search(found.t.begin(), found.t.end(), t); });
    if (!inside.empty()) {
      auto again = interior->again(inside, observer);
      if (!again) return tl::unexpected(again.error());
      simulated = std::move(*again);
    }
  }
  Trajectory values;
  for (const double t : times) {
    const bool known = append_row_at(t, side, rows, values) || append_row_at(t, side, found, values) ||
                       append_row_at(t, side, simulated, values);
    // What was stopped has got no further.
    if (!known) return tl::unexpected(outside(t, from, simulated.t.empty() ? until : simulated.t.back()));
  }
  return values;
}

}  // namespace saltus::result
