#include "saltus/fesd_integrator/element/selection_margins.hpp"

#include <limits>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/switching/table/independent_rows.hpp"

namespace saltus::fesd_integrator {
namespace {

using linalg::Index;
using linalg::Matrix;
using linalg::Vector;
using ConstMatrix = linalg::ConstView;
using ConstVector = linalg::ConstView;

}  // namespace

FieldView field_view(const discretization::StageValues& at, DenseMatrices& memory) {
  FieldView view = field_view(at);
  if (!at.pattern->is_sparse) return view;
  const auto fill = [](const discretization::EntryPattern& pattern, const std::vector<double>& values) {
    Matrix matrix = Matrix::zero(pattern.rows, pattern.columns);
    for (std::size_t j = 0; j < saltus::at(pattern.columns); ++j) {
      visit_column(pattern, values, j, [&](std::size_t i, double value) { matrix(index(i), index(j)) = value; });
    }
    return matrix;
  };
  memory.f_selection = fill(at.pattern->f_selection, at.f_selection);
  memory.indicator_x = fill(at.pattern->indicator_x, at.indicator_x);
  view.f_selection = memory.f_selection.data();
  view.indicator_x = memory.indicator_x.data();
  return view;
}

bool find_balances(const FieldView& at, ActiveSet& set) {
  const auto& sliding = set.sliding();
  const ConstMatrix indicator_x(at.indicator_x, index(at.n), index(at.n_x));
  const ConstMatrix f_selection(at.f_selection, index(at.n_x), index(at.n));
  Matrix gradients(index(sliding.size()), index(at.n_x)), jumps(index(at.n_x), index(sliding.size()));
  for (std::size_t k = 0; k < sliding.size(); ++k) {
    if (sliding[k].reference >= 0) return false;
    gradients.row(index(k)) = indicator_x.row(sliding[k].surface.indicator);
    jumps.col(index(k)) = f_selection.col(sliding[k].selection);
  }
  const auto independent = switching::independent_rows(gradients);
  if (independent.size() == sliding.size()) return false;
  const Matrix held = gradients.selected_rows(std::vector<Index>(independent.begin(), independent.end()));
  auto found = switching::balances_of(held * jumps, held.abs() * jumps.abs());
  for (const std::size_t i : found.unused) {
    if (jumps.col(index(i)).max_abs() > 0.0) return false;
  }
  std::vector<switching::Balance> balances;
  for (auto& balance : found.all) {
    if (balance.rows.size() < balance.functions.size()) return false;
    if (balance.rows.size() == balance.functions.size()) continue;
    for (std::size_t& k : balance.functions) k = independent[k];
    balances.push_back(std::move(balance));
  }
  const bool some = !balances.empty();
  set.set_balances(std::move(balances));
  return some;
}

void SelectionMargins::evaluate(const ActiveSet& set, const FieldView& at, double* selections) {
  const ConstMatrix indicator_x(at.indicator_x, index(at.n), index(at.n_x));
  const ConstMatrix f_selection(at.f_selection, index(at.n_x), index(at.n));
  const ConstVector f(at.f, index(at.n_x));
  lower_.assign(at.n, {});
  upper_.assign(at.n, {});
  ranges_.resize(set.balances().size());
  for (std::size_t b = 0; b < ranges_.size(); ++b) {
    const auto& balance = set.balances()[b];
    const std::size_t r = balance.functions.size(), q = balance.rows.size();
    Matrix effects(index(r), index(q));
    Vector constant(index(r)), lambda(index(q));
    const auto selection = [&](std::size_t i) { return set.sliding()[balance.rows[i]].selection; };
    for (std::size_t i = 0; i < q; ++i) lambda[index(i)] = selections[selection(i)];
    for (std::size_t k = 0; k < r; ++k) {
      const int function = set.sliding()[balance.functions[k]].surface.indicator;
      for (std::size_t i = 0; i < q; ++i) {
        effects(index(k), index(i)) = indicator_x.row(function).dot(f_selection.col(selection(i)));
      }
      constant[index(k)] = indicator_x.row(function).dot(f);
      constant[index(k)] += at.indicator_t[function];
    }
    constant -= effects * lambda;
    auto& range = ranges_[b];
    const bool known = range.set(effects) && constant.all_finite();
    lambda = switching::bounded_selections(effects, constant);
    for (std::size_t i = 0; i < q; ++i) {
      const auto j = saltus::at(selection(i));
      if (known) selections[j] = lambda[index(i)];
      const double widest = known ? 1.0 : std::numeric_limits<double>::quiet_NaN();
      Margin lower{widest, b, 0}, upper{widest, b, 0};
      for (std::size_t facet = i; known && facet < range.facets().size(); facet += q) {
        const auto span = range.span(facet, constant);
        if (-span.min < lower.value) lower = {-span.min, b, facet};
        if (span.max < upper.value) upper = {span.max, b, facet};
      }
      lower_[j] = lower;
      upper_[j] = upper;
    }
  }
}

double SelectionMargins::value(const Condition& condition) const {
  const auto& margins = condition.kind == Condition::Kind::lower ? lower_ : upper_;
  return margins[at(condition.selection)].value;
}

std::vector<double> SelectionMargins::normal(const ActiveSet& set, const Condition& condition) const {
  const auto& margins = condition.kind == Condition::Kind::lower ? lower_ : upper_;
  const Margin& margin = margins[at(condition.selection)];
  std::vector<double> normal(set.sliding().size(), 0.0);
  const auto& functions = set.balances()[margin.balance].functions;
  const auto& facet = ranges_[margin.balance].facets()[margin.facet];
  for (std::size_t k = 0; k < functions.size(); ++k) normal[functions[k]] = facet.normal[index(k)];
  return normal;
}

}  // namespace saltus::fesd_integrator
