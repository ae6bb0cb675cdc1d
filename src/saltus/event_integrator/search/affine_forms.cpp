#include "saltus/event_integrator/search/affine_forms.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "saltus/event_integrator/mode/small_internal.hpp"

namespace saltus::event_integrator {
namespace {

// Of the size of the terms: the roundings of a value, of the bounds and of the dense output are a few units each. Twice
// what the search takes for noise at most, so nothing it would find is passed over.
constexpr double margin = 64.0 * std::numeric_limits<double>::epsilon();

/// Whether a state between low and high gets to one of the thresholds around it, or is not finite.
inline bool reaches(double low, double high, double lower, double upper) {
  const double room = margin * std::max(std::abs(low), std::abs(high));
  return !(low - room > lower) || !(high + room < upper);
}

}  // namespace

AffineForms::AffineForms(std::size_t states)
    : first_(states + 1, 0),
      below_(states, none),
      above_(states, none),
      lower_(states, -infinity),
      upper_(states, infinity) {}

void AffineForms::load(const evaluation::AffineRows& rows) {
  terms_.clear();
  table_.clear();
  for (std::size_t j = 0; j < rows.offset.size(); ++j) {
    Form& form = table_.emplace_back(form_of(rows, j));
    form.threshold = form.count == 1 && form.rate == 0.0;
  }
  loaded_terms_ = terms_.size();
}

void AffineForms::reset(std::size_t functions) {
  forms_.assign(functions, Form{});
  terms_.resize(loaded_terms_);
  thresholds_.clear();
  first_.assign(first_.size(), 0);
  watch_none();
}

AffineForms::Form AffineForms::form_of(const evaluation::AffineRows& rows, std::size_t j) {
  if (!std::isfinite(rows.offset[j]) || !std::isfinite(rows.rate[j])) return {};
  Form form{terms_.size(), 0, 0, rows.rate[j], rows.offset[j], 0, true};
  for (std::size_t k = rows.start[j]; k < rows.start[j + 1]; ++k) {
    if (!std::isfinite(rows.coefficient[k])) return {};
    if (rows.coefficient[k] != 0.0) terms_.push_back({rows.column[k], rows.coefficient[k]});
  }
  form.count = terms_.size() - form.first;
  return form;
}

void AffineForms::set(std::size_t i, const evaluation::AffineRows& rows, std::size_t j) {
  forms_[i] = form_of(rows, j);
}

void AffineForms::set(std::size_t i, const evaluation::AffineRow& row) {
  forms_[i] = Form{};
  replace(i, &row);
}

void AffineForms::replace(std::size_t i, const evaluation::AffineRow* row) {
  Form& form = forms_[i];
  form.known = false;
  if (row == nullptr || !std::isfinite(row->offset) || !std::isfinite(row->rate)) return;
  std::size_t count = 0;
  for (const double coefficient : row->coefficient) {
    if (!std::isfinite(coefficient)) return;
    count += coefficient != 0.0 ? 1 : 0;
  }
  if (count > form.room) {
    form.first = terms_.size();
    form.room = count;
    terms_.resize(terms_.size() + count);
  }
  form = {form.first, count, form.room, row->rate, row->offset, 0, true};
  std::size_t place = form.first;
  for (std::size_t k = 0; k < row->coefficient.size(); ++k) {
    if (row->coefficient[k] != 0.0) terms_[place++] = {row->column[k], row->coefficient[k]};
  }
}

double AffineForms::value(std::size_t i, double t, const double* x) const {
  const Form& form = forms_[i];
  double sum = form.rate == 0.0 ? 0.0 : form.rate * t;  // without a rate the time may be anything
  for (std::size_t k = form.first; k < form.first + form.count; ++k) {
    sum += terms_[k].coefficient * x[terms_[k].column];
  }
  return sum + form.offset;
}

std::optional<double> AffineForms::rate_along(std::size_t i, const double* f) const {
  const Form& form = forms_[i];
  double sum = form.rate;
  double sizes = std::abs(form.rate);
  for (std::size_t k = form.first; k < form.first + form.count; ++k) {
    const double term = terms_[k].coefficient * f[terms_[k].column];
    sum += term;
    sizes += std::abs(term);
  }
  constexpr double clear = 1e3 * std::numeric_limits<double>::epsilon();
  if (!(std::abs(sum) > clear * sizes)) return std::nullopt;
  return sum;
}

ode::BernsteinCoefficients AffineForms::along(std::size_t i, const ode::DenseStep& step) const {
  const Form& form = forms_[i];
  if (form.threshold) {
    auto b = step.bernstein(terms_[form.first].column);
    for (double& value : b) value = terms_[form.first].coefficient * value + form.offset;
    return b;
  }
  ode::BernsteinCoefficients b{};
  if (form.rate != 0.0) {
    for (std::size_t j = 0; j < b.size(); ++j)
      b[j] = form.rate * (step.t + step.h * static_cast<double>(j) / ode::event_degree);
  }
  for (std::size_t k = form.first; k < form.first + form.count; ++k) {
    const auto x = step.bernstein(terms_[k].column);
    for (std::size_t j = 0; j < b.size(); ++j) b[j] += terms_[k].coefficient * x[j];
  }
  for (double& value : b) value += form.offset;
  return b;
}

ode::NestedPolynomial AffineForms::nested_along(std::size_t i, const ode::DenseStep& step) const {
  const Form& form = forms_[i];
  ode::NestedPolynomial sum;
  for (std::size_t k = form.first; k < form.first + form.count; ++k) {
    step.add_nested(terms_[k].column, terms_[k].coefficient, sum);
  }
  if (form.rate != 0.0) {
    sum.c[0] += form.rate * step.t;
    sum.c[1] += form.rate * step.h;
    sum.end += form.rate * (step.t + step.h);
  }
  sum.c[0] += form.offset;
  sum.end += form.offset;
  return sum;
}

void AffineForms::AlongSeries::subtract(double offset) {
  terms[0] -= offset;
  for (double& b : coefficients) b -= offset;
}

double AffineForms::AlongSeries::derivative(double theta) const {
  double sum = 0.0;
  for (std::size_t k = terms.size(); --k > 0;) sum = static_cast<double>(k) * terms[k] + theta * sum;
  return sum;
}

AffineForms::AlongSeries AffineForms::along_series(std::size_t i, const ode::DenseStep& step) const {
  const Form& form = forms_[i];
  ode::SeriesCoefficients sum{};
  double size = 0.0;
  for (std::size_t k = form.first; k < form.first + form.count; ++k) {
    const auto [column, coefficient] = terms_[k];
    const auto terms = step.terms(column);
    double sizes = 0.0;
    for (std::size_t power = 0; power < sum.size(); ++power) {
      sum[power] += coefficient * terms[power];
      sizes += std::abs(terms[power]);
    }
    size += std::abs(coefficient) * sizes;
  }
  const double begin = form.rate == 0.0 ? 0.0 : form.rate * step.t;
  const double advance = form.rate == 0.0 ? 0.0 : form.rate * step.h;
  sum[0] += begin + form.offset;
  sum[1] += advance;
  size += std::abs(begin) + std::abs(form.offset) + std::abs(advance);
  AlongSeries result{sum, ode::to_bernstein(sum), ode::series_rounding * size};
  // The ends are the states there, on which the steps before and behind agree.
  result.coefficients.front() = sum[0];
  double end = form.rate == 0.0 ? 0.0 : form.rate * (step.t + step.h);
  for (std::size_t k = form.first; k < form.first + form.count; ++k) {
    end += terms_[k].coefficient * step.end(terms_[k].column);
  }
  result.coefficients.back() = end + form.offset;
  return result;
}

double AffineForms::terms(const Form& form, const StepBounds& bounds) const {
  double sum = std::abs(form.offset) + std::abs(form.rate) * std::max(std::abs(bounds.begin), std::abs(bounds.end));
  for (std::size_t k = form.first; k < form.first + form.count; ++k) {
    const auto column = terms_[k].column;
    sum += std::abs(terms_[k].coefficient) * std::max(std::abs(bounds.low[column]), std::abs(bounds.high[column]));
  }
  return sum;
}

double AffineForms::terms(std::size_t i, const StepBounds& bounds) const { return terms(forms_[i], bounds); }

void AffineForms::group() {
  thresholds_.clear();
  for (std::size_t i = 0; i < forms_.size(); ++i) {
    if (forms_[i].threshold) thresholds_.push_back({-forms_[i].offset / factor(i), i, 0});
  }
  std::sort(thresholds_.begin(), thresholds_.end(), [&](const Threshold& a, const Threshold& b) {
    return std::tuple(state(a.function), a.value, a.function) < std::tuple(state(b.function), b.value, b.function);
  });
  place_.resize(forms_.size());
  first_.assign(lower_.size() + 1, 0);
  for (std::size_t k = 0; k < thresholds_.size(); ++k) {
    place_[thresholds_[k].function] = k;
    ++first_[state(thresholds_[k].function) + 1];
  }
  for (std::size_t state = 0; state < lower_.size(); ++state) first_[state + 1] += first_[state];
  watch_none();
}

void AffineForms::watch_none() {
  std::fill(below_.begin(), below_.end(), none);
  std::fill(above_.begin(), above_.end(), none);
  std::fill(lower_.begin(), lower_.end(), -infinity);
  std::fill(upper_.begin(), upper_.end(), infinity);
  several_.clear();
  for (Form& form : forms_) form.sign = 0;
  for (Threshold& threshold : thresholds_) threshold.side = 0;
}

void AffineForms::set_nearest_below(std::size_t state, std::size_t place) {
  below_[state] = place;
  lower_[state] = place == none ? -infinity : thresholds_[place].value;
}

void AffineForms::set_nearest_above(std::size_t state, std::size_t place) {
  above_[state] = place;
  upper_[state] = place == none ? infinity : thresholds_[place].value;
}

void AffineForms::watch(std::size_t i, int sign) {
  Form& form = forms_[i];
  form.sign = sign;
  if (!form.threshold) {
    several_.push_back(i);
    return;
  }
  const std::size_t column = state(i);
  const std::size_t place = place_[i];
  const int side = sign * factor(i) > 0.0 ? 1 : -1;
  thresholds_[place].side = side;
  if (side > 0) {
    if (below_[column] == none || place > below_[column]) set_nearest_below(column, place);
  } else {
    if (place < above_[column]) set_nearest_above(column, place);
  }
}

void AffineForms::ignore(std::size_t i) {
  Form& form = forms_[i];
  if (form.sign == 0) return;
  form.sign = 0;
  if (!form.threshold) {
    std::erase(several_, i);
    return;
  }
  const std::size_t column = state(i);
  const std::size_t place = place_[i];
  thresholds_[place].side = 0;
  if (place == below_[column]) {
    std::size_t k = place;
    while (k > first_[column] && thresholds_[k - 1].side <= 0) --k;
    set_nearest_below(column, k > first_[column] ? k - 1 : none);
  }
  if (place == above_[column]) {
    std::size_t k = place + 1;
    while (k < first_[column + 1] && thresholds_[k].side >= 0) ++k;
    set_nearest_above(column, k < first_[column + 1] ? k : none);
  }
}

bool AffineForms::reaches_zero(const Form& form, const StepBounds& bounds) const {
  const double side = form.sign;
  if (form.threshold) {  // the same without its loops
    const auto [column, coefficient] = terms_[form.first];
    const double low = bounds.low[column];
    const double high = bounds.high[column];
    const double slope = side * coefficient;
    const double size = std::abs(form.offset) + std::abs(coefficient) * std::max(std::abs(low), std::abs(high));
    return !(side * form.offset + slope * (slope > 0.0 ? low : high) > margin * size);
  }
  const double at_begin = form.rate == 0.0 ? 0.0 : side * form.rate * bounds.begin;
  const double at_end = form.rate == 0.0 ? 0.0 : side * form.rate * bounds.end;
  double least = side * form.offset + std::min(at_begin, at_end);
  double size = std::abs(form.offset) + std::abs(form.rate) * std::max(std::abs(bounds.begin), std::abs(bounds.end));
  for (std::size_t k = form.first; k < form.first + form.count; ++k) {  // terms() beside it
    const auto [column, coefficient] = terms_[k];
    const double low = bounds.low[column], high = bounds.high[column];
    const double slope = side * coefficient;
    least += slope * (slope > 0.0 ? low : high);
    size += std::abs(coefficient) * std::max(std::abs(low), std::abs(high));
  }
  return !(least > margin * size);
}

bool AffineForms::leaves(std::size_t i, int sign, const StepBounds& mean_slopes) const {
  const Form& form = forms_[i];
  double least = sign * form.rate;
  double size = std::abs(form.rate);
  for (std::size_t k = form.first; k < form.first + form.count; ++k) {
    const auto [column, coefficient] = terms_[k];
    const double low = mean_slopes.low[column];
    const double high = mean_slopes.high[column];
    least += sign * coefficient * (sign * coefficient > 0.0 ? low : high);
    size += std::abs(coefficient) * std::max(std::abs(low), std::abs(high));
  }
  return least > margin * size;
}

bool AffineForms::may_vanish(const StepBounds& bounds) const {
  bool any = false;  // without a way out: almost always there is none
  for (std::size_t state = 0; state < lower_.size(); ++state) {
    any |= reaches(bounds.low[state], bounds.high[state], lower_[state], upper_[state]);
  }
  return any ||
         std::any_of(several_.begin(), several_.end(), [&](std::size_t i) { return reaches_zero(forms_[i], bounds); });
}

void AffineForms::append_suspects(const StepBounds& bounds, std::vector<std::size_t>& suspects) const {
  // Of time, over the length of the step, with a thousand roundings.
  const double time = std::max(std::abs(bounds.begin), std::abs(bounds.end));
  const double resolution = std::min(16.0 * margin * time / (bounds.end - bounds.begin), 1.0);
  for (std::size_t state = 0; state < lower_.size(); ++state) {
    const double low = bounds.low[state];
    const double high = bounds.high[state];
    if (!reaches(low, high, lower_[state], upper_[state])) continue;
    // What the state reaches behind its nearest threshold by more than this is not reached before it, whatever the
    // roundings of both. Nor is it reached at the same time, as far as that can be resolved.
    const double beside =
        std::max(resolution * (high - low), 0x1p10 * margin * std::max(std::abs(low), std::abs(high)));
    const auto append = [&](const Threshold& threshold) {
      if (reaches_zero(forms_[threshold.function], bounds)) suspects.push_back(threshold.function);
    };
    if (below_[state] != none) {
      for (std::size_t k = below_[state] + 1; k-- > first_[state];) {
        if (lower_[state] - thresholds_[k].value > beside) break;
        if (thresholds_[k].side > 0) append(thresholds_[k]);
      }
    }
    for (std::size_t k = above_[state]; k < first_[state + 1]; ++k) {  // nowhere if there is none
      if (thresholds_[k].value - upper_[state] > beside) break;
      if (thresholds_[k].side < 0) append(thresholds_[k]);
    }
  }
  for (const std::size_t i : several_) {
    if (reaches_zero(forms_[i], bounds)) suspects.push_back(i);
  }
}

}  // namespace saltus::event_integrator
