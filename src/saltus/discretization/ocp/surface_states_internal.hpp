// On which side of each surface an element is, in either form.
#pragma once

#include <functional>
#include <set>
#include <vector>

#include "saltus/discretization/ocp/element_sides_internal.hpp"

namespace saltus::discretization {

/// What is left of a multiplier, or of an equation, that is 0 in a certified point.
inline constexpr double on_surface = 1e-7;

/// Reads and writes the sides of surfaces in the modes of elements. Regions by indicators of the user have no surfaces.
class SurfaceStates {
 public:
  using Modes = ElementSides::Sides;
  explicit SurfaceStates(const OcpStructure& made);

  [[nodiscard]] std::size_t count() const { return surfaces_.size(); }
  /// Returns -1 or 1, or 0 where the surface is slid on.
  [[nodiscard]] int of(const Modes& modes, std::size_t surface) const;
  [[nodiscard]] Modes with(Modes modes, std::size_t surface, int state) const;
  /// Gives the selections of an element their values on one side of a surface.
  void select(std::size_t element, std::size_t surface, int state, mpcc::VectorView w) const;
  /// Returns whether both sides of the surface are the same point.
  /// @param lambda  all multipliers there
  [[nodiscard]] bool is_on(std::size_t surface, const std::vector<double>& lambda) const;
  /// Returns whether they are in the whole element.
  [[nodiscard]] bool is_held(std::size_t element, std::size_t surface, mpcc::ConstVectorView w) const;

 private:
  struct Surface {
    const reformulation::DcsPart* part = nullptr;
    int column = 0;
    int first_pair = 0;  ///< step: of the selection; else of the part
  };
  [[nodiscard]] static bool is_step(const Surface& surface) { return surface.part->form == reformulation::Form::step; }
  /// Returns the region on the other side of the surface.
  [[nodiscard]] static int mirrored(const Surface& surface, int region);

  const OcpStructure& made_;
  std::vector<Surface> surfaces_;
};

/// Adds moves of surfaces that elements are held on although nothing depends on their selections there: either side of
/// them is the same point.
/// @param functions  rows of the problem at a point
void add_void_sides(const OcpStructure& made, const ElementSides& modes, mpcc::ConstVectorView w,
                    const std::function<linalg::Vector(const linalg::Vector&)>& functions,
                    std::vector<mpcc::BranchMove>& moves);

/// Adds moves of modes in which the motion can go on from where an element ends: an element of them is inserted, or
/// several up to the end of an impact, or what follows has them. Of surfaces crossed at once an element between has the
/// sides one by one.
/// @param crowded  intervals that have no element left for such a move are added
void add_touched_sides(const OcpStructure& made, const ElementSides& modes, mpcc::ConstVectorView w,
                       std::set<int>& crowded, std::vector<mpcc::BranchMove>& moves);

/// Adds those of them that begin where an element does.
void add_touched_sides_at(const OcpStructure& made, const ElementSides& modes, mpcc::ConstVectorView w,
                          std::size_t element, std::set<int>& crowded, std::vector<mpcc::BranchMove>& moves);

/// Adds moves to impacts where bodies only graze: behind one of velocity 0 nothing differs, so that they begin at a
/// point with other controls, where it has some.
void add_grazed_sides(const OcpStructure& made, const ElementSides& modes, mpcc::ConstVectorView w,
                      std::set<int>& crowded, std::vector<mpcc::BranchMove>& moves);

/// Adds moves of regions by indicators that a state comes to at the end of the horizon, or is held at until then: it
/// goes on through them, to the line between them and another one.
void add_reached_regions(const OcpStructure& made, const ElementSides& modes, mpcc::ConstVectorView w,
                         std::vector<mpcc::BranchMove>& moves);

}  // namespace saltus::discretization
