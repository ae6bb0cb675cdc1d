#include <array>
#include <cmath>
#include <numeric>
#include <unordered_set>
#include <utility>
#include <vector>

#include <casadi/core/function.hpp>
#include <fmt/format.h>

#include "saltus/model/graph/interpret.hpp"
#include "saltus/model/mechanics/contacts_internal.hpp"
#include "saltus/model/statement/start_values_internal.hpp"
#include "saltus/model/written_friction_internal.hpp"

namespace saltus::model {

using casadi::SX;

namespace {

/// A norm in an expression: two expressions, and their norm as a symbol of its own.
struct PlaneNorm {
  std::array<SXElem, 2> w;
  SXElem symbol;

  [[nodiscard]] bool is_of(const SXElem& a, const SXElem& b) const {
    constexpr casadi_int depth = 100;
    return SXElem::is_equal(w[0], a, depth) && SXElem::is_equal(w[1], b, depth);
  }
};

/// a of a^2.
std::optional<SXElem> root_of_square(const SXElem& e) {
  if (e.is_op(casadi::OP_SQ)) return e.dep(0);
  constexpr casadi_int depth = 100;
  if (e.is_op(casadi::OP_MUL) && SXElem::is_equal(e.dep(0), e.dep(1), depth)) return e.dep(0);
  const bool power = e.is_op(casadi::OP_POW) || e.is_op(casadi::OP_CONSTPOW);
  if (power && e.dep(1).is_constant() && static_cast<double>(e.dep(1)) == 2.0) return e.dep(0);
  return std::nullopt;
}

/// Whether a root is taken in expressions. Cost: one visit of each operation.
bool have_roots(std::vector<SXElem> open) {
  std::unordered_set<const void*> seen;
  while (!open.empty()) {
    const SXElem e = open.back();
    open.pop_back();
    if (e.is_leaf() || !seen.insert(e.get()).second) continue;
    if (e.is_op(casadi::OP_HYPOT) || e.is_op(casadi::OP_SQRT)) return true;
    for (casadi_int k = 0; k < e.n_dep(); ++k) open.push_back(e.dep(k));
  }
  return false;
}

/// Expressions with the norms in them replaced by symbols.
class NormsReplaced {
 public:
  explicit NormsReplaced(const SX& f) : symbols_(SX::vertcat(SX::symvar(f))) {
    const casadi::Function function("f", {symbols_}, {SX::densify(f)});
    const auto result = interpret<SXElem>(
        function, [&](casadi_int, casadi_int entry) { return symbols_(entry).scalar(); },
        [&](casadi_int, casadi_int operation, const SXElem& a, const SXElem& b) { return value_of(operation, a, b); });
    rates_ = SX(casadi::Sparsity::dense(f.size1(), 1), result);
  }

  [[nodiscard]] const SX& rates() const { return rates_; }
  [[nodiscard]] const std::vector<PlaneNorm>& norms() const { return norms_; }

 private:
  SXElem value_of(casadi_int operation, const SXElem& first, const SXElem& second) {
    if (operation == casadi::OP_HYPOT) return norm_of(first, second);
    if (operation == casadi::OP_SQRT && first.is_op(casadi::OP_ADD)) {
      const auto a = root_of_square(first.dep(0)), b = root_of_square(first.dep(1));
      if (a && b) return norm_of(*a, *b);
    }
    return operated(operation, first, second);
  }

  SXElem norm_of(const SXElem& a, const SXElem& b) {
    for (const auto& norm : norms_) {
      if (norm.is_of(a, b)) return norm.symbol;
    }
    norms_.push_back({{a, b}, SX::sym(fmt::format("norm{}", norms_.size())).scalar()});
    return norms_.back().symbol;
  }

  SX symbols_, rates_;
  std::vector<PlaneNorm> norms_;
};

class FrictionInPlane {
 public:
  FrictionInPlane(Recognition& recognition, Statement& statement) : recognition_(recognition), statement_(statement) {}

  void run() {
    for (const auto& state : statement_.states) {
      if (!state.dynamics) return;
    }
    states_.resize(statement_.states.size());
    std::iota(states_.begin(), states_.end(), 0);
    x_ = symbols_of(statement_, states_);
    std::vector<SXElem> rates;
    for (const auto& state : statement_.states) rates.push_back(*state.dynamics);
    if (!have_roots(rates)) return;
    const NormsReplaced replaced{SX(rates)};
    f_ = replaced.rates();
    std::vector<PlaneNorm> others;
    std::vector<SXElem> symbols;
    for (const auto& norm : replaced.norms()) {
      symbols.push_back(norm.symbol);
      if (!take(norm)) others.push_back(norm);
    }
    if (taken_.empty()) return;
    // The last ones first: they may have others inside.
    for (auto norm = others.rbegin(); norm != others.rend(); ++norm) {
      const SX w = SX::vertcat({SX(norm->w[0]), SX(norm->w[1])});
      f_ = SX::substitute(f_, SX(norm->symbol), sqrt(w(0) * w(0) + w(1) * w(1)));
    }
    if (SX::depends_on(f_, SX(symbols))) return;
    state();
  }

 private:
  struct Taken {
    SX w;        ///< 2
    SX columns;  ///< n x 2: B
    std::string name;
  };

  /// f = rest + B w/|w|, with B constant in w.
  bool take(const PlaneNorm& norm) {
    const SX w = SX::vertcat({SX(norm.w[0]), SX(norm.w[1])}), rows = SX::jacobian(w, x_);
    std::vector<casadi_int> moving;
    for (casadi_int k = 0; k < x_.numel(); ++k) {
      if (rows(casadi::Slice(), k).nnz() > 0) moving.push_back(k);
    }
    if (moving.size() < 2) return false;
    const SX along = SX(norm.symbol);
    // 1/|w| at 1 and 2: the difference is B w if that is how the norm is in f.
    const SX once = SX::substitute(f_, along, SX(1.0)), twice = SX::substitute(f_, along, SX(0.5));
    for (std::size_t first = 0; first < moving.size(); ++first) {
      for (std::size_t second = first + 1; second < moving.size(); ++second) {
        const std::vector<casadi_int> pair{moving[first], moving[second]};
        const SX part = rows(casadi::Slice(), pair), chosen = x_(pair);
        if (SX::depends_on(part, x_)) continue;
        const SX determinant = part(0, 0) * part(1, 1) - part(0, 1) * part(1, 0);
        const double size = std::sqrt(std::abs(value(determinant)));
        if (!(size > 0.0)) continue;
        const SX inverse =
            SX::blockcat({{part(1, 1), -part(0, 1)}, {-part(1, 0), part(0, 0)}}) / SX::repmat(determinant, 2, 2);
        const SX columns = SX::mtimes(SX::jacobian(twice - once, chosen), inverse);
        if (is_friction(w, columns, along, once, chosen)) {
          f_ = once - SX::mtimes(columns, w);
          const auto [controls, inputs] = controls_and_inputs();
          // w/|w| is the same for w in units of the states, in which tolerances are.
          taken_.push_back({SX::substitute(w, controls, inputs) / size, columns,
                            fmt::format("friction of {}, {}", names(moving[first]), names(moving[second]))});
          return true;
        }
      }
    }
    return false;
  }

  [[nodiscard]] std::string names(casadi_int state) const { return statement_.states[at(state)].name; }

  /// Whether f - B w/|w| does not depend on the norm, and B w moves w against itself.
  [[nodiscard]] bool is_friction(const SX& w, const SX& columns, const SX& norm, const SX& once, const SX& chosen) {
    if (SX::depends_on(columns, chosen) || SX::depends_on(columns, norm)) return false;
    if (SX::depends_on(columns, controls_and_inputs().first)) return false;
    const SX rest = once - SX::mtimes(columns, w);
    const SX left = f_ - rest - SX::mtimes(columns, w) / norm;
    if (!vanishes(left, f_, norm)) return false;
    const SX influence = -SX::mtimes(SX::jacobian(w, x_), columns);
    const double a = value(influence(0, 0)), d = value(influence(1, 1));
    const double mixed = 0.5 * (value(influence(0, 1)) + value(influence(1, 0)));
    return a > 0.0 && d > 0.0 && a * d > mixed * mixed;
  }

  /// Of each control its symbol, and what it is in a simulation.
  [[nodiscard]] std::pair<SX, SX> controls_and_inputs() const {
    std::vector<SXElem> symbols{SX::sym("none").scalar()}, inputs{SXElem(0.0)};
    for (const auto& control : statement_.controls) {
      symbols.push_back(control.symbol);
      inputs.push_back(control.input ? *control.input : SXElem(control.initial));
    }
    return {SX(symbols), SX(inputs)};
  }

  /// Whether an expression is the rounding of others at points that share nothing.
  [[nodiscard]] static bool vanishes(const SX& expression, const SX& terms, const SX& norm) {
    const SX symbols = SX::vertcat(SX::symvar(SX::vertcat({expression, terms, norm})));
    const casadi::Function function("f", {symbols}, {expression, terms});
    for (int point = 1; point <= 4; ++point) {
      std::vector<double> at_point;
      for (casadi_int k = 0; k < symbols.numel(); ++k) {
        at_point.push_back(0.3 +
                           std::fmod(0.618033988749895 * static_cast<double>((k + 1) * point) + 0.37 * point, 1.0));
      }
      const auto values = function(std::vector<casadi::DM>{casadi::DM(at_point)});
      for (casadi_int i = 0; i < expression.numel(); ++i) {
        const double size = 1.0 + std::abs(static_cast<double>(values[1](i)));
        if (!(std::abs(static_cast<double>(values[0](i))) <= 1e-12 * size)) return false;
      }
    }
    return true;
  }

  /// At the start; not a number where there is none.
  [[nodiscard]] double value(const SX& expression) {
    const auto node = recognition_.graph.add(SX::densify(expression).scalar());
    return node ? value_at_start(recognition_, statement_, *node) : std::nan("");
  }

  void state() {
    const auto m = static_cast<casadi_int>(taken_.size());
    ContactSystem system;
    system.velocities = states_;
    system.gap = system.friction = SX::ones(m, 1);
    system.restitution = SX::zeros(m, 1);
    system.velocity = SX::zeros(3 * m, 1);
    system.responses = SX::zeros(x_.numel(), 3 * m);
    for (casadi_int i = 0; i < m; ++i) {
      const auto& taken = taken_[static_cast<std::size_t>(i)];
      system.contacts.push_back({.name = taken.name, .has_gap = false, .has_friction = true, .in_plane = true});
      for (casadi_int k = 0; k < 2; ++k) {
        system.velocity((1 + k) * m + i) = taken.w(k);
        system.responses(casadi::Slice(), (1 + k) * m + i) = -taken.columns(casadi::Slice(), k);
      }
    }
    system.rows = SX::densify(SX::jacobian(system.velocity, x_));
    system.acceleration = SX::densify(SX::mtimes(system.rows, f_) + SX::jacobian(system.velocity, SX(statement_.time)));
    const SX forces =
        state_contact_modes(recognition_, statement_, std::move(system), std::vector<SourceLocation>(taken_.size()));
    const SX rates = SX::densify(f_ + SX::mtimes(statement_.contacts.responses, forces));
    for (std::size_t i = 0; i < states_.size(); ++i) {
      statement_.states[i].dynamics = SX(rates(static_cast<casadi_int>(i))).scalar();
    }
  }

  Recognition& recognition_;
  Statement& statement_;
  std::vector<int> states_;
  SX x_, f_;
  std::vector<Taken> taken_;
};

}  // namespace

void state_written_friction(Recognition& recognition, Statement& statement) {
  if (statement.contacts.empty()) FrictionInPlane(recognition, statement).run();
}

}  // namespace saltus::model
