// On which side of each surface an element is, in either form.
#pragma once

#include <vector>

#include "saltus/discretization/ocp/element_sides_internal.hpp"

namespace saltus::discretization {

/// What is left of a multiplier, or of an equation, that is 0 in a certified point.
inline constexpr double on_surface = 1e-7;

/// Reads and writes the sides of surfaces in the modes of elements, and lists the modes that meet at a point. Regions
/// by indicators of the user have no surfaces.
class SurfaceStates {
 public:
  using Modes = ElementSides::Sides;
  explicit SurfaceStates(const OcpStructure& made);

  [[nodiscard]] std::size_t count() const { return surfaces_.size(); }
  /// Returns -1 or 1, or 0 where the surface is slid on.
  [[nodiscard]] int of(const Modes& modes, std::size_t surface) const;
  [[nodiscard]] Modes with(Modes modes, std::size_t surface, int state) const;
  /// Returns modes with which a motion may go on from a point, these first: they differ from them at one surface that
  /// is reached (or in the regions of one part of which several are), then at two, and so on. No more than some
  /// hundred: where they are more, those that differ at fewer.
  /// @param lambda  all multipliers there
  [[nodiscard]] std::vector<Modes> candidates(const std::vector<double>& lambda, const Modes& from) const;
  /// Returns modes that slide on all surfaces that are reached.
  [[nodiscard]] static Modes on_all(const std::vector<double>& lambda);
  /// Returns whether a surface is reached that these modes are on one side of, or a region that they leave out.
  [[nodiscard]] bool is_touched(const std::vector<double>& lambda, const Modes& modes) const;
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
    int follower = -1;   ///< surface that is on the same side (follows_as 1) or the other one (-1)
    int follows_as = 1;
    bool follows = false;
  };
  void find_followers();
  [[nodiscard]] bool drifts_from(const std::vector<double>& lambda, const Modes& modes) const;
  [[nodiscard]] static bool is_step(const Surface& surface) { return surface.part->form == reformulation::Form::step; }
  /// Returns the region on the other side of the surface.
  [[nodiscard]] static int mirrored(const Surface& surface, int region);
  /// Regions by indicators: pairs of a part.
  struct Regions {
    int first = 0, count = 0;
  };
  [[nodiscard]] std::vector<Modes> others(std::size_t surface, const std::vector<double>& lambda,
                                          const Modes& from) const;
  [[nodiscard]] static std::vector<Modes> others(const Regions& regions, const std::vector<double>& lambda,
                                                 const Modes& from);

  const OcpStructure& made_;
  std::vector<Surface> surfaces_;
  std::vector<Regions> regions_;
};

}  // namespace saltus::discretization
