#include "saltus/fesd_integrator/record/element_recorder.hpp"

#include <algorithm>
#include <limits>

#include "saltus/base/at.hpp"

namespace saltus::fesd_integrator {

ElementRecorder::ElementRecorder(const discretization::StageKernel& kernel, const Facts& facts,
                                 const discretization::ButcherTableau& tableau)
    : kernel_(kernel), facts_(facts), nodes_(tableau.c.begin(), tableau.c.end()), indicators_(kernel.selections()) {
  elements_.points = nodes_.size() + 2;
  elements_.selections = facts.selections;
}

void ElementRecorder::add(const Element& element, const std::vector<double>& left, const std::vector<double>& right,
                          double end, const ActiveSet& set, const double* held) {
  undetermined_.clear();
  for (const auto& balance : set.balances()) {
    for (const std::size_t k : balance.rows) undetermined_.push_back(set.sliding()[k].selection);
  }
  point(element.t, element.x.data(), left.data(), held);
  for (std::size_t m = 0; m < nodes_.size(); ++m) {
    const double t = nodes_[m] == 1.0 ? end : element.t + element.warp.at(nodes_[m]) * element.h;
    point(t, element.stage_states.data() + m * element.x.size(),
          element.stage_selections.data() + m * indicators_.size(), held);
  }
  point(end, element.end.data(), right.data(), held);
}

void ElementRecorder::point(double t, const double* x, const double* selections, const double* held) {
  kernel_.indicators(t, x, held, indicators_.data());
  for (const Part& part : facts_.parts) {
    if (!part.simplex) continue;
    const auto first = indicators_.begin() + part.first, last = first + part.count;
    const double mu = *std::min_element(first, last);
    for (auto g = first; g != last; ++g) *g -= mu;
  }
  elements_.t.push_back(t);
  elements_.lambda.push_back(indicators_);
  const auto row = elements_.selection.emplace_back(indicators_.size());
  std::copy_n(selections, row.size(), row.begin());
  for (const int j : undetermined_) row[at(j)] = std::numeric_limits<double>::quiet_NaN();
}

}  // namespace saltus::fesd_integrator
