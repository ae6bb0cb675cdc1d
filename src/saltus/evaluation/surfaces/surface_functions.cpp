#include "saltus/evaluation/surfaces/surface_functions.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <set>
#include <utility>

#include <casadi/core/sx_elem.hpp>

#include "saltus/base/at.hpp"
#include "saltus/evaluation/surfaces/composer_internal.hpp"
#include "saltus/evaluation/surfaces/guard_words.hpp"
#include "saltus/model/graph/model_function.hpp"
#include "saltus/model/system.hpp"

namespace saltus::evaluation {

using model::ModelFunction;
namespace {

using casadi::SX;
using casadi::SXElem;

/// More states than this do not fit into a plane.
constexpr std::size_t most_states_of_curves = 2;

/// Squares of distances to two points differ by an affine function, although both are curved.
bool curvature_cancels(const Composed& composed, const SX& arguments) {
  constexpr std::size_t most_states = 32;  // the matrix grows with their square
  if (composed.states.size() > most_states) return false;
  const SX second = SX::jacobian(SX::jacobian(composed.psi, arguments), arguments);
  return SX::sparsify(second).nnz() == 0;
}

/// @param states  of which the form has coefficients
std::optional<AffineForm> affine_part(const model::System& system, const Composed& composed,
                                      const std::set<int>& states) {
  if (composed.nested || !composed.cells.empty()) return std::nullopt;
  std::vector<SXElem> own;
  for (const int i : composed.states) own.push_back(system.x(i).scalar());
  own.push_back(system.t.scalar());
  const SX arguments(own);
  const auto nonlinear = SX::which_depends(composed.psi, arguments, 2, false);
  const bool looks_curved = std::any_of(nonlinear.begin(), nonlinear.end(), [](bool value) { return value; });
  if (looks_curved && !curvature_cancels(composed, arguments)) return std::nullopt;
  ModelFunction function("affine", {arguments}, {SX::jacobian(composed.psi, arguments), composed.psi});
  const std::vector<double> origin(own.size(), 0.0);
  std::vector<double> slopes(own.size());
  AffineForm affine;
  function(std::array{origin.data()}, std::array{slopes.data(), &affine.constant});
  const bool finite = std::all_of(slopes.begin(), slopes.end(), [](double value) { return std::isfinite(value); });
  if (!finite || !std::isfinite(affine.constant)) return std::nullopt;
  affine.rate = slopes.back();
  auto slope = slopes.begin();
  for (const int i : states) affine.gradient.push_back(composed.states.contains(i) ? *slope++ : 0.0);
  return affine;
}

/// psi, and what it needs of cells: looked up at every point, arguments of arguments first.
struct PointFunction {
  struct CellAt {
    ModelFunction argument;
    std::shared_ptr<const model::CellTable> table;
    std::size_t first = 0;  ///< of its constants
  };
  ModelFunction psi;
  std::vector<CellAt> cells;
  std::vector<double> constants;

  double operator()(double t, const double* coordinates) {
    const std::array at{static_cast<const double*>(&t), coordinates, static_cast<const double*>(constants.data())};
    double value = 0.0;
    for (auto& cell : cells) {
      cell.argument(at, std::array{&value});
      const long index = cell.table->cell(value);
      for (int column = 0; column < cell.table->columns; ++column) {
        constants[cell.first + static_cast<std::size_t>(column)] = cell.table->constant(index, column);
      }
    }
    psi(at, std::array{&value});
    return value;
  }
};

std::function<double(double, const double*)> value_of(const model::System& system, const Composer& composer,
                                                      const Composed& composed, const std::set<int>& drawn) {
  std::vector<SX> states;
  for (const int i : drawn) states.push_back(system.x(i));
  const std::vector<SX> arguments{system.t, SX::vertcat(states), composer.symbols()};
  // std::function wants to be copied: the copies share one work space.
  auto function = std::make_shared<PointFunction>();
  function->psi = ModelFunction("surface", arguments, {composed.psi});
  std::vector<std::size_t> first{0};
  for (const auto& cell : system.cells) first.push_back(first.back() + static_cast<std::size_t>(cell.table->columns));
  for (const int c : composer.order()) {
    if (!composed.cells.contains(c)) continue;
    function->cells.push_back({ModelFunction("argument", arguments, {composer.arguments()[at(c)].psi}),
                               system.cells[at(c)].table, first[at(c)]});
  }
  function->constants.resize(first.back());
  return [function](double t, const double* coordinates) { return (*function)(t, coordinates); };
}

SurfaceFunction surface_function(const model::System& system, const Composer& composer, const Composed& composed) {
  SurfaceFunction surface;
  surface.states.assign(composed.states.begin(), composed.states.end());
  surface.depends_on_time = composed.on_time;
  surface.affine = affine_part(system, composed, composed.states);
  if (!surface.affine && composed.resolved && surface.states.size() <= most_states_of_curves) {
    surface.value = value_of(system, composer, composed, composed.states);
  }
  return surface;
}

/// g_r - g_i of a group by `indicator`, whose symbols say which region is r.
Composed difference(const model::System& system, const Composer& composer, const model::ModeGroup& group, int r,
                    int i) {
  SX reference = SX::zeros(group.regions, 1);
  reference(r) = 1;
  const SX& psi = system.switching[at(group.first + i)].psi;
  return composer.compose(SX::substitute(psi, group.reference, reference));
}

/// Where the regions i < k of a group meet: g_k = g_i, both at most as large as any other.
SurfaceFunction region_border(const model::System& system, const Composer& composer, const model::ModeGroup& group,
                              int i, int k) {
  std::vector<Composed> parts{difference(system, composer, group, k, i)};
  for (int other = 0; other < group.regions; ++other) {
    if (other != i && other != k) parts.push_back(difference(system, composer, group, other, i));
  }
  SurfaceFunction surface;
  surface.owner = SurfaceOwner::region_border;
  const auto label = [&](int region) {
    const auto& name = group.mode_names[at(region)];
    return group.name.empty() ? name : group.name + "." + name;
  };
  surface.name = label(i) + " | " + label(k);
  // What cuts a border off may depend on states of which the border itself does not.
  std::set<int> states;
  bool resolved = true, affine = true;
  for (const auto& part : parts) {
    states.insert(part.states.begin(), part.states.end());
    surface.depends_on_time = surface.depends_on_time || part.on_time;
    resolved = resolved && part.resolved;
  }
  surface.states.assign(states.begin(), states.end());
  for (std::size_t p = 0; p < parts.size() && affine; ++p) {
    auto form = affine_part(system, parts[p], states);
    affine = form.has_value();
    if (affine && p == 0) surface.affine = std::move(form);
    if (affine && p > 0) surface.within.push_back(std::move(*form));
  }
  if (affine) return surface;
  surface.affine.reset();
  surface.within.clear();
  if (!resolved || states.size() > most_states_of_curves) return surface;
  surface.value = value_of(system, composer, parts.front(), states);
  for (std::size_t p = 1; p < parts.size(); ++p) {
    surface.within_values.push_back(value_of(system, composer, parts[p], states));
  }
  return surface;
}

}  // namespace

std::vector<SurfaceFunction> surface_functions(const model::System& system) {
  const Composer composer(system);
  std::vector<SurfaceFunction> surfaces;
  const auto add = [&](const Composed& composed, const std::string& name, SurfaceOwner owner) {
    if (composed.states.empty()) return;
    surfaces.push_back(surface_function(system, composer, composed));
    surfaces.back().name = name;
    surfaces.back().owner = owner;
  };
  for (const auto& column : system.columns) {
    add(composer.function(column.function), column.name, SurfaceOwner::switching_function);
  }
  const auto& contacts = system.contacts.contacts;
  for (std::size_t k = 0; k < system.jumps.size(); ++k) {
    const auto& jump = system.jumps[k];
    const auto contact = std::find_if(contacts.begin(), contacts.end(),
                                      [k](const auto& one) { return one.jump == static_cast<int>(k); });
    if (contact != contacts.end()) {  // its guards depend on its mode
      add(composer.compose(system.contacts.gap(contact - contacts.begin())), jump.name, SurfaceOwner::jump);
      continue;
    }
    const auto words = guard_words(system, jump);
    for (casadi_int i = 0; i < jump.guards.numel(); ++i) {
      const auto& word = words[at(i)];
      add(composer.compose(jump.guards(i)), word.empty() ? jump.name : jump.name + " " + word, SurfaceOwner::jump);
    }
  }
  for (const auto& group : system.mode_groups) {
    for (int k = 0; group.first >= 0 && k < group.regions; ++k) {
      for (int i = 0; i < k; ++i) {
        auto border = region_border(system, composer, group, i, k);
        if (!border.states.empty()) surfaces.push_back(std::move(border));
      }
    }
  }
  return surfaces;
}

}  // namespace saltus::evaluation
