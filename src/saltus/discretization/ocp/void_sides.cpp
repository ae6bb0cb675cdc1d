// Surfaces that are held although nothing depends on their selections.
#include <algorithm>
#include <cmath>

#include "saltus/base/at.hpp"
#include "saltus/base/contains.hpp"
#include "saltus/discretization/ocp/neighbours_internal.hpp"
#include "saltus/discretization/ocp/surface_states_internal.hpp"

namespace saltus::discretization {
namespace {

using Functions = std::function<linalg::Vector(const linalg::Vector&)>;

class VoidSides {
 public:
  VoidSides(const SolvedBranch& branch, const Functions& functions)
      : made_(branch.made),
        modes_(branch.modes),
        w_(branch.w),
        multipliers_(*branch.multipliers),
        functions_(functions),
        states_(made_),
        elements_(made_.element.size()) {}

  void add_to(std::vector<mpcc::BranchMove>& moves) const {
    for (std::size_t surface = 0; surface < states_.count(); ++surface) {
      const std::vector<bool> is_void = find_void(surface);
      for (std::size_t e = 0; e < elements_; ++e) {
        if (!is_void[e]) continue;
        std::size_t end = e;
        while (end < elements_ && is_void[end]) ++end;
        add_run(surface, e, end, moves);
        e = end;
      }
    }
  }

 private:
  /// Elements that are on the surface throughout, and have the same equations on either side of it.
  [[nodiscard]] std::vector<bool> find_void(std::size_t surface) const {
    std::vector<bool> is_void(elements_);
    for (std::size_t e = 0; e < elements_; ++e) is_void[e] = states_.is_held(e, surface, w_);
    if (!contains(is_void, true)) return is_void;
    for (const int state : {-1, 1}) {
      const linalg::Vector errors = errors_of(selected(surface, is_void, state));
      for (std::size_t e = 0; e < elements_; ++e) is_void[e] = is_void[e] && errors[index(e)] <= on_surface;
    }
    return is_void;
  }

  [[nodiscard]] linalg::Vector selected(std::size_t surface, const std::vector<bool>& is_wanted, int state) const {
    linalg::Vector w = w_;
    for (std::size_t e = 0; e < elements_; ++e) {
      if (is_wanted[e]) states_.select(e, surface, state, w);
    }
    // Lifted variables are products of those before them.
    for (int k = 0; k < made_.kernel.layout.lifted.size; ++k) lift(k, w);
    return w;
  }

  [[nodiscard]] const Placed& equations() const {
    return *std::find_if(made_.functions.begin(), made_.functions.end(),
                         [&](const Placed& placed) { return placed.function == &made_.kernel.element; });
  }

  void lift(int k, linalg::Vector& w) const {
    const auto& kernel = made_.kernel;
    const auto& layout = kernel.layout;
    const linalg::Vector c = functions_(w);
    const int differential =
        kernel.states * (layout.stages + layout.end_state.count) + layout.end_time.count * layout.end_time.size;
    const int per_stage = kernel.selections + kernel.simplices + layout.lifted.size;
    for (const auto& one : equations().copies) {
      for (int m = 0; m < layout.stages; ++m) {
        const int row = one.first_row + differential + (m + 1) * per_stage - layout.lifted.size + k;
        w[made_.element[at(one.element)].variable(layout.lifted.at(m, k))] -= c[row];
      }
    }
  }

  /// The largest error of an equation of each element.
  [[nodiscard]] linalg::Vector errors_of(const linalg::Vector& w) const {
    const linalg::Vector c = functions_(w);
    linalg::Vector errors = linalg::Vector::zero(index(elements_));
    for (const auto& one : equations().copies) {
      errors[one.element] = c.segment(one.first_row, equations().function->equations()).max_abs();
    }
    return errors;
  }

  /// One side up to each of its boundaries, the other one behind.
  void add_run(std::size_t surface, std::size_t first, std::size_t end, std::vector<mpcc::BranchMove>& moves) const {
    for (std::size_t cut = end; cut > first; --cut) {
      for (const int state : {-1, 1}) {
        mpcc::BranchMove move{modes_.all(), w_};
        for (std::size_t e = first; e < end; ++e) {
          const int side = e < cut ? state : -state;
          modes_.write(states_.with(modes_.modes(e), surface, side), e, move.sides);
          states_.select(e, surface, side, move.start);
        }
        for (int k = 0; k < made_.kernel.layout.lifted.size; ++k) lift(k, move.start);
        move.price = price_of_freed(modes_.all(), move.sides, multipliers_);
        moves.push_back(std::move(move));
      }
    }
  }

  const OcpStructure& made_;
  const ElementSides& modes_;
  const linalg::Vector w_;
  const mpcc::Multipliers& multipliers_;
  const Functions& functions_;
  SurfaceStates states_;
  std::size_t elements_;
};

}  // namespace

void add_void_sides(const SolvedBranch& branch, const Functions& functions, Moves& moves) {
  VoidSides(branch, functions).add_to(moves);
}

}  // namespace saltus::discretization
