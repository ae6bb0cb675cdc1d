// Switching functions, guards of jumps and borders of regions as functions of the states they depend on: for drawing
// where they are zero.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace saltus::model {
struct System;
}

namespace saltus::evaluation {

enum class SurfaceOwner { switching_function, jump, region_border };

/// Is gradient . x[states] + rate t + constant.
struct AffineForm {
  std::vector<double> gradient;
  double rate = 0.0;
  double constant = 0.0;
};

/// Evaluates psi(t, x[states]) with the parameters and inputs of the system put in. In nested functions the alphas of
/// the inner ones are put in, too, as their signs say.
struct SurfaceFunction {
  std::string name;
  SurfaceOwner owner = SurfaceOwner::switching_function;
  std::vector<int> states;  ///< indices of the states it depends on, ascending
  bool depends_on_time = false;
  std::optional<AffineForm> affine;
  /// psi at a time and the coordinates of `states` (not finite where the model is undefined). Empty for affine
  /// functions and those of more than two states. Not thread safe.
  std::function<double(double t, const double* coordinates)> value;
  /// The part of the surface where all of these are >= 0, over the same states. Of the border of two regions by
  /// `indicator`: how much larger the indicators of the others are.
  std::vector<AffineForm> within;                                                         ///< with `affine`
  std::vector<std::function<double(double t, const double* coordinates)>> within_values;  ///< with `value`
};

/// Returns one function for every column of the result, then one for every guard of [[jumps]], of [[hysteresis]] with
/// "on" or "off" behind the name. Then one for every two regions of a group by `indicator`, which may never be the two
/// smallest ones. Those that depend on no state are left out. Cost: compiles one function for each that is not affine.
[[nodiscard]] std::vector<SurfaceFunction> surface_functions(const model::System& system);

}  // namespace saltus::evaluation
