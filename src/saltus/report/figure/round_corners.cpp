#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "saltus/report/figure/figure_columns_internal.hpp"

namespace saltus::report {
namespace {

/// In pixels: so far may a curve be from the line between two rows, and lines between points from the curve.
constexpr double most_apart = 1.5, least_apart = 0.05;

Point combined(double a, Point p, double b, Point q) { return {a * p.x + b * q.x, a * p.y + b * q.y}; }

/// Rates in time at points of a smooth curve, three at least: those of parabolas.
std::vector<Point> rates_of(std::span<const Point> points, std::span<const double> t) {
  const std::size_t last = points.size() - 1;
  std::vector<Point> secants, rates(points.size());
  for (std::size_t i = 0; i < last; ++i) {
    const double h = t[i + 1] - t[i];
    secants.push_back(combined(1.0 / h, points[i + 1], -1.0 / h, points[i]));
  }
  for (std::size_t i = 1; i < last; ++i) {
    const double part = (t[i] - t[i - 1]) / (t[i + 1] - t[i - 1]);
    rates[i] = combined(1.0 - part, secants[i - 1], part, secants[i]);
  }
  rates[0] = combined(2.0, secants[0], -1.0, rates[1]);
  rates[last] = combined(2.0, secants[last - 1], -1.0, rates[last - 1]);
  return rates;
}

/// Appends points of the cubic with these rates (times its duration) at its ends, and `to`.
void append_cubic(Point from, Point to, Point rate_from, Point rate_to, std::vector<Point>& line) {
  const Point chord = combined(1.0, to, -1.0, from);
  const double length = std::hypot(chord.x, chord.y);
  const auto along = [&](Point v) { return (v.x * chord.x + v.y * chord.y) / length; };
  const auto across = [&](Point v) { return (v.y * chord.x - v.x * chord.y) / length; };
  const double apart = 0.25 * std::max(std::abs(across(rate_from)), std::abs(across(rate_to)));
  const double least = std::min(along(rate_from), along(rate_to)), most = std::max(along(rate_from), along(rate_to));
  // One that turns back, or is far away, goes round something that the rows do not show.
  const bool follows = least >= 0.0 && most <= 3.0 * length && apart <= most_apart;
  const double parts = follows ? std::ceil(std::sqrt(apart / least_apart)) : 1.0;
  for (double k = 1.0; k < parts; k += 1.0) {
    const double s = k / parts, r = 1.0 - s;
    const Point ends = combined(r * r * (1.0 + 2.0 * s), from, s * s * (3.0 - 2.0 * s), to);
    line.push_back(combined(1.0, ends, s * r, combined(r, rate_from, -s, rate_to)));
  }
  line.push_back(to);
}

/// Appends a curve between two corners.
void append_smooth(std::span<const Point> points, std::span<const double> t, std::vector<Point>& line) {
  line.push_back(points.front());
  if (points.size() < 3) {
    line.insert(line.end(), points.begin() + 1, points.end());
    return;
  }
  const auto rates = rates_of(points, t);
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const double h = t[i + 1] - t[i];
    append_cubic(points[i], points[i + 1], combined(h, rates[i], 0.0, {}), combined(h, rates[i + 1], 0.0, {}), line);
  }
}

}  // namespace

void round_corners(CurvePieces& pieces) {
  for (auto& [points, t, sliding] : pieces.lines) {
    std::vector<Point> line;
    for (std::size_t begin = 0, end = 0; begin < points.size(); begin = end) {
      for (end = begin + 1; end < points.size() && t[end] > t[end - 1];) ++end;
      append_smooth(std::span(points).subspan(begin, end - begin), std::span(t).subspan(begin, end - begin), line);
    }
    points = std::move(line);
  }
}

}  // namespace saltus::report
