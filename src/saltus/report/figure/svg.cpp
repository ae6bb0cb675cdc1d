#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "saltus/report/figure/svg_internal.hpp"

namespace saltus::report {
namespace {

std::string escaped(std::string_view words) {
  std::string text;
  for (const char c : words) {
    switch (c) {
      case '&':
        text += "&amp;";
        break;
      case '<':
        text += "&lt;";
        break;
      case '>':
        text += "&gt;";
        break;
      default:
        // No control characters in XML 1.0; what is no UTF-8 was refused by the reader of results.
        if (static_cast<unsigned char>(c) >= 0x20U) text += c;
    }
  }
  return text;
}

}  // namespace

void Svg::area(const std::vector<Point>& points, std::string_view fill) {
  body_ += "<path d=\"";
  char step = 'M';
  for (const auto& [x, y] : points) {
    body_ += fmt::format("{}{:.2f},{:.2f}", step, x, y);
    step = 'L';
  }
  body_ += fmt::format("Z\" fill=\"{}\"/>\n", fill);
}

void Svg::path(const std::vector<Point>& points, const Pen& pen) {
  if (points.size() < 2) return;
  body_ += "<path d=\"";
  char step = 'M';
  for (const auto& [x, y] : points) {
    body_ += fmt::format("{}{:.2f},{:.2f}", step, x, y);
    step = 'L';
  }
  body_ +=
      fmt::format("\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\" stroke-linejoin=\"round\"", pen.color, pen.width);
  if (!pen.dash.empty()) body_ += fmt::format(" stroke-dasharray=\"{}\"", pen.dash);
  body_ += "/>\n";
}

void Svg::rectangle(Point corner, double width, double height, std::string_view fill, std::string_view stroke) {
  body_ +=
      fmt::format("<rect x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\" fill=\"{}\" stroke=\"{}\"/>\n",
                  corner.x, corner.y, width, height, fill, stroke);
}

void Svg::disc(Point centre, double radius, std::string_view fill, std::string_view stroke) {
  body_ += fmt::format("<circle cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"{}\" fill=\"{}\" stroke=\"{}\"/>\n", centre.x, centre.y,
                       radius, fill, stroke);
}

void Svg::text(Point at, std::string_view words, std::string_view anchor, std::string_view color, double turned) {
  body_ += fmt::format("<text x=\"{:.2f}\" y=\"{:.2f}\" text-anchor=\"{}\" fill=\"{}\"", at.x, at.y, anchor, color);
  if (turned != 0.0) body_ += fmt::format(" transform=\"rotate({} {:.2f} {:.2f})\"", turned, at.x, at.y);
  body_ += fmt::format(">{}</text>\n", escaped(words));
}

void Svg::clip(std::optional<Point> corner, double width, double height) {
  if (clipped_) body_ += "</g>\n";
  clipped_ = corner.has_value();
  if (!corner) return;
  body_ += fmt::format(
      "<clipPath id=\"clip{0}\"><rect x=\"{1:.2f}\" y=\"{2:.2f}\" width=\"{3:.2f}\" height=\"{4:.2f}\"/></clipPath>\n"
      "<g clip-path=\"url(#clip{0})\">\n",
      ++clips_, corner->x, corner->y, width, height);
}

std::string Svg::document(std::string_view title) const {
  return fmt::format(
             "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\" "
             "font-family=\"DejaVu Sans, Helvetica, Arial, sans-serif\" font-size=\"12\">\n<title>{2}</title>\n"
             "<defs><pattern id=\"hatch\" width=\"3\" height=\"3\" patternUnits=\"userSpaceOnUse\" "
             "patternTransform=\"rotate(45)\"><path d=\"M0,0V3\" stroke=\"#1c2430\" "
             "stroke-width=\"1\"/></pattern></defs>\n"
             "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n",
             width_, height_, escaped(title)) +
         body_ + "</svg>\n";
}

namespace {

std::vector<double> multiples(Range range, int count) {
  const double rough = (range.to - range.from) / std::max(1, count);
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  double step = 10.0 * power;
  for (const double factor : {5.0, 2.0, 1.0}) {
    if (factor * power >= rough) step = factor * power;
  }
  std::vector<double> numbers;
  for (double n = std::ceil(range.from / step); n * step <= range.to + 1e-9 * step && numbers.size() < 100; n += 1.0)
    numbers.push_back(n * step);
  return numbers;
}

}  // namespace

void draw_cross(Svg& svg, Point centre, const Pen& pen) {
  constexpr double half = 5.0;
  for (const double side : {-half, half})
    svg.path({{centre.x - half, centre.y - side}, {centre.x + half, centre.y + side}}, pen);
}

std::vector<double> round_numbers(Range range, int count) {
  constexpr int most = 8;
  auto numbers = multiples(range, count);
  while (numbers.size() < 2 && count < most) numbers = multiples(range, ++count);
  return numbers;
}

void draw_axes(Svg& svg, const Plot& plot, bool labelled) {
  const Pen grid{"#e4e7ec"};
  const auto label = [](double value, Range range) {
    const bool rounding = std::abs(value) < 1e-9 * (range.to - range.from);
    return fmt::format("{:.6g}", rounding ? 0.0 : value);
  };
  for (const double x : round_numbers(plot.x, 8)) {
    const Point low = plot.place(x, plot.y.from);
    svg.path({low, plot.place(x, plot.y.to)}, grid);
    if (labelled) svg.text({low.x, low.y + 16.0}, label(x, plot.x), "middle", "#66707f");
  }
  for (const double y : round_numbers(plot.y, std::max(2, static_cast<int>(plot.height / 40.0)))) {
    const Point left = plot.place(plot.x.from, y);
    svg.path({left, plot.place(plot.x.to, y)}, grid);
    svg.text({left.x - 6.0, left.y + 4.0}, label(y, plot.y), "end", "#66707f");
  }
  svg.rectangle(plot.corner, plot.width, plot.height, "none", "#b9c0ca");
}

}  // namespace saltus::report
