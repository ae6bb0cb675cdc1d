#include "random_systems.hpp"

#include <algorithm>

#include "dice.hpp"

namespace saltus::robustness {
namespace {

Form constant_form(std::size_t states, double value) { return {value, std::vector<double>(states), 0.0, {}}; }

void add_curvature(Dice& dice, Form& form, double size, Form::Term::Kind product) {
  const auto n = form.slope.size();
  for (int k = 0; k < 2; ++k) {
    if (dice.chance(0.5)) {
      form.terms.push_back(
          {Form::Term::Kind::sine_of_state, dice.coefficient(size), dice.below(n), 0, dice.uniform(0.5, 2.0)});
    } else {
      form.terms.push_back({product, dice.uniform(-0.3, 0.3), dice.below(n), dice.below(n), 1.0});
    }
  }
}

/// A surface through the middle of the box the solution lives in.
Form surface(Dice& dice, std::size_t states, Family family) {
  Form form = constant_form(states, dice.coefficient(0.8));
  if (dice.chance(0.4)) {
    form.slope[dice.below(states)] = 1.0;
  } else {
    for (auto& a : form.slope) a = dice.coefficient(1.0);
    form.slope[dice.below(states)] = 1.0;
  }
  if (dice.chance(0.2)) form.rate = dice.coefficient(0.5);
  if (dice.chance(0.15)) {
    form.terms.push_back({Form::Term::Kind::sine_of_time, dice.coefficient(1.0), 0, 0, dice.uniform(0.5, 3.0)});
  }
  if (family == Family::smooth && dice.chance(0.7)) add_curvature(dice, form, 0.8, Form::Term::Kind::product);
  return form;
}

/// A field that contracts on average: damping on the diagonal, random couplings.
std::vector<Form> field(Dice& dice, std::size_t states) {
  std::vector<Form> rows;
  const double coupling = dice.uniform(0.0, 1.5) / std::sqrt(static_cast<double>(states));
  for (std::size_t i = 0; i < states; ++i) {
    Form row = constant_form(states, dice.coefficient(2.0));
    for (auto& a : row.slope) a = dice.coefficient(coupling);
    row.slope[i] -= dice.uniform(0.3, 1.5);
    rows.push_back(row);
  }
  return rows;
}

/// Constant velocities, turned towards the surfaces.
void make_constant(Dice& dice, const RandomSystem& system, std::size_t corner, std::vector<Form>& rows) {
  for (auto& row : rows) row.slope.assign(system.states, 0.0);
  for (std::size_t j = 0; j < system.tabled; ++j) {
    const double speed = std::abs(dice.coefficient(2.0)) * ((corner >> j & 1U) != 0 ? -1.0 : 1.0);
    for (std::size_t i = 0; i < system.states; ++i) rows[i].constant += speed * system.psi[j].slope[i];
  }
}

/// A table in which every field differs from a common one, in all or in a few components only.
void draw_table(Dice& dice, RandomSystem& system) {
  system.tabled = system.surfaces = 1 + dice.below(4);
  for (std::size_t j = 0; j < system.tabled; ++j) system.psi.push_back(surface(dice, system.states, system.family));
  const auto common = field(dice, system.states);
  const bool constant_difference = dice.chance(0.5);
  const double share = dice.chance(0.5) ? 1.0 : 0.5;
  for (std::size_t corner = 0; corner < (std::size_t{1} << system.tabled); ++corner) {
    auto own = field(dice, system.states);
    if (system.family == Family::constant) make_constant(dice, system, corner, own);
    for (std::size_t i = 0; i < system.states; ++i) {
      if (constant_difference && system.family != Family::constant) own[i].slope = common[i].slope;
      if (!dice.chance(share)) own[i] = common[i];
      if (system.family == Family::smooth) add_curvature(dice, own[i], 0.8, Form::Term::Kind::bounded_product);
    }
    system.corners.push_back(own);
  }
}

void draw_nested(Dice& dice, RandomSystem& system) {
  using Kind = Nonsmooth::Kind;
  system.corners = {field(dice, system.states)};
  const std::size_t signs = 1 + dice.below(3);
  const auto add = [&](Kind kind, std::size_t surface_of_term) {
    Nonsmooth term;
    term.kind = kind;
    term.row = dice.below(system.states);
    term.coefficient = dice.uniform(-2.0, 1.0);
    for (Form* form : {&term.e0, &term.e1, &term.e2}) *form = surface(dice, system.states, system.family);
    // The branches of a maximum must part with the state, not with time only.
    if (term.e1.slope == term.e2.slope) term.e2.slope.front() += 1.0;
    term.surface = surface_of_term;
    system.terms.push_back(term);
  };
  for (std::size_t j = 0; j < signs; ++j) {
    constexpr Kind kinds[] = {Kind::sign, Kind::sign_of_max, Kind::sign_of_abs, Kind::sign_of_sign};
    const Kind kind = kinds[dice.below(system.terms.empty() ? 3 : 4)];
    add(kind, system.surfaces++);
    system.inner.emplace_back();
    if (kind != Kind::sign_of_sign) continue;
    // The inner sign is a sign of its own elsewhere, too.
    const Nonsmooth* known = nullptr;
    for (const auto& term : system.terms) {
      if (term.kind == Kind::sign) known = &term;
    }
    if (known == nullptr) {
      system.terms.back().kind = Kind::sign;
      continue;
    }
    system.terms.back().inner = known->surface;
    system.terms.back().e1 = known->e0;
    system.inner.back() = {known->surface};
  }
  constexpr Kind kinks[] = {Kind::abs, Kind::abs_of_abs, Kind::saturation};
  for (std::size_t k = dice.below(3); k > 0; --k) add(kinks[dice.below(3)], 0);
}

/// Masses in a row with springs, dampers, a drive, and dry friction on some of them; belts may move.
void draw_friction(Dice& dice, RandomSystem& system) {
  const std::size_t masses = 1 + dice.below(3);
  system.states = 2 * masses;
  std::vector<Form> rows;
  for (std::size_t i = 0; i < masses; ++i) {
    rows.push_back(constant_form(system.states, 0.0));
    rows.back().slope[masses + i] = 1.0;
  }
  for (std::size_t i = 0; i < masses; ++i) {
    Form row = constant_form(system.states, dice.coefficient(0.5));
    row.slope[i] = -dice.uniform(1.0, 4.0);
    row.slope[masses + i] = -dice.uniform(0.0, 0.5);
    if (i > 0) row.slope[i - 1] = 0.5;
    if (i + 1 < masses) row.slope[i + 1] = 0.5;
    if (dice.chance(0.6)) {
      row.terms.push_back({Form::Term::Kind::sine_of_time, dice.coefficient(2.0), 0, 0, dice.uniform(0.5, 3.0)});
    }
    rows.push_back(row);
  }
  system.corners = {rows};
  for (std::size_t i = 0; i < masses; ++i) {
    for (std::size_t contact = 1 + dice.below(2); contact > 0; --contact) {
      Nonsmooth term;
      term.row = masses + i;
      term.coefficient = -(dice.round_numbers ? 0.5 : dice.uniform(0.1, 1.0));
      term.e0 = constant_form(system.states, contact == 1 && dice.chance(0.6) ? 0.0 : dice.uniform(-0.5, 0.5));
      term.e0.slope[masses + i] = 1.0;
      if (dice.chance(0.15)) term.e0.rate = dice.uniform(-0.1, 0.1);
      term.surface = system.surfaces++;
      system.terms.push_back(term);
    }
  }
}

/// Moves the start onto a surface, along the component it depends on most.
void start_on(RandomSystem& system, const Form& form) {
  const auto largest = std::max_element(form.slope.begin(), form.slope.end(),
                                        [](double a, double b) { return std::abs(a) < std::abs(b); });
  const auto i = static_cast<std::size_t>(largest - form.slope.begin());
  system.start[i] = 0.0;
  system.start[i] = -evaluate(form, 0.0, system.start) / *largest;
}

}  // namespace

std::string name(Family family) {
  switch (family) {
    case Family::affine:
      return "affine";
    case Family::nested:
      return "nested";
    case Family::friction:
      return "friction";
    case Family::smooth:
      return "smooth";
    case Family::constant:
      return "constant";
  }
  return "";
}

RandomSystem draw(Family family, std::uint64_t seed) {
  // Seeds of the fifth family lie beyond those of the others.
  constexpr std::uint64_t beyond = std::uint64_t{1} << 40;
  Dice dice(seed * 4 + (family == Family::constant ? beyond : static_cast<std::uint64_t>(family)));
  dice.round_numbers = dice.chance(0.2);
  RandomSystem system;
  system.family = family;
  system.seed = seed;
  system.states = 2 + dice.below(5);
  if (family == Family::friction) {
    draw_friction(dice, system);
  } else if (family == Family::nested) {
    draw_nested(dice, system);
  } else {
    draw_table(dice, system);
  }
  system.inner.resize(system.surfaces);
  for (std::size_t i = 0; i < system.states; ++i) system.start.push_back(dice.coefficient(2.0));
  if (dice.chance(0.15)) start_on(system, system.psi.empty() ? system.terms.front().e0 : system.psi.front());
  return system;
}

}  // namespace saltus::robustness
