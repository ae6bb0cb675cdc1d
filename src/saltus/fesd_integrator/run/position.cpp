#include <algorithm>
#include <cmath>

#include "saltus/fesd_integrator/run/position_internal.hpp"

namespace saltus::fesd_integrator {

Position::Position(double t, std::vector<double> x, std::size_t selections)
    : t_(t), x_(std::move(x)), selections_(selections) {
  for (const double component : x_) size_ = std::max(size_, std::abs(component));
}

Point& Position::left_end() {
  left_.t = t_;
  left_.x = x_;
  left_.selections = selections_;
  left_.size = size_;
  return left_;
}

std::vector<int> Position::on_surfaces() const {
  std::vector<int> list;
  const auto add = [&](const Surface& surface) {
    list.push_back(surface.indicator);
    if (surface.reference >= 0) list.push_back(surface.reference);
  };
  for (const Surface& surface : set_.resting()) add(surface);
  for (const Sliding& entry : set_.sliding()) {
    add(entry.surface);
    if (entry.reference >= 0) add({entry.selection, entry.reference});
  }
  return list;
}

void Position::move_to(double t, const Element& element, const std::vector<double>& selections) {
  stop_inside(t, element.end, selections);
  size_ = std::max(0.5 * size_, element.size);
}

void Position::stop_inside(double t, const std::vector<double>& x, const std::vector<double>& selections) {
  t_ = t;
  x_ = x;
  selections_ = selections;
}

void Position::continue_with(const Continuation& next) {
  continue_with(next.set, next.selections);
  determined_ = next.determined;
}

void Position::continue_with(const ActiveSet& set, const std::vector<double>& selections) {
  set_ = set;
  selections_ = selections;
}

void Position::jump_to(double t, std::vector<double> x) {
  t_ = t;
  x_ = std::move(x);
}

}  // namespace saltus::fesd_integrator
