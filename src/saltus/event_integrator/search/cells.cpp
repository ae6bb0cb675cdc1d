#include "saltus/event_integrator/search/cells.hpp"

#include <algorithm>
#include <cmath>

#include "saltus/base/contains.hpp"
#include "saltus/event_integrator/mode/resolution.hpp"
#include "saltus/event_integrator/mode/small_internal.hpp"

namespace saltus::event_integrator {

Cells::Cells(evaluation::ModelKernel& kernel)
    : kernel_(kernel), index_(at(kernel.cells()), 0), moved_(index_.size(), false), undefined_(index_.size(), false) {
  if (index_.empty()) return;
  magnitude_.resize(at(kernel.event_functions()));
  slope_.resize(magnitude_.size());
  put(index_);  // a kernel may be at the end of another run
}

void Cells::put(const std::vector<long>& indices) {
  index_ = indices;
  for (std::size_t c = 0; c < index_.size(); ++c) kernel_.set_cell(static_cast<int>(c), index_[c]);
}

CellChange Cells::move(int cell, long target) {
  if (index_[at(cell)] == target) return CellChange::none;
  index_[at(cell)] = target;
  moved_[at(cell)] = true;
  kernel_.set_cell(cell, target);
  return kernel_.cell_table(cell).change == model::CellTable::Change::jump ? CellChange::jump : CellChange::kink;
}

CellChange Cells::place(int cell, double t, const double* x, const std::vector<double>& alpha) {
  const double argument = kernel_.cell_argument(cell, t, x, alpha.data());
  undefined_[at(cell)] = std::isnan(argument);
  if (std::isnan(argument)) return CellChange::none;  // nothing uses it here
  const auto& table = kernel_.cell_table(cell);
  const int function = kernel_.cell_function(cell);
  kernel_.scales(t, x, alpha.data(), magnitude_.data(), slope_.data());
  const double noise = rounding_of(magnitude_[at(function)]);
  long target = table.cell(argument);
  const bool below = std::abs(table.upper(target) - argument) <= noise;
  const bool above = std::abs(argument - table.lower(target)) <= noise;
  if (below || above) {
    const double rate = kernel_.lie_derivative(function, 1, t, x, alpha.data());
    if (below && rate >= 0.0) ++target;
    if (!below && rate < 0.0) --target;
  }
  return move(cell, target);
}

CellChange Cells::locate(double t, const double* x, const std::vector<double>& alpha) {
  std::fill(moved_.begin(), moved_.end(), false);
  CellChange change = CellChange::none;
  for (int c = 0; c < kernel_.cells(); ++c) change = std::max(change, place(c, t, x, alpha));
  return change;
}

CellChange Cells::leave(const std::vector<EventFunction>& functions, const std::vector<std::size_t>& reached, double t,
                        const double* x, const std::vector<double>& alpha) {
  std::fill(moved_.begin(), moved_.end(), false);
  CellChange change = CellChange::none;
  for (const auto i : reached) {
    if (!is_cell_end(functions[i].kind)) continue;
    const int cell = functions[i].row;
    const long target = index_[at(cell)] + (functions[i].kind == FunctionKind::cell_upper ? 1 : -1);
    change = std::max(change, move(cell, target));
  }
  if (change != CellChange::jump) return change;
  for (int c = 0; c < kernel_.cells(); ++c) {
    if (moved_in(kernel_.cell_function(c))) change = std::max(change, place(c, t, x, alpha));
  }
  return change;
}

bool Cells::jumps_at(const EventFunction& end, double t, const double* x, const std::vector<double>& alpha) {
  if (!is_cell_end(end.kind)) return false;
  const auto& table = kernel_.cell_table(end.row);
  if (table.change != model::CellTable::Change::jump) return false;
  const bool upper = end.kind == FunctionKind::cell_upper;
  const double argument = kernel_.cell_argument(end.row, t, x, alpha.data());
  const double bound = upper ? table.upper(index_[at(end.row)]) : table.lower(index_[at(end.row)]);
  const int function = kernel_.cell_function(end.row);
  kernel_.scales(t, x, alpha.data(), magnitude_.data(), slope_.data());
  if (!(std::abs(bound - argument) <= rounding_of(magnitude_[at(function)]))) return false;
  const double rate = kernel_.lie_derivative(function, 1, t, x, alpha.data());
  return upper ? rate > 0.0 : rate < 0.0;
}

bool Cells::any_undefined() const { return contains(undefined_, true); }

CellChange Cells::locate_undefined(double t, const double* x, const std::vector<double>& alpha) {
  CellChange change = CellChange::none;
  for (int c = 0; c < kernel_.cells(); ++c) {
    if (undefined_[at(c)]) change = std::max(change, place(c, t, x, alpha));
  }
  return change;
}

bool Cells::moved_in(int function) const {
  for (std::size_t c = 0; c < moved_.size(); ++c) {
    if (moved_[c] && kernel_.depends_on_cell(function, static_cast<int>(c))) return true;
  }
  return false;
}

std::string Cells::moved_names(const model::Layout& layout) const {
  std::string text;
  for (std::size_t c = 0; c < moved_.size(); ++c) {
    if (!moved_[c] || kernel_.cell_table(static_cast<int>(c)).change != model::CellTable::Change::jump) continue;
    text += (text.empty() ? "" : ", ") + layout.cell_names[c];
  }
  return text;
}

std::vector<int> zeros_at(const evaluation::ModelKernel& kernel, const ModeState& state, double t, const double* x) {
  const auto n_phi = at(kernel.event_functions());
  std::vector<double> values(n_phi), magnitude(n_phi), slope(n_phi);
  kernel.functions(t, x, state.alpha.data(), values.data());
  kernel.scales(t, x, state.alpha.data(), magnitude.data(), slope.data());
  std::vector<int> zeros(state.mode.size(), 0);
  for (std::size_t j = 0; j < zeros.size(); ++j) {
    if (state.mode[j] != 0 && std::abs(values[j]) <= rounding_of(magnitude[j])) zeros[j] = 1;
  }
  return zeros;
}

}  // namespace saltus::event_integrator
