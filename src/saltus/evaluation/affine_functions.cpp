#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include <casadi/core/function.hpp>
#include <casadi/core/sx.hpp>

// Needs names that only the headers above bring.
#include <casadi/core/calculus.hpp>

#include "saltus/base/at.hpp"
#include "saltus/base/contains.hpp"
#include "saltus/evaluation/affine_functions_internal.hpp"

namespace saltus::evaluation {
namespace {

using casadi::SX;

constexpr int constant_degree = 0;
constexpr int linear_degree = 1;
constexpr int other_degree = 2;

/// Degree of a result from those of its operands.
int degree_of(casadi_int operation, const std::vector<int>& operands) {
  const int first = operands.empty() ? constant_degree : operands.front();
  const int second = operands.size() < 2 ? constant_degree : operands[1];
  switch (operation) {
    case casadi::OP_ADD:
    case casadi::OP_SUB:
    case casadi::OP_NEG:
    case casadi::OP_TWICE:
    case casadi::OP_ASSIGN:
      return std::max(first, second);
    case casadi::OP_MUL:
      return first + second <= linear_degree ? first + second : other_degree;
    case casadi::OP_DIV:
      return second == constant_degree ? first : other_degree;
    case casadi::OP_IF_ELSE_ZERO:
      return first == constant_degree ? second : other_degree;
    default:
      return std::max(first, second) == constant_degree ? constant_degree : other_degree;
  }
}

std::vector<SX> inputs(const ModelSymbols& symbols) { return {symbols.t, symbols.x, symbols.p, symbols.alpha}; }

}  // namespace

std::vector<bool> affine_entries(const SX& expression, const ModelSymbols& symbols, int fixed) {
  std::vector<bool> affine(at(expression.numel()), true);
  const casadi::Function tape("tape", inputs(symbols), {SX::densify(expression)});
  std::vector<int> degree(tape.sz_w(), constant_degree);
  for (casadi_int k = 0; k < tape.n_instructions(); ++k) {
    const auto operation = tape.instruction_id(k);
    const auto in = tape.instruction_input(k);
    const auto out = tape.instruction_output(k);
    if (operation == casadi::OP_CONST) {
      degree[at(out[0])] = constant_degree;
    } else if (operation == casadi::OP_INPUT) {
      const bool varies = in[0] == 0 || (in[0] == 1 && in[1] != fixed);
      degree[at(out[0])] = varies ? linear_degree : constant_degree;
    } else if (operation == casadi::OP_OUTPUT) {
      affine[at(out[1])] = degree[at(in[0])] != other_degree;
    } else if (operation == casadi::OP_CALL) {
      for (const auto place : out) degree[at(place)] = other_degree;
    } else {
      std::vector<int> operands;
      for (const auto place : in) operands.push_back(degree[at(place)]);
      degree[at(out[0])] = degree_of(operation, operands);
    }
  }
  return affine;
}

AffineRowFunctions::AffineRowFunctions(const SX& functions, const ModelSymbols& symbols,
                                       const std::vector<bool>& affine)
    : origin_(at(symbols.x.numel()), 0.0), start_{0} {
  SX values = SX::densify(functions);
  for (std::size_t j = 0; j < affine.size(); ++j) {
    if (!affine[j]) values.nonzeros()[j] = std::numeric_limits<double>::quiet_NaN();
  }
  const SX jacobian = SX::jacobian(values, symbols.x);
  const SX rates = SX::densify(SX::jacobian(values, symbols.t));
  const auto& sparsity = jacobian.sparsity();
  std::vector<std::vector<std::pair<std::size_t, casadi_int>>> entries(affine.size());  // column, place
  for (casadi_int column = 0; column < sparsity.size2(); ++column) {
    for (casadi_int k = sparsity.colind()[column]; k < sparsity.colind()[column + 1]; ++k) {
      const auto row = at(sparsity.row()[k]);
      entries[row].emplace_back(at(column), k);
    }
  }
  std::vector<SX> coefficients, rate, offset;
  for (std::size_t j = 0; j < affine.size(); ++j) {
    const auto row = static_cast<casadi_int>(j);
    for (const auto& [column, place] : entries[j]) {
      column_.push_back(column);
      coefficients.emplace_back(jacobian.nonzeros()[at(place)]);
    }
    start_.push_back(column_.size());
    rate.emplace_back(rates(row));
    offset.emplace_back(values(row));
  }
  const auto column_of = [](const std::vector<SX>& rows) { return rows.empty() ? SX(0, 1) : SX::vertcat(rows); };
  values_ = ModelFunction("saltus_affine_rows", inputs(symbols),
                          {column_of(coefficients), column_of(rate), column_of(offset)});
}

void AffineRowFunctions::fill(const double* p, const double* alpha, AffineRows& rows) {
  rows.start = start_;
  rows.column = column_;
  rows.coefficient.resize(column_.size());
  rows.rate.resize(start_.size() - 1);
  rows.offset.resize(start_.size() - 1);
  // At the origin an affine function is its offset.
  const double t = 0.0;
  values_(std::array<const double*, 4>{&t, origin_.data(), p, alpha},
          std::array<double*, 3>{rows.coefficient.data(), rows.rate.data(), rows.offset.data()});
}

AffineRowFunction::AffineRowFunction(const SX& function, const SX& t, UsedSymbols used, int fixed)
    : states_(std::move(used.x.place)),
      parameters_(std::move(used.p.place)),
      alphas_(std::move(used.alpha.place)),
      origin_(states_.size(), 0.0),
      p_(parameters_.size()),
      alpha_(alphas_.size()) {
  const auto found = std::find(states_.begin(), states_.end(), static_cast<std::size_t>(fixed));
  if (fixed >= 0 && found != states_.end()) fixed_ = static_cast<int>(found - states_.begin());
  const ModelSymbols symbols{t, used.x.symbols, used.p.symbols, used.alpha.symbols};
  if (!affine_entries(function, symbols, fixed_).front()) return;
  values_ = ModelFunction("affine_row", inputs(symbols),
                          {SX::jacobian(function, symbols.x), SX::jacobian(function, symbols.t), function});
}

void AffineRowFunction::fill(FixedState fixed, const double* p, const double* alpha, AffineRow& row) {
  row.column = states_;
  row.coefficient.resize(states_.size());
  if (fixed_ >= 0) origin_[at(fixed_)] = fixed.value;
  for (std::size_t k = 0; k < p_.size(); ++k) p_[k] = p[parameters_[k]];
  for (std::size_t k = 0; k < alpha_.size(); ++k) alpha_[k] = alpha[alphas_[k]];
  const double t = 0.0;
  values_(std::array<const double*, 4>{&t, origin_.data(), p_.data(), alpha_.data()},
          std::array<double*, 3>{row.coefficient.data(), &row.rate, &row.offset});
  if (fixed_ >= 0) row.coefficient[at(fixed_)] = 0.0;
}

LinearFieldFunction::LinearFieldFunction(const SX& f, const ModelSymbols& symbols) : start_{0} {
  const auto affine = affine_entries(f, symbols);
  if (contains(affine, false)) return;
  const SX jacobian = SX::jacobian(f, symbols.x).T();  // its columns are the rows of A
  const auto& sparsity = jacobian.sparsity();
  for (casadi_int row = 0; row < sparsity.size2(); ++row) {
    for (casadi_int k = sparsity.colind()[row]; k < sparsity.colind()[row + 1]; ++k) {
      column_.push_back(at(sparsity.row()[k]));
    }
    start_.push_back(column_.size());
  }
  const auto nonzeros = jacobian.nonzeros();
  const SX entries = nonzeros.empty() ? SX(0, 1) : SX(nonzeros);
  const SX rates = SX::densify(SX::jacobian(f, symbols.t));
  entries_.resize(column_.size());
  constant_ = !SX::depends_on(SX::vertcat({entries, rates}), symbols.alpha);
  values_ = ModelFunction("linear_field", {symbols.p, symbols.alpha}, {entries, rates});
}

void LinearFieldFunction::fill(const double* p, const double* alpha, ode::LinearField& field) {
  const std::size_t n = start_.size() - 1;
  field.diagonal.assign(n, 0.0);
  field.rate.resize(n);
  values_(std::array<const double*, 2>{p, alpha}, std::array<double*, 2>{entries_.data(), field.rate.data()});
  field.start.assign(1, 0);
  field.column.clear();
  field.entry.clear();
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = start_[i]; k < start_[i + 1]; ++k) {
      if (column_[k] == i) {
        field.diagonal[i] = entries_[k];
      } else if (entries_[k] != 0.0) {
        field.column.push_back(column_[k]);
        field.entry.push_back(entries_[k]);
      }
    }
    field.start.push_back(field.column.size());
  }
  const auto is_zero = [](double value) { return value == 0.0; };
  if (std::all_of(field.rate.begin(), field.rate.end(), is_zero)) field.rate.clear();
}

}  // namespace saltus::evaluation
