#include "saltus/discretization/ocp/earlier_point_internal.hpp"

namespace saltus::discretization {

void Polynomial::add(double node, linalg::Vector value) {
  const auto is_same = [node](const auto& other) { return std::abs(other.first - node) <= 1e-12; };
  if (std::none_of(points_.begin(), points_.end(), is_same)) points_.emplace_back(node, std::move(value));
}

linalg::Vector Polynomial::at(double place) const {
  linalg::Vector sum = linalg::Vector::zero(points_.front().second.size());
  for (const auto& [node, value] : points_) {
    double weight = 1.0;
    for (const auto& [other, unused] : points_) {
      if (other != node) weight *= (place - other) / (node - other);
    }
    sum += weight * value;
  }
  return sum;
}

EarlierPoint::EarlierPoint(const OcpStructure& made, const OcpSolution& solution, mpcc::ConstVectorView w)
    : made_(made), w_(w) {
  find_least_at_start(solution);
  double begin = 0.0;
  linalg::Vector left = linalg::ConstView(solution.initial_state.data(), made.kernel.states);
  for (std::size_t k = 0; k < made.interval.size(); ++k) {
    const double length = solution.speed_of_time[k] * solution.horizon / made.intervals;
    for (std::size_t n = 0; n < solution.elements[k].size(); ++n) {
      const auto& solved = solution.elements[k][n];
      const auto e = at(made.interval[k].first_element) + n;
      if (solved.h > vanished * length) pieces_.push_back(piece_of(e, begin, solved, left));
      if (solved.h > vanished * length) begin += solved.h;
      left = solved.end;
    }
    nodes_.push_back(begin);
  }
}

/// The multiplier of a simplex is minus the least of its indicators.
void EarlierPoint::find_least_at_start(const OcpSolution& solution) {
  const auto& parts = made_.kernel.simplex_parts;
  least_at_start_.resize(static_cast<linalg::Index>(parts.size()));
  if (parts.empty()) return;
  std::vector<double> known = solution.parameters;
  const auto& sizes = made_.kernel.shared;
  for (int i = 0; i < sizes.held; ++i) {
    known.push_back(value(made_.interval.front().shared[at(sizes.controls + sizes.parameters + i)]));
  }
  known.insert(known.end(), solution.controls.front().begin(), solution.controls.front().end());
  const std::vector<casadi::DM> in{made_.from, solution.initial_state, known};
  const auto values = casadi::DM::densify(made_.kernel.indicator(in).front()).nonzeros();
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const auto first = values.begin() + parts[i].first;
    least_at_start_[static_cast<linalg::Index>(i)] = -*std::min_element(first, first + parts[i].second);
  }
}

double EarlierPoint::end_of(int k, int intervals) const {
  const int scaled = (k + 1) * made_.intervals;
  if (scaled % intervals == 0) return nodes_[at(scaled / intervals - 1)];
  const double share = static_cast<double>(k + 1) / intervals;
  if (made_.kernel.clock < 0) return share * nodes_.back();
  return where_clock_is(share * value(made_.horizon));
}

linalg::Vector EarlierPoint::sampled(const Piece& piece, const VariableBlock& block, double place) const {
  Polynomial polynomial;
  const auto& layout = made_.kernel.layout;
  if (block.first == layout.simplex.first) {
    polynomial.add(0.0, piece.element > 0 ? group_of(piece.element - 1, block, block.count - 1) : least_at_start_);
  }
  for (int group = 0; group < block.count; ++group) {
    polynomial.add(group < layout.stages ? made_.kernel.tableau.c[group] : 1.0, group_of(piece.element, block, group));
  }
  return polynomial.at(place);
}

bool EarlierPoint::stands(const Piece& piece) const {
  if (made_.kernel.clock < 0) return false;
  const double passed = piece.states.at(1.0)[made_.kernel.clock] - piece.states.at(0.0)[made_.kernel.clock];
  return passed <= vanished * value(made_.horizon) / made_.intervals;
}

Piece EarlierPoint::piece_of(std::size_t e, double begin, const SolvedElement& solved,
                             const linalg::Vector& left) const {
  Piece piece{.element = e, .begin = begin, .end = begin + solved.h, .modes = {}, .states = {}, .lambda = {}};
  const auto& c = made_.kernel.tableau.c;
  piece.states.add(0.0, left);
  for (linalg::Index m = 0; m < c.size(); ++m) piece.states.add(c[m], solved.states.col(m));
  piece.lambda.add(0.0, solved.lambda.col(0));
  for (linalg::Index m = 1; m < solved.lambda.cols(); ++m) {
    piece.lambda.add(m <= c.size() ? c[m - 1] : 1.0, solved.lambda.col(m));
  }
  const linalg::Vector selected = solved.selections.row_sums(), lambda = solved.lambda.row_sums();
  for (std::size_t k = 0; k < made_.kernel.pairs.size(); ++k) {
    const auto& pair = made_.kernel.pairs[k];
    const double side = selected[pair.selection];
    const double stages = static_cast<double>(solved.selections.cols());
    piece.modes.push_back(lambda[static_cast<linalg::Index>(k)] > (pair.complement ? stages - side : side));
  }
  return piece;
}

/// The time of the right-hand side at which the clock has come so far; behind what happens while it stands there.
double EarlierPoint::where_clock_is(double time) const {
  const int clock = made_.kernel.clock;
  const double start = pieces_.front().states.at(0.0)[clock];
  const double rounding = 1e-9 * value(made_.horizon);
  for (const auto& piece : pieces_) {
    const auto shown = [&](double place) { return piece.states.at(place)[clock] - start; };
    if (shown(1.0) <= time + rounding) continue;
    double low = 0.0, high = 1.0;
    for (int i = 0; i < 60 && shown(0.0) < time - rounding; ++i) {
      const double middle = 0.5 * (low + high);
      (shown(middle) < time ? low : high) = middle;
    }
    return piece.begin + low * (piece.end - piece.begin);
  }
  return nodes_.back();
}

}  // namespace saltus::discretization
