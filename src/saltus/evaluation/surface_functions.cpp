#include "saltus/evaluation/surface_functions.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <set>
#include <utility>

#include "saltus/evaluation/model_function_internal.hpp"

namespace saltus::evaluation {
namespace {

using casadi::DM;
using casadi::SX;

/// More states than this do not fit into a plane.
constexpr std::size_t most_states_of_curves = 2;

std::vector<int> dependencies(const SX& expression, const SX& variables) {
  std::vector<int> found;
  if (variables.numel() == 0) return found;
  for (const casadi_int column : SX::jacobian_sparsity(expression, variables).get_col()) {
    found.push_back(static_cast<int>(column));
  }
  return found;
}

/// A switching function with what it depends on, the inner ones' dependencies included.
struct Composed {
  SX psi;  ///< over t and x only
  std::set<int> states;
  bool on_time = false;
  bool nested = false;
};

class Composer {
 public:
  explicit Composer(const model::System& system) : system_(system), parameters_(DM(system.parameter_values)) {
    // Inner functions have smaller indices, so one pass in order composes all.
    for (const auto& entry : system.switching) composed_.push_back(compose(entry.psi));
  }

  [[nodiscard]] Composed compose(const SX& expression) const {
    SX psi = SX::densify(expression);
    if (system_.u.numel() > 0) psi = SX::substitute(psi, system_.u, SX::densify(system_.input));
    if (system_.p.numel() > 0) psi = SX::substitute(psi, system_.p, parameters_);
    Composed result;
    for (const int i : dependencies(psi, system_.x)) result.states.insert(i);
    result.on_time = !dependencies(psi, system_.t).empty();
    const auto inner = dependencies(psi, system_.alpha);
    SX selections = SX::zeros(system_.alpha.numel(), 1);
    for (const int j : inner) {
      const auto& other = composed_[static_cast<std::size_t>(j)];
      selections(j) = SX::if_else(other.psi > 0, 1, 0);
      result.states.insert(other.states.begin(), other.states.end());
      result.on_time = result.on_time || other.on_time;
    }
    result.nested = !inner.empty();
    result.psi = result.nested ? SX::substitute(psi, system_.alpha, selections) : psi;
    return result;
  }

  [[nodiscard]] const Composed& function(int j) const { return composed_[static_cast<std::size_t>(j)]; }

 private:
  const model::System& system_;
  SX parameters_;
  std::vector<Composed> composed_;
};

std::optional<AffineForm> affine_part(const model::System& system, const Composed& composed) {
  if (composed.nested) return std::nullopt;
  const SX arguments = SX::vertcat({system.x, system.t});
  const auto nonlinear = SX::which_depends(composed.psi, arguments, 2, false);
  if (std::any_of(nonlinear.begin(), nonlinear.end(), [](bool value) { return value; })) return std::nullopt;
  ModelFunction function("affine", {arguments}, {SX::jacobian(composed.psi, arguments), composed.psi});
  const std::vector<double> origin(static_cast<std::size_t>(arguments.numel()), 0.0);
  std::vector<double> slopes(origin.size());
  AffineForm affine;
  function(std::array{origin.data()}, std::array{slopes.data(), &affine.constant});
  for (const int i : composed.states) affine.gradient.push_back(slopes[static_cast<std::size_t>(i)]);
  affine.rate = slopes.back();
  const bool finite = std::all_of(slopes.begin(), slopes.end(), [](double value) { return std::isfinite(value); });
  if (!finite || !std::isfinite(affine.constant)) return std::nullopt;
  return affine;
}

std::function<double(double, const double*)> value_of(const model::System& system, const Composed& composed) {
  std::vector<SX> arguments;
  for (const int i : composed.states) arguments.push_back(system.x(i));
  // std::function wants to be copied: the copies share one work space.
  auto function = std::make_shared<ModelFunction>("surface", std::vector<SX>{system.t, SX::vertcat(arguments)},
                                                  std::vector<SX>{composed.psi});
  return [function](double t, const double* coordinates) {
    double value = 0.0;
    const double* time = &t;
    (*function)(std::array{time, coordinates}, std::array{&value});
    return value;
  };
}

SurfaceFunction surface_function(const model::System& system, const Composed& composed) {
  SurfaceFunction surface;
  surface.states.assign(composed.states.begin(), composed.states.end());
  surface.depends_on_time = composed.on_time;
  surface.affine = affine_part(system, composed);
  if (!surface.affine && surface.states.size() <= most_states_of_curves) {
    surface.value = value_of(system, composed);
  }
  return surface;
}

}  // namespace

std::vector<SurfaceFunction> surface_functions(const model::System& system) {
  const Composer composer(system);
  std::vector<SurfaceFunction> surfaces;
  const auto add = [&](const Composed& composed, const std::string& name, SurfaceOwner owner) {
    if (composed.states.empty()) return;
    surfaces.push_back(surface_function(system, composed));
    surfaces.back().name = name;
    surfaces.back().owner = owner;
  };
  for (const auto& column : system.columns) {
    add(composer.function(column.function), column.name, SurfaceOwner::switching_function);
  }
  for (const auto& jump : system.jumps) {
    for (casadi_int i = 0; i < jump.guards.numel(); ++i) {
      add(composer.compose(jump.guards(i)), jump.name, SurfaceOwner::jump);
    }
  }
  return surfaces;
}

}  // namespace saltus::evaluation
