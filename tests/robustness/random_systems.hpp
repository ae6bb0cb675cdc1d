// Random piecewise-smooth systems as plain numbers, and their right-hand sides for any kind of scalar.
#pragma once

#include <cmath>
#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

namespace saltus::robustness {

enum class Family {
  affine,    ///< multi-affine table of affine fields, affine surfaces, some of them moving
  nested,    ///< max, abs and saturations, inside and outside of signs, signs inside of signs
  friction,  ///< oscillators with additive friction laws: decoupled selections
  smooth,    ///< multi-affine table of nonlinear fields, curved surfaces
  constant,  ///< multi-affine table of constant fields that point to affine surfaces more often than not
};
inline constexpr Family families[] = {Family::affine, Family::nested, Family::friction, Family::smooth,
                                      Family::constant};
[[nodiscard]] std::string name(Family family);

/// c + sum a_i x_i + rate t + sum of products and sines.
struct Form {
  struct Term {
    enum class Kind { product, bounded_product, sine_of_state, sine_of_time };
    Kind kind = Kind::product;
    double coefficient = 0.0;
    std::size_t i = 0, j = 0;
    double frequency = 1.0;
  };
  double constant = 0.0;
  std::vector<double> slope;  ///< n
  double rate = 0.0;
  std::vector<Term> terms;
};

/// coefficient * expression, added to one component of the right-hand side.
struct Nonsmooth {
  enum class Kind {
    sign,          ///< sign(e0)
    sign_of_max,   ///< sign(e0 + max(e1, e2))
    sign_of_abs,   ///< sign(|e0| - 1)
    sign_of_sign,  ///< sign(e0 + sign(e1)/2), the inner one being the switching function `inner`
    abs,           ///< |e0|
    abs_of_abs,    ///< ||e0| - 1|
    saturation,    ///< min(max(e0, -1), 1)
  };
  Kind kind = Kind::sign;
  std::size_t row = 0;
  double coefficient = 0.0;
  Form e0, e1, e2;
  std::size_t surface = 0;  ///< switching function of the outer sign
  std::size_t inner = 0;
};

/// xdot = table(alpha) (2^tabled corners, bit j = alpha_j) + nonsmooth terms. Switching functions: `surfaces`, of which
/// the table has `tabled`, then those of the terms.
struct RandomSystem {
  Family family = Family::affine;
  std::uint64_t seed = 0;
  std::size_t states = 0, surfaces = 0, tabled = 0;
  std::vector<double> start;
  std::vector<Form> psi;                   ///< tabled
  std::vector<std::vector<Form>> corners;  ///< 2^tabled x states
  std::vector<Nonsmooth> terms;
  std::vector<std::vector<std::size_t>> inner;  ///< of each switching function: those whose sign occurs in it
};

/// The system number `seed` of a family: the same on every machine.
[[nodiscard]] RandomSystem draw(Family family, std::uint64_t seed);

/// Whether a selection is the number 0 or 1, so that the other branch need not be evaluated.
template <class Scalar>
bool is_exactly(const Scalar& alpha, double value) {
  if constexpr (std::is_same_v<Scalar, double>) {
    return alpha == value;
  } else if constexpr (requires { alpha.value == value; }) {
    return alpha.value == value && alpha.derivative == 0.0;
  } else {
    return false;
  }
}

template <class Scalar>
Scalar evaluate(const Form& form, const Scalar& t, const std::vector<Scalar>& x) {
  using std::sin;
  Scalar sum = form.constant + form.rate * t;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (form.slope[i] != 0.0) sum = sum + form.slope[i] * x[i];
  }
  for (const auto& term : form.terms) {
    switch (term.kind) {
      case Form::Term::Kind::product:
        sum = sum + term.coefficient * (x[term.i] * x[term.j]);
        break;
      case Form::Term::Kind::bounded_product:  // grows linearly: the solution exists for ever
        sum = sum + term.coefficient * (x[term.i] * sin(x[term.j]));
        break;
      case Form::Term::Kind::sine_of_state:
        sum = sum + term.coefficient * sin(term.frequency * x[term.i]);
        break;
      case Form::Term::Kind::sine_of_time:
        sum = sum + term.coefficient * sin(term.frequency * t);
        break;
    }
  }
  return sum;
}

/// One component of the table: selections from the highest surface downwards.
template <class Scalar>
Scalar interpolate(const RandomSystem& system, std::size_t row, const Scalar& t, const std::vector<Scalar>& x,
                   const std::vector<Scalar>& alpha, std::size_t level, std::size_t corner) {
  if (level == 0) return evaluate(system.corners[corner][row], t, x);
  const std::size_t upper_corner = corner | (std::size_t{1} << (level - 1));
  const Scalar& selection = alpha[level - 1];
  if (is_exactly(selection, 1.0)) return interpolate(system, row, t, x, alpha, level - 1, upper_corner);
  const Scalar lower = interpolate(system, row, t, x, alpha, level - 1, corner);
  if (is_exactly(selection, 0.0)) return lower;
  return lower + selection * (interpolate(system, row, t, x, alpha, level - 1, upper_corner) - lower);
}

template <class Scalar, class Switches>
Scalar evaluate(const Nonsmooth& term, const Scalar& t, const std::vector<Scalar>& x, Switches& switches) {
  using Kind = Nonsmooth::Kind;
  const Scalar e0 = evaluate(term.e0, t, x);
  const auto sign = [&](std::size_t surface, const Scalar& e) { return 2.0 * switches.step(surface, e) - 1.0; };
  switch (term.kind) {
    case Kind::sign:
      return sign(term.surface, e0);
    case Kind::sign_of_max:
      return sign(term.surface, e0 + switches.max(evaluate(term.e1, t, x), evaluate(term.e2, t, x)));
    case Kind::sign_of_abs:
      return sign(term.surface, switches.abs(e0) - 1.0);
    case Kind::sign_of_sign:
      return sign(term.surface, e0 + 0.5 * sign(term.inner, evaluate(term.e1, t, x)));
    case Kind::abs:
      return switches.abs(e0);
    case Kind::abs_of_abs:
      return switches.abs(switches.abs(e0) - 1.0);
    case Kind::saturation:
      return switches.max(-switches.max(-e0, -1.0 + 0.0 * t), -1.0 + 0.0 * t);
  }
  return e0;
}

/// The right-hand side. `switches` answers step(surface, psi), max(a, b) and abs(a), and learns every psi that way.
template <class Scalar, class Switches>
std::vector<Scalar> rates(const RandomSystem& system, const Scalar& t, const std::vector<Scalar>& x,
                          Switches& switches) {
  std::vector<Scalar> alpha;
  for (std::size_t j = 0; j < system.tabled; ++j) alpha.push_back(switches.step(j, evaluate(system.psi[j], t, x)));
  std::vector<Scalar> xdot;
  for (std::size_t row = 0; row < system.states; ++row) {
    xdot.push_back(interpolate(system, row, t, x, alpha, system.tabled, 0));
  }
  for (const auto& term : system.terms) {
    xdot[term.row] = xdot[term.row] + term.coefficient * evaluate(term, t, x, switches);
  }
  return xdot;
}

}  // namespace saltus::robustness
