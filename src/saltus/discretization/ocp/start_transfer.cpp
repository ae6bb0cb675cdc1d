// A point of another grid as a start: its elements are cut where intervals of the new one end, and none of them is
// lost.
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "saltus/base/at.hpp"
#include "saltus/base/contracts.hpp"
#include "saltus/discretization/ocp/earlier_point_internal.hpp"

namespace saltus::discretization {
namespace {

using mpcc::ConstVectorView;

/// A section of equal modes within an interval, in equal parts.
struct Section {
  std::vector<const Piece*> pieces;
  double begin = 0.0, end = 0.0;
  int parts = 1;
  double factor = 1.0;  ///< of its length
  [[nodiscard]] double part() const { return factor * (end - begin) / parts; }
};

class StartTransfer {
 public:
  StartTransfer(const EarlierPoint& earlier, const OcpStructure& made, linalg::Vector& w)
      : earlier_(earlier), made_(made), kernel_(made.kernel), w_(w) {}

  void write() {
    double begin = 0.0;
    for (int k = 0; k < made_.intervals; ++k) {
      const double end = earlier_.end_of(k, made_.intervals);
      auto sections = sections_of(begin, end, made_.interval[at(k)].elements);
      begin = end;
      if (sections.empty()) continue;
      write_controls(at(k), sections);
      write_lengths(at(k), sections);
      write_elements(at(k), sections);
      if (!fit_standstills(at(k), sections)) continue;
      distribute(sections, made_.interval[at(k)].elements);
      write_lengths(at(k), sections);
      write_elements(at(k), sections);
    }
  }

 private:
  [[nodiscard]] std::vector<Section> sections_of(double begin, double end, int elements) const {
    std::vector<Section> list;
    for (const auto& piece : earlier_.pieces()) {
      const double from = std::max(piece.begin, begin), until = std::min(piece.end, end);
      if (until - from <= vanished * (end - begin)) continue;
      if (list.empty() || list.back().pieces.back()->modes != piece.modes) {
        list.push_back({.pieces = {&piece}, .begin = from, .end = until});
      } else {
        list.back().pieces.push_back(&piece);
        list.back().end = until;
      }
    }
    while (list.size() > at(elements)) {
      list.erase(std::min_element(list.begin(), list.end(),
                                  [](const auto& a, const auto& b) { return a.end - a.begin < b.end - b.begin; }));
    }
    if (!list.empty()) distribute(list, elements);
    return list;
  }

  static void distribute(std::vector<Section>& sections, int elements) {
    for (auto& section : sections) section.parts = 1;
    for (int n = static_cast<int>(sections.size()); n < elements; ++n) {
      ++std::max_element(sections.begin(), sections.end(), [](const auto& a, const auto& b) {
          return a.part() < b.part();
        })->parts;
    }
  }

  void set(int place, double value) {
    if (place >= 0) w_[place] = value;
  }

  /// Those of the longest section.
  void write_controls(std::size_t k, const std::vector<Section>& sections) {
    const auto longest = std::max_element(sections.begin(), sections.end(), [&](const Section& a, const Section& b) {
      const bool a_stands = earlier_.stands(*a.pieces.front()), b_stands = earlier_.stands(*b.pieces.front());
      return a_stands == b_stands ? a.end - a.begin < b.end - b.begin : a_stands;
    });
    const auto& shared = earlier_.shared(*longest->pieces.front());
    for (int i = 0; i < kernel_.shared.controls; ++i) {
      set(made_.interval[k].shared[at(i)], earlier_.value(shared[at(i)]));
    }
  }

  void write_lengths(std::size_t k, const std::vector<Section>& sections) {
    const auto& interval = made_.interval[k];
    double sum = 0.0;
    for (const auto& section : sections) sum += section.parts * section.part();
    const double unit = value_at(made_.horizon, w_, made_.constants) / made_.intervals;
    set(interval.shared[at(kernel_.shared.controls + kernel_.shared.parameters + kernel_.shared.held + 1)], sum / unit);
    auto length = interval.lengths.begin();
    for (const auto& section : sections) {
      for (int i = 0; i < section.parts && length != interval.lengths.end(); ++i) w_[*length++] = section.part() / sum;
    }
  }

  void write_elements(std::size_t k, const std::vector<Section>& sections) {
    auto e = at(made_.interval[k].first_element);
    for (const auto& section : sections) {
      const double part = (section.end - section.begin) / section.parts;
      for (int i = 0; i < section.parts; ++i) write_element(e++, section, section.begin + i * part, part);
    }
  }

  void write_element(std::size_t e, const Section& section, double begin, double length) {
    const auto& layout = kernel_.layout;
    const auto& c = kernel_.tableau.c;
    const bool integral = kernel_.options.representation == Representation::integral;
    const auto put = [&](const VariableBlock& block, int group, const linalg::Vector& value) {
      w_.segment(made_.element[e].variable(block.at(group)), block.size) = value;
    };
    for (int point = 0; point < layout.points(); ++point) {
      const double time = begin + (point < layout.stages ? c[point] : 1.0) * length;
      const auto& piece = piece_at(section, time);
      const double place = (time - piece.begin) / (piece.end - piece.begin);
      if (layout.lambda.size > 0) put(layout.lambda, point, piece.lambda.at(place));
      if (layout.simplex.size > 0) put(layout.simplex, point, earlier_.sampled(piece, layout.simplex, place));
      if (point == layout.stages) continue;
      put(layout.stage, point, integral ? piece.states.at(place) : earlier_.sampled(piece, layout.stage, place));
      if (layout.selection.size > 0) put(layout.selection, point, earlier_.sampled(piece, layout.selection, place));
      if (layout.lifted.size > 0) put(layout.lifted, point, earlier_.sampled(piece, layout.lifted, place));
    }
    const auto& last = piece_at(section, begin + length);
    if (layout.end_state.count > 0) {
      put(layout.end_state, 0, last.states.at((begin + length - last.begin) / (last.end - last.begin)));
    }
    if (layout.end_time.count > 0) w_[made_.element[e].variable(layout.end_time.first)] = made_.from + begin + length;
    for (int group = 0; group < layout.correction.count; ++group) {
      put(layout.correction, group, earlier_.group_of(last.element, layout.correction, group));
    }
  }

  [[nodiscard]] static const Piece& piece_at(const Section& section, double time) {
    for (const Piece* piece : section.pieces) {
      if (time <= piece->end) return *piece;
    }
    return *section.pieces.back();
  }

  /// While time stands still, rates may be others than in the earlier problem (time_freezing.transfer): so long, then,
  /// that equations hold.
  [[nodiscard]] bool fit_standstills(std::size_t k, std::vector<Section>& sections) const {
    bool has_changed = false;
    auto e = at(made_.interval[k].first_element);
    for (auto& section : sections) {
      if (earlier_.stands(*section.pieces.front())) section.factor = fitted_factor(e);
      has_changed = has_changed || section.factor != 1.0;
      e += at(section.parts);
    }
    return has_changed;
  }

  /// The equations are linear in the length of an element.
  [[nodiscard]] double fitted_factor(std::size_t e) const {
    std::vector<double> z;
    for (const int place : made_.element_places(static_cast<int>(e))) {
      z.push_back(value_at(place, w_, made_.constants));
    }
    auto& element = kernel_.element;
    const auto equations = [&] {
      std::vector<double> rows(at(element.equations() + 2 * element.pairs()));
      double objective = 0.0;
      element.values(z.data(), made_.local_parameters.data(), &objective, rows.data());
      return linalg::Vector(linalg::ConstView(rows.data(), element.equations()));
    };
    const linalg::Vector here = equations();
    z[z.size() - at(kernel_.layout.size) + at(kernel_.layout.h)] *= 2.0;
    const linalg::Vector change = equations() - here;
    const double factor = 1.0 - here.dot(change) / change.squared_norm();
    return std::isfinite(factor) && factor > 0.0 ? factor : 1.0;
  }

  const EarlierPoint& earlier_;
  const OcpStructure& made_;
  OcpKernel::Implementation& kernel_;
  linalg::Vector& w_;
};

}  // namespace

void OcpProblem::set_start(const OcpProblem& earlier, ConstVectorView w) {
  SALTUS_ASSERT(w.size() == earlier.variables());
  const auto& made = *implementation_->structure;
  const auto& before = *earlier.implementation_->structure;
  SALTUS_ASSERT(&made.kernel == &before.kernel);
  auto& start = implementation_->start;
  for (const auto& [to, from] :
       {std::pair(made.chain.border, before.chain.border), std::pair(made.chain.start, before.chain.start)}) {
    start.segment(to.first, to.count) = w.segment(from.first, from.count);
  }
  const EarlierPoint point(before, earlier.read(w), w);
  StartTransfer(point, made, start).write();
  start = start.at_least(made.w_bounds.lower).at_most(made.w_bounds.upper);
}

}  // namespace saltus::discretization
