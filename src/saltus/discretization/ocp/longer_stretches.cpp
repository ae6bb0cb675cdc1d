// Stretches of equal modes whose elements are as long as they may be.
#include <algorithm>
#include <optional>
#include <utility>

#include "saltus/discretization/ocp/neighbours_internal.hpp"

namespace saltus::discretization {
namespace {

/// Elements of an interval between two changes of modes, first and one behind the last.
struct Stretch {
  std::size_t first = 0, end = 0;
};

/// The stretches of equal modes that end and begin at the boundary before element e, within its interval.
std::pair<Stretch, Stretch> stretches_at(const OcpStructure& made, const ElementSides& modes, std::size_t e) {
  const auto& interval = made.interval[at(made.element[e].interval)];
  const auto begin = static_cast<std::size_t>(interval.first_element);
  const auto end = begin + static_cast<std::size_t>(interval.elements);
  Stretch before{e - 1, e};
  while (before.first > begin && modes.are_equal(before.first - 1, before.first)) --before.first;
  Stretch after{e, e + 1};
  while (after.end < end && modes.are_equal(after.end - 1, after.end)) ++after.end;
  return {before, after};
}

/// The same total lengths of two stretches, in equal parts, behind their boundary has moved by one element.
linalg::Vector with_boundary(const OcpStructure& made, mpcc::ConstVectorView w, const Stretch& before,
                             const Stretch& after, std::size_t boundary) {
  linalg::Vector changed = w;
  const auto total = [&](const Stretch& stretch) {
    double sum = 0.0;
    for (std::size_t e = stretch.first; e < stretch.end; ++e) sum += w[made.element[e].length];
    return sum;
  };
  const double first = total(before) / static_cast<double>(boundary - before.first);
  const double second = total(after) / static_cast<double>(after.end - boundary);
  for (std::size_t e = before.first; e < after.end; ++e)
    changed[made.element[e].length] = e < boundary ? first : second;
  return changed;
}

/// What the bound of the lengths costs: the multipliers of equal lengths stand at one of them.
std::optional<double> price_of_bound(const SolvedBranch& branch, const Stretch& stretch) {
  if (branch.multipliers == nullptr) return std::nullopt;
  double price = 0.0;
  for (std::size_t e = stretch.first; e < stretch.end; ++e) {
    price = std::min(price, -branch.multipliers->upper[branch.made.element[e].length]);
  }
  return price;
}

/// One more element for a stretch next to the boundary before element e: where a length is at its upper bound a stretch
/// needs one to grow. The stretch that it is taken from has to keep one.
std::optional<mpcc::BranchMove> with_longer_stretch(const SolvedBranch& branch, std::size_t e) {
  const auto& [made, modes, w, multipliers] = branch;
  const auto is_longest = [&](std::size_t number) {
    const int h = made.element[number].length;
    return h >= 0 && w[h] > made.w_bounds.upper[h] - vanished;
  };
  if (made.element[e].number == 0 || (!is_longest(e - 1) && !is_longest(e))) return std::nullopt;
  if (modes.are_equal(e - 1, e)) return std::nullopt;
  const auto [before, after] = stretches_at(made, modes, e);
  if (is_longest(e - 1) && after.end - after.first > 1) {
    return mpcc::BranchMove{modes.copied(e - 1, e), with_boundary(made, w, before, after, e + 1),
                            price_of_bound(branch, before)};
  }
  if (is_longest(e) && before.end - before.first > 1) {
    return mpcc::BranchMove{modes.copied(e, e - 1), with_boundary(made, w, before, after, e - 1),
                            price_of_bound(branch, after)};
  }
  return std::nullopt;
}

}  // namespace

void add_longer_stretches(const SolvedBranch& branch, Moves& moves) {
  for (std::size_t e = 1; e < branch.made.element.size(); ++e) {
    if (auto move = with_longer_stretch(branch, e)) moves.push_back(std::move(*move));
  }
}

}  // namespace saltus::discretization
