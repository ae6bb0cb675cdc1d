#include "saltus/switching/point/faces_by_pivots.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "saltus/base/at.hpp"
#include "saltus/base/contains.hpp"
#include "saltus/switching/point/pivoting.hpp"

namespace saltus::switching {
namespace {

using linalg::Index;
using linalg::Matrix;
using linalg::Vector;

/// Writes the blocks as 0 <= u, complementary to 0 <= R y + S u + s, with z = G u + g, each block in a unit of its own.
///
/// Friction at rest along a tangent has two unknowns. One is z_t + friction z_n, complementary to the part of y_t above
/// 0; the other is the part of y_t below 0, complementary to friction z_n - z_t. A box has z - lower and the part of y
/// below 0.
class StandardForm {
 public:
  StandardForm(const PointProblem& problem, const std::vector<std::vector<Face>>& options)
      : problem_(problem), options_(options) {
    const Index r = problem.constant.size(), most = 4 * r;
    of_u_.set_zero(r, most);
    given_.set_zero(r);
    of_y_.set_zero(most, r);
    own_.set_zero(most, most);
    right_.set_zero(most);
    for (std::size_t b = 0; b < problem.blocks.size(); ++b) {
      places_.emplace_back();
      if (problem.blocks[b].kind != Block::Kind::absent) add(problem.blocks[b], options[b], places_.back());
    }
  }

  [[nodiscard]] std::optional<PointVertex> vertex() const {
    const Matrix of_y = of_y_.top_rows(unknowns_), of_u = of_u_.left_cols(unknowns_);
    const Matrix effects = of_y * (problem_.effects * of_u) + own_.block(0, 0, unknowns_, unknowns_);
    const Vector constant = of_y * (problem_.constant + problem_.effects * given_) + right_.head(unknowns_);
    std::vector<bool> basic;
    const auto u = complementary_pivots(effects, constant, &basic);
    if (!u) return std::nullopt;
    const std::size_t blocks = problem_.blocks.size();
    PointVertex found{std::vector<Face>(blocks, Face::open), std::vector<bool>(blocks, false), of_u * *u + given_};
    for (std::size_t b = 0; b < blocks; ++b) {
      const Block& block = problem_.blocks[b];
      if (block.kind == Block::Kind::absent) continue;
      const Face face = face_of(block, options_[b], places_[b], basic);
      found.faces[b] = contains(options_[b], face) ? face : options_[b].front();
      found.at_upper[b] = block.is_bounded && places_[b].normal >= 0 && basic[at(places_[b].normal + 1)];
    }
    return found;
  }

 private:
  struct Places {
    Index normal = -1;                   ///< of the unknown of z, or of its normal part; -1: it is known
    std::array<Index, 2> above{-1, -1};  ///< by tangent, of z_t + friction z_n; -1: z_t follows
  };

  [[nodiscard]] double unit_of(const Block& block) const {
    double largest = problem_.effects(block.row, block.row);
    for (const int row : block.tangents) largest = std::max(largest, row < 0 ? 0.0 : problem_.effects(row, row));
    return largest > 0.0 ? 1.0 / std::sqrt(largest) : 1.0;
  }

  Index take(int row, double factor) {
    of_u_(row, unknowns_) = of_y_(unknowns_, row) = factor;
    return unknowns_++;
  }

  void add(const Block& block, const std::vector<Face>& options, Places& places) {
    const double unit = unit_of(block);
    switch (block.kind) {
      case Block::Kind::absent:
        return;
      case Block::Kind::free:
        take(block.row, unit);
        take(block.row, -unit);
        return;
      case Block::Kind::box:
        bound(places.normal = take(block.row, unit), (block.upper - block.lower) / unit);
        given_(block.row) = block.lower;
        return;
      case Block::Kind::half_line:
      case Block::Kind::friction:
        break;
    }
    if (options == std::vector{Face::open}) return;
    if (block.is_given) {
      given_(block.row) = 1.0;
    } else {
      places.normal = take(block.row, unit);
      if (block.is_bounded) bound(places.normal, block.upper / unit);
    }
    if (block.kind == Block::Kind::friction) add_friction(block, options, unit, places);
  }

  void add_friction(const Block& block, const std::vector<Face>& options, double unit, Places& places) {
    for (std::size_t k = 0; k < 2 && block.tangents[k] >= 0; ++k) {
      const double slip = slip_part(block, options, k);
      const int row = block.tangents[k];
      const bool turns = std::isnan(slip);
      const double share = -block.friction * (turns ? 1.0 : slip);
      (block.is_given ? given_(row) : of_u_(row, places.normal)) = block.is_given ? share : share * unit;
      if (!turns) continue;
      const Index above = places.above[k] = take(row, unit);
      const double edge = 2.0 * block.friction;
      bound(above, block.is_given ? edge / unit : 0.0);
      if (!block.is_given) own_(above + 1, places.normal) = edge;
    }
  }

  /// Gives an unknown an upper bound.
  void bound(Index unknown, double largest) {
    const Index below = unknowns_++;
    own_(unknown, below) = 1.0;
    own_(below, unknown) = -1.0;
    right_[below] = largest;
  }

  /// The part of a direction of slip that is known; a NaN where it is not.
  static double slip_part(const Block& block, const std::vector<Face>& options, std::size_t tangent) {
    const double speed = std::hypot(block.velocity[0], block.velocity[1]);
    if (speed > 0.0) return block.velocity[tangent] / speed;
    const bool sticks = contains(options, Face::stick), up = contains(options, Face::slip_up),
               down = contains(options, Face::slip_down);
    if (sticks || up == down) return std::nan("");
    return up ? 1.0 : -1.0;
  }

  static Face face_of(const Block& block, const std::vector<Face>& options, const Places& places,
                      const std::vector<bool>& basic) {
    const auto is_basic = [&](Index unknown) { return unknown >= 0 && basic[at(unknown)]; };
    if (block.kind == Block::Kind::free) return Face::inside;
    if (block.kind == Block::Kind::half_line) return is_basic(places.normal) ? Face::closed : Face::open;
    if (block.kind == Block::Kind::box) {
      return !is_basic(places.normal) ? Face::lower : is_basic(places.normal + 1) ? Face::upper : Face::inside;
    }
    if (!block.is_given && !is_basic(places.normal)) return Face::open;
    if (places.above[0] < 0) return options.front();
    const auto sticks = [&](Index above) { return above < 0 || (is_basic(above) && !is_basic(above + 1)); };
    if (sticks(places.above[0]) && sticks(places.above[1])) return Face::stick;
    if (block.in_plane()) return Face::slip;
    return is_basic(places.above[0]) ? Face::slip_down : Face::slip_up;
  }

  const PointProblem& problem_;
  const std::vector<std::vector<Face>>& options_;
  Matrix of_u_, of_y_, own_;  ///< G, R, S
  Vector given_, right_;      ///< g, s
  Index unknowns_ = 0;
  std::vector<Places> places_;
};

}  // namespace

std::optional<PointVertex> vertex_by_pivots(const PointProblem& problem,
                                            const std::vector<std::vector<Face>>& options) {
  return StandardForm(problem, options).vertex();
}

}  // namespace saltus::switching
