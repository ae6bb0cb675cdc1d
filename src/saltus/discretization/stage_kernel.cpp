#include "saltus/discretization/stage_kernel.hpp"

#include <array>
#include <exception>
#include <string>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/discretization/dcs_expressions_internal.hpp"
#include "saltus/evaluation/native_functions.hpp"
#include "saltus/model/graph/model_function.hpp"

namespace saltus::discretization {

using casadi::SX;

namespace {

/// Smaller systems, and those in which a larger share of the derivatives of f can be other than 0, are faster with
/// dense matrices. Measured with chains of blocks (benchmarks/results/large.md). What a root adds to derivatives is in
/// no pattern.
constexpr casadi_int fewest_states = 32;
constexpr casadi_int least_saving = 6;

bool is_worth_entries(const reformulation::Dcs& dcs, const SX& f_x) {
  const casadi_int n = dcs.x.numel();
  return n >= fewest_states && f_x.nnz() * least_saving <= n * n && dcs.root_exponents.empty();
}

EntryPattern by_columns_and_rows(const casadi::Sparsity& sparsity) {
  EntryPattern pattern{static_cast<int>(sparsity.size1()), static_cast<int>(sparsity.size2()), {}, {}, {}, {}, {}};
  const auto starts = sparsity.get_colind(), rows = sparsity.get_row();
  pattern.start.assign(starts.begin(), starts.end());
  pattern.row.assign(rows.begin(), rows.end());
  pattern.row_start.assign(at(pattern.rows) + 1, 0);
  for (const int row : pattern.row) ++pattern.row_start[at(row) + 1];
  for (std::size_t i = 0; i < at(pattern.rows); ++i) pattern.row_start[i + 1] += pattern.row_start[i];
  pattern.column.resize(pattern.size());
  pattern.place.resize(pattern.size());
  auto next = pattern.row_start;
  for (int column = 0; column < pattern.columns; ++column) {
    for (int e = pattern.start[at(column)]; e < pattern.start[at(column) + 1]; ++e) {
      const auto to = at(next[at(pattern.row[at(e)])]++);
      pattern.column[to] = column;
      pattern.place[to] = e;
    }
  }
  return pattern;
}

}  // namespace

struct StageKernel::Implementation {
  std::vector<double> parameters;
  std::size_t n_x = 0, n_selections = 0;
  StagePattern pattern;
  std::vector<double> root_exponents;
  mutable model::ModelFunction everything, values, indicators;
  mutable model::ModelFunction with_roots;  ///< null without roots
  mutable evaluation::NativeFunctions native;
  mutable long evaluations = 0;
};

StageKernel::StageKernel(std::unique_ptr<Implementation> implementation) : implementation_(std::move(implementation)) {}
StageKernel::StageKernel(StageKernel&&) noexcept = default;
StageKernel& StageKernel::operator=(StageKernel&&) noexcept = default;
StageKernel::~StageKernel() = default;

Expected<StageKernel> StageKernel::compile(const reformulation::Dcs& dcs, std::vector<double> parameters,
                                           evaluation::NativeCode native) {
  try {
    auto kernel = std::make_unique<Implementation>();
    kernel->parameters = std::move(parameters);
    const SX f = without_lifting(dcs, with_inputs(dcs, dcs.f));
    const SX psi = with_inputs(dcs, dcs.indicator);
    kernel->n_x = static_cast<std::size_t>(dcs.x.numel());
    kernel->n_selections = static_cast<std::size_t>(dcs.selection.numel());
    const SX f_x = SX::jacobian(f, dcs.x);
    kernel->pattern.is_sparse = is_worth_entries(dcs, f_x);
    const auto kept = [&](const SX& matrix, EntryPattern& pattern) {
      const SX all = kernel->pattern.is_sparse ? matrix : SX::densify(matrix);
      pattern = by_columns_and_rows(all.sparsity());
      return entries_of(all);
    };
    kernel->everything = model::ModelFunction(
        "saltus_stage", {dcs.t, dcs.x, dcs.selection, dcs.held, dcs.p},
        {f, psi, kept(f_x, kernel->pattern.f_x), kept(SX::jacobian(f, dcs.selection), kernel->pattern.f_selection),
         kept(SX::jacobian(psi, dcs.x), kernel->pattern.indicator_x), SX::jacobian(psi, dcs.t)});
    kernel->values =
        model::ModelFunction("saltus_stage_values", {dcs.t, dcs.x, dcs.selection, dcs.held, dcs.p}, {f, psi});
    kernel->indicators = model::ModelFunction("saltus_stage_indicators", {dcs.t, dcs.x, dcs.held, dcs.p}, {psi});
    kernel->root_exponents = dcs.root_exponents;
    if (!dcs.root_exponents.empty()) {
      const SX rooted = without_lifting(dcs, with_inputs(dcs, dcs.with_roots)), base = with_inputs(dcs, dcs.root_bases);
      kernel->with_roots = model::ModelFunction(
          "saltus_stage_roots", {dcs.t, dcs.x, dcs.selection, dcs.held, dcs.p, dcs.roots},
          {rooted, psi, SX::jacobian(rooted, dcs.x), SX::jacobian(rooted, dcs.selection), SX::jacobian(psi, dcs.x),
           SX::jacobian(psi, dcs.t), base, SX::jacobian(base, dcs.x), SX::jacobian(rooted, dcs.roots)});
    }
    std::vector<model::ModelFunction*> functions{&kernel->everything, &kernel->values, &kernel->indicators};
    if (!kernel->with_roots.is_null()) functions.push_back(&kernel->with_roots);
    auto started = kernel->native.start(native, std::move(functions));
    if (!started) return tl::unexpected(started.error());
    return StageKernel(std::move(kernel));
  } catch (const std::exception& error) {
    return tl::unexpected(Error{ErrorCode::invalid_model,
                                std::string("the model's complementarity system cannot be compiled: ") + error.what(),
                                "",
                                {},
                                {}});
  }
}

std::size_t StageKernel::states() const { return implementation_->n_x; }
std::size_t StageKernel::selections() const { return implementation_->n_selections; }
long StageKernel::evaluations() const { return implementation_->evaluations; }

const StagePattern& StageKernel::pattern() const { return implementation_->pattern; }

const std::vector<double>& StageKernel::root_exponents() const { return implementation_->root_exponents; }

void StageKernel::size(RootValues& values) const {
  const std::size_t n_x = states(), n = root_exponents().size();
  values.base.resize(n);
  values.base_x.resize(n * n_x);
  values.f_root.resize(n_x * n);
}

void StageKernel::size(StageValues& values) const {
  const std::size_t n_x = states(), n = selections();
  values.f.resize(n_x);
  values.indicator.resize(n);
  values.pattern = &pattern();
  values.f_x.resize(values.pattern->f_x.size());
  values.f_selection.resize(values.pattern->f_selection.size());
  values.indicator_x.resize(values.pattern->indicator_x.size());
  values.indicator_t.resize(n);
}

void StageKernel::evaluate(double t, const double* x, const double* selection, const double* held,
                           StageValues& values) const {
  auto& kernel = *implementation_;
  ++kernel.evaluations;
  const std::array<const double*, 5> in{&t, x, selection, held, kernel.parameters.data()};
  const std::array<double*, 6> out{values.f.data(),           values.indicator.data(),   values.f_x.data(),
                                   values.f_selection.data(), values.indicator_x.data(), values.indicator_t.data()};
  kernel.native.call(kernel.everything, in, out);
}

void StageKernel::evaluate(double t, const double* x, const double* selection, const double* held, const double* root,
                           StageValues& values, RootValues& roots) const {
  auto& kernel = *implementation_;
  ++kernel.evaluations;
  const std::array<const double*, 6> in{&t, x, selection, held, kernel.parameters.data(), root};
  const std::array<double*, 9> out{values.f.data(),           values.indicator.data(),   values.f_x.data(),
                                   values.f_selection.data(), values.indicator_x.data(), values.indicator_t.data(),
                                   roots.base.data(),         roots.base_x.data(),       roots.f_root.data()};
  kernel.native.call(kernel.with_roots, in, out);
}

void StageKernel::values(double t, const double* x, const double* selection, const double* held,
                         StageValues& values) const {
  auto& kernel = *implementation_;
  ++kernel.evaluations;
  const std::array<const double*, 5> in{&t, x, selection, held, kernel.parameters.data()};
  kernel.native.call(kernel.values, in, std::array<double*, 2>{values.f.data(), values.indicator.data()});
}

void StageKernel::field(double t, const double* x, const double* selection, const double* held, double* f) const {
  auto& kernel = *implementation_;
  ++kernel.evaluations;
  const std::array<const double*, 5> in{&t, x, selection, held, kernel.parameters.data()};
  kernel.native.call(kernel.values, in, std::array<double*, 2>{f, nullptr});
}

void StageKernel::indicators(double t, const double* x, const double* held, double* indicator) const {
  auto& kernel = *implementation_;
  const std::array<const double*, 4> in{&t, x, held, kernel.parameters.data()};
  kernel.native.call(kernel.indicators, in, std::array<double*, 1>{indicator});
}

}  // namespace saltus::discretization
