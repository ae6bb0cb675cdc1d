#include "saltus/pipeline/level_curves.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

namespace saltus::pipeline {
namespace {

constexpr int samples_of_an_interval = 2048;
constexpr int cells = level_curve_cells;
/// Halvings of an edge: its length below the rounding of its ends.
constexpr int halvings = 52;
/// Halvings of a chord's distance from the curve: to below level_curve_tolerance of the chord.
constexpr int bend_halvings = 16;
constexpr int deepest_bend = 6;

/// Points are in units of the box: both sides have length 1.
struct Point {
  double x = 0.0;
  double y = 0.0;
};

Point between(Point a, Point b, double part) { return {a.x + part * (b.x - a.x), a.y + part * (b.y - a.y)}; }

/// Where f changes its sign between part 0 (where it is `first`) and part 1.
template <class Positive>
double bisect(Positive positive, bool first, int steps) {
  double low = 0.0, high = 1.0;
  for (int i = 0; i < steps; ++i) {
    const double middle = 0.5 * (low + high);
    (positive(middle) == first ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

class MarchingSquares {
 public:
  MarchingSquares(FunctionRef<double(double, double)> f, Interval x, Interval y) : f_(f), x_(x), y_(y) {}

  std::vector<Polyline> run() {
    sample();
    for (int j = 0; j < cells; ++j) {
      for (int i = 0; i < cells; ++i) connect(i, j);
    }
    std::vector<Polyline> curves;
    // Open pieces from their ends, then what is left is closed.
    for (const std::size_t ends : {std::size_t{1}, std::size_t{2}}) {
      for (std::size_t edge = 0; edge < neighbours_.size(); ++edge) {
        if (degree(edge) == ends && !visited_[edge]) curves.push_back(trace(edge));
      }
    }
    return curves;
  }

 private:
  static constexpr std::size_t none = static_cast<std::size_t>(-1);
  static constexpr std::size_t nodes_per_side = cells + 1;

  [[nodiscard]] double value(Point p) const {
    return f_(x_.from + p.x * (x_.to - x_.from), y_.from + p.y * (y_.to - y_.from));
  }
  [[nodiscard]] static std::size_t node(int i, int j) {
    return static_cast<std::size_t>(j) * nodes_per_side + static_cast<std::size_t>(i);
  }
  /// Edges of node (i, j): 2 node to the right, 2 node + 1 upwards.
  [[nodiscard]] static std::size_t right(int i, int j) { return 2 * node(i, j); }
  [[nodiscard]] static std::size_t up(int i, int j) { return 2 * node(i, j) + 1; }
  [[nodiscard]] std::size_t degree(std::size_t edge) const {
    return static_cast<std::size_t>(neighbours_[edge][0] != none) +
           static_cast<std::size_t>(neighbours_[edge][1] != none);
  }

  void sample() {
    values_.resize(nodes_per_side * nodes_per_side);
    for (int j = 0; j <= cells; ++j) {
      for (int i = 0; i <= cells; ++i) values_[node(i, j)] = value({double(i) / cells, double(j) / cells});
    }
    neighbours_.assign(2 * values_.size(), {none, none});
    visited_.assign(neighbours_.size(), false);
  }

  void link(std::size_t a, std::size_t b) {
    neighbours_[a][neighbours_[a][0] == none ? 0 : 1] = b;
    neighbours_[b][neighbours_[b][0] == none ? 0 : 1] = a;
  }

  void connect(int i, int j) {
    // Counter-clockwise from the lower left; edge k runs from corner k to the next.
    const std::array corners{values_[node(i, j)], values_[node(i + 1, j)], values_[node(i + 1, j + 1)],
                             values_[node(i, j + 1)]};
    const std::array edges{right(i, j), up(i + 1, j), right(i, j + 1), up(i, j)};
    std::array<std::size_t, 4> crossed{};
    std::size_t count = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      if (!std::isfinite(corners[k])) return;
      if ((corners[k] > 0.0) != (corners[(k + 1) % 4] > 0.0)) crossed[count++] = edges[k];
    }
    if (count == 2) link(crossed[0], crossed[1]);
    if (count != 4) return;
    // A saddle: the middle says which corners belong together.
    const bool middle = value({(i + 0.5) / cells, (j + 0.5) / cells}) > 0.0;
    const bool around_first = middle != (corners[0] > 0.0);  // corner 0 is cut off, between edges 3 and 0
    link(crossed[0], crossed[around_first ? 3 : 1]);
    link(crossed[2], crossed[around_first ? 1 : 3]);
  }

  [[nodiscard]] Point vertex(std::size_t edge) const {
    const auto at = edge / 2;
    const Point a{double(at % nodes_per_side) / cells, double(at / nodes_per_side) / cells};
    const Point b = edge % 2 == 0 ? Point{a.x + 1.0 / cells, a.y} : Point{a.x, a.y + 1.0 / cells};
    const bool first = values_[at] > 0.0;
    return between(a, b, bisect([&](double part) { return value(between(a, b, part)) > 0.0; }, first, halvings));
  }

  /// The curve beside the middle of a chord, if it is further away than can be seen.
  [[nodiscard]] std::optional<Point> bend(Point a, Point b) const {
    const Point middle = between(a, b, 0.5);
    const Point across{0.5 * (a.y - b.y), 0.5 * (b.x - a.x)};
    const Point left{middle.x + across.x, middle.y + across.y}, right{middle.x - across.x, middle.y - across.y};
    const double at_left = value(left), at_right = value(right);
    if (!std::isfinite(at_left) || !std::isfinite(at_right) || (at_left > 0.0) == (at_right > 0.0)) return {};
    const double part =
        bisect([&](double s) { return value(between(left, right, s)) > 0.0; }, at_left > 0.0, bend_halvings);
    const double distance = std::abs(part - 0.5) * 2.0 * std::hypot(across.x, across.y);
    if (distance <= level_curve_tolerance) return {};
    return between(left, right, part);
  }

  void append(Polyline& curve, Point p) const {
    curve.x.push_back(x_.from + p.x * (x_.to - x_.from));
    curve.y.push_back(y_.from + p.y * (y_.to - y_.from));
  }

  void append_bends(Polyline& curve, Point a, Point b, int depth) const {
    const auto point = depth < deepest_bend ? bend(a, b) : std::nullopt;
    if (point) append_bends(curve, a, *point, depth + 1);
    if (point) append(curve, *point);
    if (point) append_bends(curve, *point, b, depth + 1);
  }

  Polyline trace(std::size_t start) {
    std::vector<Point> vertices;
    std::size_t edge = start;
    while (edge != none && !visited_[edge]) {
      visited_[edge] = true;
      vertices.push_back(vertex(edge));
      const auto& [a, b] = neighbours_[edge];
      edge = a != none && !visited_[a] ? a : b != none && !visited_[b] ? b : none;
    }
    if (degree(start) == 2) vertices.push_back(vertices.front());
    Polyline curve;
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      if (i > 0) append_bends(curve, vertices[i - 1], vertices[i], 0);
      append(curve, vertices[i]);
    }
    return curve;
  }

  FunctionRef<double(double, double)> f_;
  Interval x_, y_;
  std::vector<double> values_;
  std::vector<std::array<std::size_t, 2>> neighbours_;
  std::vector<bool> visited_;
};

}  // namespace

double change_of_sign(FunctionRef<bool(double)> inside) { return bisect(inside, inside(0.0), halvings); }

std::vector<double> sign_changes(FunctionRef<double(double)> f, Interval range) {
  std::vector<double> found;
  const auto at = [&](double i) { return range.from + (range.to - range.from) * (i / samples_of_an_interval); };
  double before = f(at(0));
  for (int i = 1; i <= samples_of_an_interval; ++i) {
    const double after = f(at(i));
    if (std::isfinite(before) && std::isfinite(after) && (before > 0.0) != (after > 0.0)) {
      const auto positive = [&](double part) { return f(at(i - 1 + part)) > 0.0; };
      found.push_back(at(i - 1 + bisect(positive, before > 0.0, halvings)));
    }
    before = after;
  }
  return found;
}

std::vector<Polyline> level_curves(FunctionRef<double(double, double)> f, Interval x, Interval y) {
  return MarchingSquares(f, x, y).run();
}

}  // namespace saltus::pipeline
