#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/discretization/element_expressions_internal.hpp"
#include "saltus/discretization/ocp/element_trial_internal.hpp"
#include "saltus/discretization/ocp/ocp_problem_internal.hpp"
#include "saltus/discretization/ocp/surface_states_internal.hpp"

namespace saltus::discretization {
namespace {

using mpcc::ActiveSide;
using mpcc::ConstVectorView;
using Sides = std::vector<ActiveSide>;

/// The point with another share of the interval for one element; the others keep their ratios.
linalg::Vector with_share(const OcpStructure& made, ConstVectorView w, const OcpElement& element, double share) {
  linalg::Vector changed = w;
  const auto& lengths = made.interval[at(element.interval)].lengths;
  const double rest = 1.0 - w[element.length];
  for (const int h : lengths) {
    if (h == element.length) {
      changed[h] = share;
    } else {
      changed[h] =
          rest > vanished ? w[h] * (1.0 - share) / rest : (1.0 - share) / static_cast<double>(lengths.size() - 1);
    }
  }
  return changed;
}

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
linalg::Vector with_boundary(const OcpStructure& made, ConstVectorView w, const Stretch& before, const Stretch& after,
                             std::size_t boundary) {
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

/// The same point with one more element for a stretch next to the boundary before element e: where a length is at its
/// upper bound a stretch needs one to grow. The stretch that it is taken from has to keep one.
std::optional<mpcc::BranchMove> with_longer_stretch(const OcpStructure& made, const mpcc::BranchMove& point,
                                                    std::size_t e) {
  const auto is_longest = [&](std::size_t number) {
    const int h = made.element[number].length;
    return h >= 0 && point.start[h] > made.w_bounds.upper[h] - vanished;
  };
  if (made.element[e].number == 0 || (!is_longest(e - 1) && !is_longest(e))) return std::nullopt;
  const ElementSides modes(made, point.sides);
  if (modes.are_equal(e - 1, e)) return std::nullopt;
  const auto [before, after] = stretches_at(made, modes, e);
  if (is_longest(e - 1) && after.end - after.first > 1) {
    return mpcc::BranchMove{modes.copied(e - 1, e), with_boundary(made, point.start, before, after, e + 1)};
  }
  if (is_longest(e) && before.end - before.first > 1) {
    return mpcc::BranchMove{modes.copied(e, e - 1), with_boundary(made, point.start, before, after, e - 1)};
  }
  return std::nullopt;
}

/// First all stretches together: with a free horizon one boundary can often move only if the others do.
void add_longer_stretches(const OcpStructure& made, const Sides& sides, ConstVectorView w,
                          std::vector<mpcc::BranchMove>& moves) {
  const mpcc::BranchMove here{sides, w};
  mpcc::BranchMove all = here;
  std::vector<mpcc::BranchMove> single;
  for (std::size_t e = 1; e < made.element.size(); ++e) {
    if (auto move = with_longer_stretch(made, all, e)) all = std::move(*move);
    if (auto move = with_longer_stretch(made, here, e)) single.push_back(std::move(*move));
  }
  if (single.size() > 1) moves.push_back(std::move(all));
  for (auto& move : single) moves.push_back(std::move(move));
}

/// Moves switches at ends of intervals, over elements of length zero, into the next interval or the one before: one by
/// one and, as free parameters move all of them, together.
class MovedAcross {
 public:
  MovedAcross(const OcpStructure& made, const ElementSides& modes, ConstVectorView w)
      : made_(made), modes_(modes), later_{modes.all(), w}, earlier_{modes.all(), w}, w_(w) {}

  /// Adds what moves the switch before element e, the first of its interval.
  void add(std::size_t e, std::vector<mpcc::BranchMove>& moves) {
    std::size_t before = e - 1, after = e;
    add_between(before, after, e, moves);
    while (made_.element[before].number > 0 && is_empty(before)) --before;
    while (after + 1 < made_.element.size() && made_.element[after + 1].number > 0 && is_empty(after)) ++after;
    if (before + 1 < e || after > e) add_between(before, after, e, moves);
    if (modes_.are_equal(before, after)) return;
    ++switches_;
    move(before, before + 1, e, e, later_);
    move(after, e - 1, after - 1, e - 1, earlier_);
  }
  void add_all(std::vector<mpcc::BranchMove>& moves) {
    if (switches_ < 2) return;
    moves.push_back(std::move(later_));
    moves.push_back(std::move(earlier_));
  }

 private:
  [[nodiscard]] bool is_empty(std::size_t e) const {
    const int h = made_.element[e].length;
    return h >= 0 && w_[h] < vanished;
  }

  void add_between(std::size_t before, std::size_t after, std::size_t e, std::vector<mpcc::BranchMove>& moves) const {
    if (modes_.are_equal(before, after)) return;
    for (const bool is_later : {true, false}) {
      mpcc::BranchMove single{modes_.all(), w_};
      const bool can = is_later ? move(before, before + 1, e, e, single) : move(after, e - 1, after - 1, e - 1, single);
      if (can) moves.push_back(std::move(single));
    }
  }

  /// Gives the modes of element `from` to others, of which the last named grows; false where it may not be short.
  bool move(std::size_t from, std::size_t first, std::size_t last, std::size_t grows, mpcc::BranchMove& result) const {
    const auto& element = made_.element[grows];
    if (element.length < 0 || made_.w_bounds.lower[element.length] > small_share) return false;
    for (std::size_t e = first; e <= last; ++e) modes_.copy(from, e, result.sides);
    result.start = with_share(made_, result.start, element, small_share);
    return true;
  }

  const OcpStructure& made_;
  const ElementSides& modes_;
  mpcc::BranchMove later_, earlier_;  ///< all of them
  ConstVectorView w_;
  int switches_ = 0;
};

/// Lengths of the elements that have other modes than before.
void note_appearing(const OcpStructure& made, const ElementSides& modes, mpcc::BranchMove& move) {
  const ElementSides changed(made, move.sides);
  for (std::size_t e = 0; e < made.element.size(); ++e) {
    const int h = made.element[e].length;
    if (h >= 0 && move.start[h] > vanished && changed.modes(e) != modes.modes(e)) move.appearing.push_back(h);
  }
}

/// A selection that reaches its bound at the end of sliding.
struct Departure {
  int selection = 0;
  bool at_upper = false;
};

/// The one at the left end of element e, if nothing else happens there. A switch or a beginning of sliding is an
/// equation for the boundary, the end of sliding is none.
std::optional<Departure> departure_at(const OcpStructure& made, const ElementSides& modes, std::size_t e) {
  const auto& pairs = made.kernel.pairs;
  std::optional<Departure> departure;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    if (pairs[k].is_region) {
      // A region is active where lambda is zero: sliding ends where one of several becomes inactive.
      const bool was_active = modes.of(e - 1, k) == ActiveSide::H;
      const bool is_active = modes.of(e, k) == ActiveSide::H;
      if (!was_active && is_active) return std::nullopt;
      if (was_active && !is_active && !departure) departure = {.selection = pairs[k].selection, .at_upper = false};
      continue;
    }
    if (pairs[k].complement) continue;  // looked at together with the row before it
    const auto slides = [&](std::size_t element) {
      return modes.of(element, k) == ActiveSide::H && modes.of(element, k + 1) == ActiveSide::H;
    };
    const bool differs = modes.of(e - 1, k) != modes.of(e, k) || modes.of(e - 1, k + 1) != modes.of(e, k + 1);
    if (!differs) continue;
    if (!slides(e - 1)) return std::nullopt;
    const bool to_upper = modes.of(e, k + 1) == ActiveSide::G;
    if (!departure) departure = {.selection = pairs[k].selection, .at_upper = to_upper};
  }
  return departure;
}

/// Where the right end is a stage, the selection has its bound there; elsewhere it leaves its surface tangentially.
mpcc::BranchClosure::Freedom freedom_of(const OcpStructure& made, const ElementSides& modes) {
  mpcc::BranchClosure::Freedom freedom;
  const auto& kernel = made.kernel;
  for (std::size_t e = 1; e < made.element.size() && kernel.moves && !kernel.layout.has_end_point; ++e) {
    const auto departure = made.element[e].number > 0 ? departure_at(made, modes, e) : std::nullopt;
    if (!departure) continue;
    const int local = kernel.layout.selection.at(kernel.layout.stages - 1, departure->selection);
    (departure->at_upper ? freedom.at_upper : freedom.at_lower).push_back(made.element[e - 1].variable(local));
  }
  for (const auto& placed : made.functions) {
    if (!placed.is_dormant) continue;
    for (const auto& one : placed.copies) {
      const auto departure = departure_at(made, modes, static_cast<std::size_t>(one.element));
      if (departure) freedom.rows.push_back(one.first_row + departure->selection);
    }
  }
  return freedom;
}

/// ClosingGap: selections that stay where they are, at a bound.
void hold_closing_gaps(const OcpStructure& made, const ElementSides& modes, std::size_t e,
                       mpcc::BranchClosure& closure) {
  if (made.kernel.closing_gaps.empty()) return;
  for (const auto& held : held_while_closing(made.kernel, modes.modes(e))) {
    (held.at_upper ? closure.at_upper : closure.at_lower).push_back(made.element[e].variable(held.local));
  }
}

}  // namespace

mpcc::BranchClosure OcpProblem::close_branch(const Sides& sides) const {
  const auto& made = *implementation_->structure;
  const auto& kernel = made.kernel;
  mpcc::BranchClosure closure;
  closure.at_lower = made.boundary_own;
  for (const auto& placed : made.functions) {
    if (!placed.of_method) continue;
    for (const auto& one : placed.copies) {
      for (int i = 0; i < placed.function->equations(); ++i) closure.dropped_rows.push_back(one.first_row + i);
    }
  }
  const bool of_stages_only = kernel.options.cross_complementarity == CrossComplementarity::paper;
  const bool equal_lengths = kernel.moves && kernel.options.step_equilibration != StepEquilibration::none;
  const ElementSides modes(made, sides);
  for (std::size_t e = 0; e < made.element.size(); ++e) {
    // Complementarities of the same stage say nothing of the left end.
    const auto left = made.left_lambda(static_cast<int>(e));
    for (std::size_t k = 0; k < kernel.pairs.size() && of_stages_only; ++k) {
      if (modes.of(e, k) == ActiveSide::H && left[k] >= 0) closure.at_lower.push_back(left[k]);
    }
    hold_closing_gaps(made, modes, e, closure);
    if (!equal_lengths || made.element[e].number == 0 || !modes.are_equal(e - 1, e)) continue;
    closure.equal.emplace_back(made.element[e - 1].length, made.element[e].length);
  }
  closure.freedom = freedom_of(made, modes);
  return closure;
}

void OcpProblem::complete(mpcc::VectorView w) {
  const auto& made = *implementation_->structure;
  if (made.boundary_own.empty()) return;
  for (const int i : made.boundary_own) w[i] = 0.0;
  linalg::Vector c(rows());
  functions(w, c);
  const int equations = made.kernel.equilibration.equations();
  for (const auto& placed : made.functions) {
    if (placed.function != &made.kernel.equilibration) continue;
    auto own = made.boundary_own.begin();
    for (const auto& one : placed.copies) {
      const auto first_sides = c.segment(made.n_g + one.first_pair, placed.function->pairs());
      for (const double value : boundary_values(first_sides, c[one.first_row + equations - 1])) w[*own++] = value;
    }
  }
}

std::vector<int> OcpProblem::crowded_intervals(ConstVectorView w, const linalg::Vector& upper, double tolerance) const {
  const auto& made = *implementation_->structure;
  std::set<int> crowded = implementation_->crowded;
  for (const auto& element : made.element) {
    const int h = element.length;
    // A bound of 1 is none: the others are as short as they can be.
    if (h < 0 || upper.size() <= h || made.w_bounds.upper[h] >= 1.0 || !(upper[h] > tolerance)) continue;
    if (w[h] > made.w_bounds.upper[h] - vanished) crowded.insert(element.interval);
  }
  return {crowded.begin(), crowded.end()};
}

std::vector<mpcc::BranchMove> OcpProblem::equal_branches(const Sides& sides, ConstVectorView w) const {
  const auto& made = *implementation_->structure;
  std::vector<mpcc::BranchMove> moves;
  if (!made.kernel.moves || made.kernel.pairs.empty()) return moves;
  const ElementSides modes(made, sides);
  add_longer_stretches(made, sides, w, moves);
  MovedAcross across(made, modes, w);
  for (std::size_t e = 1; e < made.element.size(); ++e) {
    const auto& before = made.element[e - 1];
    const auto& after = made.element[e];
    if (after.number == 0) {
      across.add(e, moves);
      continue;
    }
    if (modes.are_equal(e - 1, e)) continue;
    if (w[after.length] < vanished) moves.push_back({modes.copied(e - 1, e), w});
    if (w[before.length] < vanished) moves.push_back({modes.copied(e, e - 1), w});
  }
  across.add_all(moves);
  add_moved_standstills(made, modes, w, moves);
  const auto functions = [&](const linalg::Vector& point) {
    linalg::Vector c(rows());
    implementation_->functions(point, c);
    return c;
  };
  add_void_sides(made, modes, w, functions, moves);
  implementation_->crowded.clear();
  add_touched_sides(made, modes, w, implementation_->crowded, moves);
  add_grazed_sides(made, modes, w, implementation_->crowded, moves);
  add_reached_regions(made, modes, w, moves);
  for (auto& move : moves) note_appearing(made, modes, move);
  return moves;
}

}  // namespace saltus::discretization
