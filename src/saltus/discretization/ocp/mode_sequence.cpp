#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "saltus/discretization/ocp/element_trial_internal.hpp"
#include "saltus/discretization/ocp/mode_sequence_internal.hpp"

namespace saltus::discretization {
namespace {

/// Neighbours of equal modes are one stretch.
void join(Stretches& stretches) {
  for (auto stretch = stretches.begin(); stretch != stretches.end();) {
    const auto next = std::next(stretch);
    if (next == stretches.end() || next->modes != stretch->modes) {
      ++stretch;
      continue;
    }
    if (next->length > stretch->length) stretch->origin = next->origin;
    stretch->length += next->length;
    stretch->elements += next->elements;
    stretch->stands = stretch->stands && next->stands;
    stretches.erase(next);
  }
}

/// Gives one element less to a stretch whose elements are the shortest then, or leaves out one of length zero.
bool shorten(Stretches& stretches) {
  const auto empty = std::find_if(stretches.begin(), stretches.end(), [](const auto& s) { return s.has_vanished(); });
  if (empty != stretches.end() && stretches.size() > 1) {
    stretches.erase(empty);
    join(stretches);
    return true;
  }
  const auto behind = [](const Stretch& s) { return s.elements > 1 ? s.length / (s.elements - 1) : HUGE_VAL; };
  const auto least = std::min_element(stretches.begin(), stretches.end(),
                                      [&](const auto& a, const auto& b) { return behind(a) < behind(b); });
  if (least->elements == 1) return false;
  --least->elements;
  return true;
}

}  // namespace

bool fit(Stretches& stretches, int elements, double bound) {
  join(stretches);
  int count = 0;
  double sum = 0.0;
  for (const auto& stretch : stretches) sum += stretch.length;
  const auto weight = [&](const Stretch& s) {
    return s.stands && s.of_element() <= bound * sum ? 0.0 : s.of_element();
  };
  const auto recount = [&] {
    count = 0;
    for (const auto& stretch : stretches) count += stretch.elements;
    return count;
  };
  while (recount() > elements) {
    if (!shorten(stretches)) return false;
  }
  for (; count < elements; ++count) {
    ++std::max_element(stretches.begin(), stretches.end(), [&](const auto& a, const auto& b) {
        return weight(a) < weight(b);
      })->elements;
  }
  return true;
}

namespace {

class Writer {
 public:
  Writer(const OcpStructure& made, const ElementSides& modes, mpcc::ConstVectorView w)
      : made_(made), modes_(modes), w_(w), written_{modes.all(), w} {}

  void write(std::size_t k, const Stretches& stretches) {
    const auto& interval = made_.interval[k];
    double sum = 0.0;
    for (const auto& stretch : stretches) sum += stretch.length;
    const ElementTrial trial(made_, written_.w);
    auto e = at(interval.first_element);
    auto left = trial.left_of(e);
    bool is_solved = true;
    for (const auto& stretch : stretches) {
      if (!stretch.left.empty()) left = stretch.left;
      for (int i = 0; i < stretch.elements; ++i, ++e) {
        const bool has_own = stretch.own.size() > 0;
        const auto found =
            is_solved || has_own ? trial.solve(left, k, stretch.modes, stretch.of_element()) : std::nullopt;
        is_solved = is_solved && found;
        const auto [first, size] = std::pair(made_.element[e].first, made_.kernel.layout.size - 1);
        const linalg::Vector own = found     ? *found
                                   : has_own ? stretch.own
                                             : linalg::Vector(w_.segment(made_.element[stretch.origin].first, size));
        if (found || has_own) left = trial.right_of(own);
        written_.w.segment(first, size) = own;
        modes_.write(stretch.modes, e, written_.sides);
        set_length(e, stretch.of_element() / sum);
      }
    }
    const int speed = interval.shared[at(made_.kernel.shared.speed())];
    if (speed >= 0) written_.w[speed] = sum;
    written_.is_solved = written_.is_solved && is_solved;
  }

  [[nodiscard]] Realisation take() {
    written_.w = written_.w.at_least(made_.w_bounds.lower).at_most(made_.w_bounds.upper);
    return std::move(written_);
  }

 private:
  void set_length(std::size_t e, double share) {
    const int h = made_.element[e].length;
    if (h < 0) return;
    written_.w[h] = share;
    written_.has_room = written_.has_room && share <= made_.w_bounds.upper[h] + small_share;
  }

  const OcpStructure& made_;
  const ElementSides& modes_;
  mpcc::ConstVectorView w_;
  Realisation written_;
};

}  // namespace

Stretches stretches_of(const OcpStructure& made, const ElementSides& modes, mpcc::ConstVectorView w, std::size_t first,
                       std::size_t end) {
  const ElementTrial trial(made, w);
  Stretches stretches;
  for (std::size_t e = first; e < end; ++e) {
    stretches.push_back({.modes = modes.modes(e),
                         .length = trial.length_of(e),
                         .stands = trial.stands_still(trial.left_of(e), trial.own_of(e)),
                         .origin = e});
  }
  join(stretches);
  return stretches;
}

std::optional<Realisation> realise(const OcpStructure& made, const ElementSides& modes, mpcc::ConstVectorView w,
                                   ModeSequence sequence) {
  Writer writer(made, modes, w);
  for (auto& [k, stretches] : sequence) {
    const auto& interval = made.interval[k];
    const double bound = interval.lengths.empty() ? 1.0 : made.w_bounds.upper[interval.lengths.front()];
    if (!fit(stretches, interval.elements, bound)) return std::nullopt;
    writer.write(k, stretches);
  }
  return writer.take();
}

}  // namespace saltus::discretization
