#include "saltus/pipeline/vector_field.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "saltus/base/at.hpp"
#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/model/layout_of.hpp"
#include "saltus/pipeline/bodies/drawing.hpp"
#include "saltus/pipeline/surfaces.hpp"

namespace saltus::pipeline {
namespace {

using PlanePoint = std::array<double, 2>;

/// Arrows along the surfaces: as many on a length of the box.
constexpr int arrows_along = 14;
/// How far beside a surface its arrows begin, as a fraction of the box.
constexpr double beside = 0.012;

class FieldOfTwoStates {
 public:
  FieldOfTwoStates(evaluation::ModelKernel kernel, double t, std::array<Interval, 2> box)
      : kernel_(std::move(kernel)), t_(t), box_(box), psi_(at(kernel_.event_functions())) {}

  /// Selections of the signs of psi; a function that depends on selections is read again.
  [[nodiscard]] std::vector<double> selections(const PlanePoint& x) {
    std::vector<double> alpha(at(kernel_.switching_functions()), 0.5);
    for (std::size_t round = 0; round <= alpha.size(); ++round) {
      kernel_.functions(t_, x.data(), alpha.data(), psi_.data());
      const auto before = alpha;
      for (std::size_t j = 0; j < alpha.size(); ++j) alpha[j] = psi_[j] > 0.0 ? 1.0 : psi_[j] < 0.0 ? 0.0 : 0.5;
      if (alpha == before) break;
    }
    return alpha;
  }

  [[nodiscard]] PlanePoint field(const PlanePoint& x, const std::vector<double>& alpha) const {
    PlanePoint slope{};
    kernel_.field(t_, x.data(), alpha.data(), slope.data());
    return slope;
  }

  void add(const PlanePoint& x, const PlanePoint& slope, result::Arrows& arrows) const {
    if (!std::isfinite(slope[0]) || !std::isfinite(slope[1]) || (slope[0] == 0.0 && slope[1] == 0.0)) return;
    arrows.x.push_back(x[0]);
    arrows.y.push_back(x[1]);
    arrows.dx.push_back(slope[0]);
    arrows.dy.push_back(slope[1]);
  }

  void add_grid(result::Arrows& arrows) {
    for (int i = 0; i < field_cells; ++i) {
      for (int j = 0; j < field_cells; ++j) {
        const PlanePoint x{along(0, (i + 0.5) / field_cells), along(1, (j + 0.5) / field_cells)};
        add(x, field(x, selections(x)), arrows);
      }
    }
  }

  /// The fields of both sides of surface j at a point of it, and the sliding one.
  void add_surface(int j, const PlanePoint& x, result::VectorField& arrows) {
    auto alpha = selections(x);
    PlanePoint normal{};
    double rate = 0.0;
    kernel_.gradient(j, t_, x.data(), alpha.data(), normal.data(), &rate);
    const auto at_selection = [&](double value) {
      alpha[at(j)] = value;
      return field(x, alpha);
    };
    const auto velocity = [&](const PlanePoint& slope) { return rate + normal[0] * slope[0] + normal[1] * slope[1]; };
    const PlanePoint below = at_selection(0.0), above = at_selection(1.0);
    const double change = std::abs(above[0] - below[0]) + std::abs(above[1] - below[1]);
    const double size = std::abs(above[0]) + std::abs(above[1]) + std::abs(below[0]) + std::abs(below[1]);
    const PlanePoint offset = off_surface(normal);
    if (!(change > 1e-9 * size) || !std::isfinite(offset[0] + offset[1])) return;
    add({x[0] + offset[0], x[1] + offset[1]}, above, arrows.sides);
    add({x[0] - offset[0], x[1] - offset[1]}, below, arrows.sides);
    if (!(velocity(below) > 0.0 && velocity(above) < 0.0)) return;
    const double selected = change_of_sign([&](double value) { return velocity(at_selection(value)) < 0.0; });
    add(x, at_selection(selected), arrows.sliding);
  }

  /// Places along a line through the box, evenly spaced by the box's measure.
  void add_along(int j, const std::vector<PlanePoint>& line, result::VectorField& arrows) {
    double next = 0.5 / arrows_along, passed = 0.0;
    for (std::size_t k = 1; k < line.size(); ++k) {
      const auto& from = line[k - 1];
      const auto& to = line[k];
      const double length = std::hypot((to[0] - from[0]) / width(0), (to[1] - from[1]) / width(1));
      for (; next <= passed + length; next += 1.0 / arrows_along) {
        const double part = (next - passed) / length;
        add_surface(j, {from[0] + part * (to[0] - from[0]), from[1] + part * (to[1] - from[1])}, arrows);
      }
      passed += length;
    }
  }

  [[nodiscard]] double width(std::size_t i) const { return box_[i].to - box_[i].from; }
  [[nodiscard]] double along(std::size_t i, double part) const { return box_[i].from + part * width(i); }
  [[nodiscard]] const std::array<Interval, 2>& box() const { return box_; }

 private:
  /// A small step to the side where psi > 0, across the surface as it is drawn.
  [[nodiscard]] PlanePoint off_surface(const PlanePoint& normal) const {
    const PlanePoint scaled{normal[0] * width(0), normal[1] * width(1)};
    const double length = std::hypot(scaled[0], scaled[1]);
    return {beside * width(0) * scaled[0] / length, beside * width(1) * scaled[1] / length};
  }

  evaluation::ModelKernel kernel_;
  double t_;
  std::array<Interval, 2> box_;
  std::vector<double> psi_;
};

/// The line a x + b y + c = 0 within the box; nothing without one.
std::vector<PlanePoint> line_in_box(const PlanePoint& gradient, double constant, const std::array<Interval, 2>& box) {
  // Along the axis on which the gradient is smaller, measured by the box, the other coordinate is a function.
  const bool by_first =
      std::abs(gradient[0]) * (box[0].to - box[0].from) <= std::abs(gradient[1]) * (box[1].to - box[1].from);
  const std::size_t free = by_first ? 0 : 1, bound = by_first ? 1 : 0;
  if (gradient[bound] == 0.0) return {};
  const auto other = [&](double value) { return -(constant + gradient[free] * value) / gradient[bound]; };
  std::vector<PlanePoint> line;
  constexpr int pieces = 256;
  for (int i = 0; i <= pieces; ++i) {
    PlanePoint x{};
    x[free] = box[free].from + (box[free].to - box[free].from) * i / pieces;
    x[bound] = other(x[free]);
    if (x[bound] >= box[bound].from && x[bound] <= box[bound].to) line.push_back(x);
  }
  return line;
}

double form_at(const result::AffineSurface& form, const PlanePoint& gradient, double t, const PlanePoint& x) {
  return gradient[0] * x[0] + gradient[1] * x[1] + form.rate * t + form.constant;
}

/// The gradient over both states.
PlanePoint in_plane(const result::AffineSurface& form, const result::Surface& surface, const result::Result& result) {
  PlanePoint gradient{};
  for (std::size_t k = 0; k < surface.states.size(); ++k) {
    gradient[surface.states[k] == result.states[0] ? 0 : 1] = form.gradient[k];
  }
  return gradient;
}

void add_lines(int j, const result::Surface& surface, const result::Result& result, FieldOfTwoStates& field,
               result::VectorField& arrows) {
  if (surface.affine) {
    const PlanePoint gradient = in_plane(*surface.affine, surface, result);
    auto line = line_in_box(gradient, surface.affine->rate * arrows.t + surface.affine->constant, field.box());
    for (const auto& form : surface.within) {
      const PlanePoint margin = in_plane(form, surface, result);
      std::erase_if(line, [&](const PlanePoint& x) { return form_at(form, margin, arrows.t, x) < 0.0; });
    }
    return field.add_along(j, line, arrows);
  }
  for (const auto& curve : surface.curves) {
    if (curve.t && *curve.t != arrows.t) continue;
    std::vector<PlanePoint> line;
    if (curve.coordinates.size() == 2) {
      for (std::size_t k = 0; k < curve.coordinates[0].size(); ++k) {
        line.push_back({curve.coordinates[0][k], curve.coordinates[1][k]});
      }
      field.add_along(j, line, arrows);
      continue;
    }
    const std::size_t own = surface.states.front() == result.states[0] ? 0 : 1;
    for (const double value : curve.coordinates.front()) {
      PlanePoint from{field.box()[0].from, field.box()[1].from}, to{field.box()[0].to, field.box()[1].to};
      from[own] = to[own] = value;
      field.add_along(j, {from, to}, arrows);
    }
  }
}

bool is_plane(const model::Layout& layout, const result::Result& result) {
  const auto is_set = [](bool discrete) { return discrete; };
  return result.states.size() == 2 && layout.state_names == result.states && layout.cell_names.empty() &&
         layout.groups.empty() && layout.contacts.empty() &&
         std::none_of(layout.discrete_states.begin(), layout.discrete_states.end(), is_set);
}

}  // namespace

std::optional<result::VectorField> vector_field(const model::System& system, const result::Result& result) {
  const auto layout = model::layout_of(system);
  if (!is_plane(layout, result)) return std::nullopt;
  const std::array<Interval, 2> box{drawn_range(result, 0), drawn_range(result, 1)};
  for (const auto& [from, to] : box) {
    if (!std::isfinite(from) || !std::isfinite(to) || !(from < to)) return std::nullopt;
  }
  auto kernel = evaluation::ModelKernel::compile(system);
  if (!kernel) return std::nullopt;
  result::VectorField arrows;
  arrows.t = result.final.t;
  FieldOfTwoStates field(std::move(*kernel), arrows.t, box);
  field.add_grid(arrows.free);
  for (const auto& surface : result.surfaces) {
    const auto named = [&](const model::Layout::Surface& function) { return function.name == surface.name; };
    const auto found = std::find_if(layout.surfaces.begin(), layout.surfaces.end(), named);
    if (surface.role != result::SurfaceRole::switching || found == layout.surfaces.end()) continue;
    add_lines(static_cast<int>(found - layout.surfaces.begin()), surface, result, field, arrows);
  }
  return arrows;
}

namespace {

/// An optimum has them already: its parameters are its own.
void add_bodies(const model::System& system, result::Result& result) {
  if (!result.drawing) result.drawing = drawing_of(system, result.trajectory);
  for (auto& branch : result.branches) add_bodies(system, branch);
}

}  // namespace

void add_drawings(const model::System& system, result::Result& result) {
  add_bodies(system, result);
  result.surfaces = surfaces(system, result);
  result.vector_field = vector_field(system, result);
}

}  // namespace saltus::pipeline
