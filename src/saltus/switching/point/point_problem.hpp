// A problem of complementarity at a point: which unilateral constraints stay active, and with which forces.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "saltus/linalg/matrix.hpp"

namespace saltus::switching {

/// Says where the unknowns of a block are in their set.
enum class Face : std::int8_t {
  open,       ///< z = 0, y >= 0
  closed,     ///< y = 0, z >= 0
  stick,      ///< y = 0 in all rows, |z_t| <= friction z_n
  slip_up,    ///< y_n = 0, z_t = -friction z_n, y_t >= 0
  slip_down,  ///< y_n = 0, z_t = friction z_n, y_t <= 0
  slip,       ///< of two tangents: y_n = 0, z_t = -friction z_n d, along the slip, or along y_t where there is none
  lower,      ///< of a box: y >= 0
  inside,     ///< of a box, or of what is free: y = 0
  upper       ///< of a box: y <= 0
};
[[nodiscard]] constexpr bool slips(Face face) { return face >= Face::slip_up && face <= Face::slip; }

/// Holds unknowns of z and the set in which they are, by rows of z and y = w + W z.
struct Block {
  enum class Kind : std::int8_t {
    absent,     ///< z = 0, whatever y
    half_line,  ///< 0 <= z, complementary to 0 <= y
    box,        ///< lower <= z <= upper
    free,       ///< y = 0
    friction    ///< a half line for the normal part, and |z_t| <= friction z_n against the slip, or else against y_t
  };
  Kind kind = Kind::absent;
  int row = 0;                          ///< of the normal part with friction
  std::array<int, 2> tangents{-1, -1};  ///< rows, of friction; -1: none
  double friction = 0.0;
  bool is_given = false;             ///< of friction: the normal part is 1, whatever its y
  std::array<double, 2> velocity{};  ///< of slip; 0: at rest
  double lower = 0.0, upper = 1.0;   ///< of a box, and of a normal part that is bounded
  bool is_bounded = false;           ///< of friction and half lines: z_n <= upper; only pivots know of it

  [[nodiscard]] bool in_plane() const { return tangents[1] >= 0; }
  [[nodiscard]] bool is_at_rest() const { return velocity[0] == 0.0 && velocity[1] == 0.0; }
  /// Returns the part of a vector along both tangents; 0 along those that it has not.
  [[nodiscard]] linalg::Vector along(const linalg::Vector& vector) const {
    const auto part = [&](int tangent) { return tangent < 0 ? 0.0 : vector(tangent); };
    return {part(tangents[0]), part(tangents[1])};
  }
};

/// Holds y = w + W z for blocks that together have all rows.
struct PointProblem {
  std::vector<Block> blocks;
  const linalg::Matrix& effects;   ///< W
  const linalg::Vector& constant;  ///< w
  double terms = 0.0;              ///< the largest sum of the sizes of the terms of w
};

/// Holds a solution, by its faces.
struct PointSolution {
  std::vector<Face> faces;                 ///< by block
  std::vector<linalg::Vector> directions;  ///< by block, of slip: unit vectors over its tangents; 0 without
  /// Closed blocks that others keep closed: of z that y leaves open those are taken that need the fewest blocks.
  std::vector<int> idle;
  bool is_open = false;      ///< other z would do, those of idle blocks aside
  bool is_stressed = false;  ///< where open: closed blocks press that would bear nothing in the least z that holds
  linalg::Vector z, y;
  /// What is left until the first of the faces ends, relative to its terms. Negative: one does not hold.
  double margin = 0.0;
};

/// Of margins: rounding of solves, and of the place where a face was found to end.
inline constexpr double face_holds = -1e-8;

}  // namespace saltus::switching
