#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>

#include <casadi/core/function.hpp>
#include <casadi/core/sx_elem.hpp>

#include "saltus/base/at.hpp"
#include "saltus/evaluation/root_limits_internal.hpp"
#include "saltus/model/graph/interpret.hpp"

// Needs names that only the headers above bring.
#include <casadi/core/calculus.hpp>

namespace saltus::evaluation {
namespace {

using casadi::SX;
using casadi::SXElem;

constexpr std::size_t points = 3;
using Values = std::array<double, points>;

/// A value of the tape: its expression, its numbers at the points, and the functions it is 0 with.
struct SampledValue {
  SXElem expression = 0.0;
  Values values{};
  bool zero = false;           ///< the constant 0, which is 0 with all of them
  std::vector<int> with = {};  ///< ascending
};

/// What is 0 with both, as a sum of them is.
void intersect(const SampledValue& a, const SampledValue& b, SampledValue& result) {
  if (a.zero || b.zero) {
    result.zero = a.zero && b.zero;
    result.with = a.zero ? b.with : a.with;
    return;
  }
  std::set_intersection(a.with.begin(), a.with.end(), b.with.begin(), b.with.end(), std::back_inserter(result.with));
}

/// What is 0 with either, as their product is.
void unite(const SampledValue& a, const SampledValue& b, SampledValue& result) {
  result.zero = a.zero || b.zero;
  if (result.zero) return;
  std::set_union(a.with.begin(), a.with.end(), b.with.begin(), b.with.end(), std::back_inserter(result.with));
}

bool is_multiple(const Values& a, const Values& b) {
  constexpr double rounding = 1e-12;  // of differences of terms of size one
  const double factor = a[0] / b[0];
  if (!std::isfinite(factor) || factor == 0.0) return false;
  for (std::size_t k = 1; k < points; ++k) {
    if (!(std::abs(a[k] - factor * b[k]) <= rounding * std::abs(a[k]))) return false;
  }
  return true;
}

bool is_root(casadi_int operation, const SampledValue& exponent) {
  if (operation == casadi::OP_SQRT) return true;
  if (operation != casadi::OP_POW && operation != casadi::OP_CONSTPOW) return false;
  const double q = exponent.values[0];
  const bool constant =
      std::all_of(exponent.values.begin(), exponent.values.end(), [q](double other) { return other == q; });
  return constant && q > 0.0 && q != std::floor(q);
}

bool has_roots(const casadi::Function& tape) {
  for (casadi_int k = 0; k < tape.n_instructions(); ++k) {
    const auto operation = tape.instruction_id(k);
    if (operation == casadi::OP_SQRT || operation == casadi::OP_POW || operation == casadi::OP_CONSTPOW) return true;
  }
  return false;
}

class Limiter {
 public:
  Limiter(const casadi::Function& tape, const SX& psi, const ModelSymbols& symbols,
          const std::vector<double>& parameters)
      : tape_(tape),
        symbols_(symbols),
        inputs_{symbols.t, symbols.x, symbols.p, symbols.alpha},
        psi_expressions_(psi),
        work_(tape.sz_w()) {
    // Points in general position: no two expressions that differ agree at three of them.
    std::uint64_t state = 88172645463325252U;
    const auto next = [&state] {
      state ^= state << 13U;
      state ^= state >> 7U;
      state ^= state << 17U;
      return 0.25 + static_cast<double>(state >> 11U) * 0x1p-53;
    };
    for (std::size_t i = 0; i < inputs_.size(); ++i) {
      numbers_[i].resize(at(inputs_[i].numel()));
      for (std::size_t entry = 0; entry < numbers_[i].size(); ++entry) {
        for (double& value : numbers_[i][entry]) {
          value = i == 2 && entry < parameters.size() ? parameters[entry] : next();
        }
      }
    }
    result_.rooted.assign(at(psi.numel()), false);
    result_.continued = result_.rooted;
    find_values_of(psi);
    column_.assign(at(tape.size1_out(0)), SXElem(0.0));
  }

  /// Whether every operation of f is one of scalars.
  bool run() {
    if (!take_all()) return false;
    if (roots_.empty()) return true;
    find_jumps();
    return take_all();
  }

  [[nodiscard]] RootLimits result() {
    result_.f = SX(std::vector<SXElem>(column_));
    return result_;
  }

 private:
  void find_values_of(const SX& psi) {
    psi_.resize(at(psi.numel()));
    const casadi::Function function("psi", inputs_, {SX::densify(psi)});
    for (std::size_t k = 0; k < points; ++k) {
      const std::vector<double> values = function(point(k)).front().nonzeros();
      for (std::size_t j = 0; j < psi_.size(); ++j) psi_[j][k] = values[j];
    }
  }

  bool take_all() {
    for (casadi_int k = 0; k < tape_.n_instructions(); ++k) {
      if (!take(k)) return false;
    }
    return true;
  }

  /// f at a point with the roots that were found left out, on one side of a surface.
  [[nodiscard]] std::vector<double> without_roots(std::size_t point, std::size_t surface, double selection) const {
    const auto input = [&](casadi_int argument, casadi_int entry) {
      const bool is_it = argument == 3 && at(entry) == surface;
      return is_it ? selection : numbers_[at(argument)][at(entry)][point];
    };
    const auto operate = [&](casadi_int k, casadi_int operation, double a, double b) {
      return std::binary_search(roots_.begin(), roots_.end(), k) ? 0.0 : model::operated(operation, a, b);
    };
    return model::interpret<double>(tape_, input, operate);
  }

  /// Of each of the functions that have roots, whether d psi_j/dt jumps on its surface and is zero on neither side.
  void find_jumps() {
    const casadi::Function gradients("gradients", inputs_,
                                     {SX::densify(SX::jacobian(psi_expressions_, symbols_.x)),
                                      SX::densify(SX::jacobian(psi_expressions_, symbols_.t))});
    has_jumps_ = true;
    for (std::size_t k = 0; k < points; ++k) {
      const auto derivatives = gradients(point(k));
      const std::vector<double> rows = derivatives[0].nonzeros(), rates = derivatives[1].nonzeros();  // by columns
      for (std::size_t j = 0; j < psi_.size(); ++j) {
        if (!result_.rooted[j]) continue;
        const auto below = without_roots(k, j, 0.0), above = without_roots(k, j, 1.0);
        double low = rates[j], high = rates[j], terms = std::abs(rates[j]);
        for (std::size_t i = 0; i < below.size(); ++i) {
          const double row = rows[i * psi_.size() + j];
          if (row == 0.0) continue;
          low += row * below[i];
          high += row * above[i];
          terms += std::abs(row) * (std::abs(above[i]) + std::abs(below[i]));
        }
        const double rounding = 1e-12 * terms;
        const bool jumps = std::abs(high - low) > rounding;
        if (jumps && std::abs(low) > rounding && std::abs(high) > rounding) result_.continued[j] = true;
      }
    }
  }

  [[nodiscard]] std::vector<casadi::DM> point(std::size_t k) const {
    std::vector<casadi::DM> arguments;
    for (const auto& entries : numbers_) {
      std::vector<double> column;
      for (const auto& values : entries) column.push_back(values[k]);
      arguments.emplace_back(column);
    }
    return arguments;
  }

  bool take(casadi_int k) {
    const auto operation = tape_.instruction_id(k);
    const auto in = tape_.instruction_input(k);
    const auto out = tape_.instruction_output(k);
    switch (operation) {
      case casadi::OP_CALL:
        return false;
      case casadi::OP_CONST: {
        const double value = tape_.instruction_constant(k);
        SampledValue constant{SXElem(value), {}, value == 0.0};
        constant.values.fill(value);
        work_[at(out[0])] = std::move(constant);
        return true;
      }
      case casadi::OP_INPUT:
        work_[at(out[0])] = {inputs_[at(in[0])].nonzeros()[at(in[1])], numbers_[at(in[0])][at(in[1])]};
        find_multiples(work_[at(out[0])]);
        return true;
      case casadi::OP_OUTPUT:
        column_[at(out[1])] = work_[at(in[0])].expression;
        return true;
      default:
        break;
    }
    if (in.empty() || in.size() > 2) return false;
    const SampledValue& a = work_[at(in.front())];
    const SampledValue& b = work_[at(in.back())];
    SampledValue value;
    value.expression =
        in.size() == 2 ? SXElem::binary(operation, a.expression, b.expression) : SXElem::unary(operation, a.expression);
    for (std::size_t p = 0; p < points; ++p) {
      casadi::casadi_math<double>::fun(static_cast<unsigned char>(operation), a.values[p], b.values[p],
                                       value.values[p]);
    }
    find_zeros(operation, a, b, value);
    if (is_root(operation, b) && !a.with.empty()) limit(k, a, value);
    work_[at(out[0])] = std::move(value);
    return true;
  }

  void find_zeros(casadi_int operation, const SampledValue& a, const SampledValue& b, SampledValue& value) const {
    switch (operation) {
      case casadi::OP_ADD:
      case casadi::OP_SUB:
        intersect(a, b, value);
        break;
      case casadi::OP_MUL:
        unite(a, b, value);
        break;
      case casadi::OP_IF_ELSE_ZERO:
        value.zero = b.zero;
        value.with = b.with;
        break;
      case casadi::OP_NEG:
      case casadi::OP_TWICE:
      case casadi::OP_SQ:
      case casadi::OP_DIV:
      case casadi::OP_SQRT:
      case casadi::OP_FABS:
        value.zero = a.zero;
        value.with = a.with;
        break;
      default:
        break;
    }
    if (value.with.empty() && !value.zero) find_multiples(value);
  }

  void find_multiples(SampledValue& value) const {
    for (std::size_t j = 0; j < psi_.size(); ++j) {
      if (is_multiple(value.values, psi_[j])) value.with.push_back(static_cast<int>(j));
    }
  }

  /// NOTE: the zero of if_else_zero hides the infinite derivative of the root, in derivatives of f, too.
  void limit(casadi_int instruction, const SampledValue& argument, SampledValue& root) {
    if (!has_jumps_) {
      roots_.push_back(instruction);
      for (const int j : argument.with) result_.rooted[at(j)] = true;
      return;
    }
    constexpr double rounding = 8.0 * std::numeric_limits<double>::epsilon();
    const SX e = argument.expression;
    const SX terms = SX::mtimes(fabs(SX::jacobian(e, symbols_.x)), fabs(symbols_.x)) +
                     fabs(SX::jacobian(e, symbols_.t) * symbols_.t);
    const bool jumps =
        std::all_of(argument.with.begin(), argument.with.end(), [&](int j) { return result_.continued[at(j)]; });
    const SX clear = (jumps ? e : fabs(e)) > rounding * terms;
    root.expression = SXElem::binary(casadi::OP_IF_ELSE_ZERO, clear.scalar(), root.expression);
  }

  const casadi::Function& tape_;
  const ModelSymbols& symbols_;
  std::vector<SX> inputs_;
  std::array<std::vector<Values>, 4> numbers_;
  SX psi_expressions_;
  std::vector<Values> psi_;
  std::vector<casadi_int> roots_;  ///< instructions, ascending
  bool has_jumps_ = false;         ///< that find_jumps was here
  std::vector<SampledValue> work_;
  std::vector<SXElem> column_;
  RootLimits result_;
};

}  // namespace

RootLimits limit_roots(const SX& f, const SX& psi, const ModelSymbols& symbols, const std::vector<double>& parameters) {
  const std::vector<bool> none(at(psi.numel()), false);
  RootLimits unchanged{f, none, none, false};
  if (psi.numel() == 0 || f.numel() == 0) return unchanged;
  const casadi::Function tape("tape", {symbols.t, symbols.x, symbols.p, symbols.alpha}, {SX::densify(f)});
  if (!has_roots(tape)) return unchanged;
  Limiter limiter(tape, psi, symbols, parameters);
  auto limited = limiter.run() ? limiter.result() : unchanged;
  limited.by_values = true;
  return limited;
}

}  // namespace saltus::evaluation
