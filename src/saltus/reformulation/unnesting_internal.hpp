// Functions inside others taken apart: a System whose switching functions are free of selections.
#pragma once

#include <string>
#include <vector>

#include "saltus/reformulation/dcs.hpp"
#include "saltus/reformulation/expressions_internal.hpp"

namespace saltus::reformulation {

/// Holds the regions of a group by `indicator`, for one choice of sides of what the indicators contain.
struct IndicatorPart {
  int mode_group = 0;
  std::vector<SXElem> theta;
  std::vector<SXElem> indicator;
};

/// Holds a power with an exponent in (0, 1) of what is zero on a surface; of its value in f there is a symbol.
struct SurfaceRoot {
  SXElem symbol, base;
  double exponent = 0.5;
  int surface = 0;
};

/// Holds a symbol in f that is 1 on both sides of a surface, 0 while it slides.
struct AwayFromSurface {
  int surface = 0;
  SXElem symbol;
};

/// Holds a System in selections of which none is inside another.
struct Unnested {
  std::vector<Surface> surfaces;
  std::vector<SXElem> surface_symbols;  ///< alpha of each
  std::vector<IndicatorPart> indicator_parts;
  std::vector<HeldSymbol> held_symbols;
  std::vector<SXElem> held;
  std::vector<SurfaceRoot> roots;  ///< of take_roots()
  std::vector<AwayFromSurface> away;

  SX f;  ///< multi-affine in the selections with filippov
  SX alpha, outputs, input;
  std::vector<model::UserEvent> events;
};

[[nodiscard]] Expected<Unnested> unnest(const model::System& system);

}  // namespace saltus::reformulation
