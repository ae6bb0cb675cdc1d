// Lines, rectangles and words as SVG, and axes made of them.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace saltus::report {

struct Range {
  double from = 0.0, to = 1.0;
};

/// Holds what a line is drawn with; the colours are those of the page on paper.
struct Pen {
  std::string_view color = "#1c2430";
  double width = 1.0;
  std::string_view dash{};
};

/// Holds the coordinates of a place on paper in pixels: x to the right, y downwards.
struct Point {
  double x = 0.0, y = 0.0;
};

/// A fill of fine lines.
inline constexpr std::string_view hatched = "url(#hatch)";

class Svg {
 public:
  Svg(double width, double height) : width_(width), height_(height) {}
  /// Fills the inside of a closed line.
  void area(const std::vector<Point>& points, std::string_view fill);
  /// Draws a connected line; nothing of fewer than two points.
  void path(const std::vector<Point>& points, const Pen& pen);
  void rectangle(Point corner, double width, double height, std::string_view fill, std::string_view stroke = "none");
  void disc(Point centre, double radius, std::string_view fill, std::string_view stroke);
  /// @param anchor  start, middle or end
  void text(Point at, std::string_view words, std::string_view anchor, std::string_view color, double turned = 0.0);
  /// Draws what follows only within a rectangle; until the next call, or with nothing.
  void clip(std::optional<Point> corner, double width = 0.0, double height = 0.0);
  void make_taller(double by) { height_ += by; }
  [[nodiscard]] std::string document(std::string_view title) const;

 private:
  double width_, height_;
  std::string body_;
  int clips_ = 0;
  bool clipped_ = false;
};

void draw_cross(Svg& svg, Point centre, const Pen& pen);

/// Returns about `count` round numbers within a range, two at least: multiples of 1, 2 or 5 times a power of ten.
[[nodiscard]] std::vector<double> round_numbers(Range range, int count);

/// Holds a rectangle on paper with a range along each of its sides.
struct Plot {
  Point corner;
  double width = 0.0, height = 0.0;
  Range x, y;

  [[nodiscard]] Point place(double horizontal, double vertical) const {
    return {corner.x + width * (horizontal - x.from) / (x.to - x.from),
            corner.y + height * (1.0 - (vertical - y.from) / (y.to - y.from))};
  }
};

/// Draws frame, grid and numbers of the vertical axis, and of the horizontal one if it is `labelled`.
void draw_axes(Svg& svg, const Plot& plot, bool labelled);

}  // namespace saltus::report
