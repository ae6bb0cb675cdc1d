#include <algorithm>

#include "saltus/base/at.hpp"
#include "saltus/fesd_integrator/run/element_interior_internal.hpp"

namespace saltus::fesd_integrator {

bool ElementInterior::changes_inside() const {
  return std::any_of(stage_sets_.begin(), stage_sets_.end(),
                     [&](const ActiveSet& of_stage) { return !(of_stage == position_.set()); });
}

/// The polynomial through the selections of the stages, within their range. Where stages share a time (explicit
/// methods) they are those of the next one.
void ElementInterior::follow_stages(const Element& element, double theta) {
  const auto& c = context_.solver.tableau().c;
  linalg::Index next = 0;
  while (next + 1 < c.size() && c(next) < theta) ++next;
  set_ = &stage_sets_[at(next)];
  const std::size_t n = element.stage_selections.size() / at(c.size());
  const auto weight = [&](linalg::Index stage) {
    double product = 1.0;
    for (linalg::Index l = 0; l < c.size(); ++l) product *= l == stage ? 1.0 : (theta - c(l)) / (c(stage) - c(l));
    return product;
  };
  bool distinct = true;
  for (linalg::Index m = 1; m < c.size(); ++m) distinct = distinct && c(m) != c(m - 1);
  selections_.assign(n, 0.0);
  for (linalg::Index m = 0; m < c.size(); ++m) {
    const double part = distinct ? weight(m) : m == next ? 1.0 : 0.0;
    for (std::size_t j = 0; j < n; ++j) selections_[j] += part * element.stage_selections[at(m) * n + j];
  }
  for (double& selection : selections_) selection = std::clamp(selection, 0.0, 1.0);
  for (const Part& part : context_.facts.parts) {
    if (!part.simplex) continue;
    double sum = 0.0;
    for (int j = part.first; j < part.first + part.count; ++j) sum += selections_[at(j)];
    for (int j = part.first; j < part.first + part.count; ++j) selections_[at(j)] /= sum;
  }
}

void ElementInterior::go_to(const Element& element, const std::vector<double>& selections, double theta) {
  context_.solver.interpolate(element, theta, x_.data());
  set_ = &position_.set();
  if (changes_inside()) return follow_stages(element, theta);
  if (!project(element.t + theta * element.h, x_, selections)) selections_ = selections;
}

bool ElementInterior::project(double t, const std::vector<double>& x, const std::vector<double>& guess) {
  selections_ = guess;
  const ActiveSet& set = position_.set();
  if (set.sliding().empty()) return true;
  if (!context_.projected.solve(t, x.data(), set, context_.held.data(), selections_.data())) return false;
  if (!set.balances().empty()) {
    margins_.evaluate(set, field_view(context_.projected.values()), selections_.data());
  }
  return true;
}

}  // namespace saltus::fesd_integrator
