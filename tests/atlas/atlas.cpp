#include "atlas.hpp"

#include <algorithm>
#include <optional>

#include "../unit/switching/hidden_cases.hpp"
#include "../unit/switching/hidden_simulation.hpp"
#include "saltus/switching/hidden_dynamics.hpp"
#include "saltus/switching/intersection_roots.hpp"
#include "saltus/switching/spiral.hpp"

namespace saltus::switching {
namespace {

using Mode = std::array<int, 2>;

/// The answer of a tree: a mode, and another one if the leaf leaves a choice.
struct TreeAnswer {
  std::string leaf;
  bool decided = true;
  bool spirals_out = false;
  std::vector<Mode> modes;  ///< the chosen one first
};

TreeAnswer answer_of(const PlaneDecision& decision) {
  TreeAnswer answer{std::string(name(decision.leaf)), decision.undecided.empty(), decision.spirals_out, {}};
  answer.modes.push_back(decision.chosen.mode);
  return answer;
}

TreeAnswer ask_tree(Tree tree, const AtlasInstance& one) {
  const PlaneTable table = plane_table(one.f);
  switch (tree) {
    case Tree::entering: {
      auto answer = answer_of(decide_entering(table, one.incoming));
      const auto passive = decide_entering(table, one.incoming, SelectionPolicy::passive_dominant);
      if (passive.chosen.mode != answer.modes.front()) answer.modes.push_back(passive.chosen.mode);
      return answer;
    }
    case Tree::edge:
      return answer_of(decide_exit_edge(table, one.edge));
    case Tree::fold:
      return answer_of(decide_exit_fold(table));
    case Tree::unstable: {
      auto answer = answer_of(decide_exit_unstable(table));
      // Two basins for every scaling: the other one, in the frame of the figure.
      const Mode chosen = one.made(answer.modes.front());
      if (answer.leaf == "C9-4") answer.modes.push_back(one.mode({-chosen[0], -chosen[1]}));
      if (answer.leaf == "C10-4") answer.modes.push_back(one.mode({-1, -1}));
      return answer;
    }
    case Tree::spiral:
      break;
  }
  const auto lap = spiral_lap(table, 0);
  const bool in = lap->lap_ratio < 1.0;
  return {in ? "spiral in" : "spiral out", true, !in, {{0, 0}}};
}

/// G at alpha, and whether a root there is stable for kappa; the sum alone says it for a double root.
struct Derivatives {
  std::array<std::array<double, 2>, 2> g{};

  explicit Derivatives(const AtlasInstance& one) : Derivatives(one, one.alpha) {}
  Derivatives(const AtlasInstance& one, const std::array<double, 2>& alpha) {
    const PlaneField field{one.f};
    for (std::size_t p = 0; p < 2; ++p) {
      auto at = alpha;
      std::array<double, 2> low{};
      std::array<double, 2> high{};
      at[p] = 0.0;
      field(at.data(), low.data());
      at[p] = 1.0;
      field(at.data(), high.data());
      for (std::size_t j = 0; j < 2; ++j) g[j][p] = high[j] - low[j];
    }
  }
  [[nodiscard]] double trace(const Scaling& kappa) const { return kappa[0] * g[0][0] + kappa[1] * g[1][1]; }
};

HiddenDecision ask_resolver(Tree tree, const AtlasInstance& one, const Scaling& kappa, double eta) {
  const PlaneField field{one.f};
  const HiddenOptions options = plain_scaling(one.f, kappa);
  if (tree == Tree::entering) {
    return decide_by_hidden_dynamics(2, field, entering_situation(one.f, one.incoming), options);
  }
  return decide_leaving(2, field, PlaneField{one.rates},
                        sliding_situation({2.0 * one.alpha[0] - 1.0, 2.0 * one.alpha[1] - 1.0}), eta, options);
}

std::string text(const Mode& mode) { return "R(" + std::to_string(mode[0]) + "," + std::to_string(mode[1]) + ")"; }

void count(const TreeAnswer& answer, const HiddenDecision& decision, const AtlasInstance& one, AtlasCell& cell) {
  ++cell.instances;
  if (decision.limit == HiddenLimit::undecided) {
    ++cell.undecided;
  } else if (answer.spirals_out || decision.limit == HiddenLimit::spirals_out) {
    if (answer.spirals_out && decision.limit == HiddenLimit::spirals_out) {
      ++cell.agree;
    } else {
      ++cell.differ[decision.limit == HiddenLimit::spirals_out ? "spiral out"
                                                               : text(one.made({decision.mode[0], decision.mode[1]}))];
    }
  } else {
    const Mode mode{decision.mode[0], decision.mode[1]};
    const auto found = std::find(answer.modes.begin(), answer.modes.end(), mode);
    if (found == answer.modes.begin()) {
      ++cell.agree;
      cell.cycles += decision.limit == HiddenLimit::oscillating ? 1 : 0;
    } else if (found != answer.modes.end()) {
      ++cell.other;
    } else {
      ++cell.differ[text(one.made(mode))];
    }
  }
}

/// The regularised system from the same start; a limit cycle is sliding.
void simulate(Tree tree, const AtlasInstance& one, const Scaling& kappa, double eta, const HiddenDecision& decision,
              AtlasCell& cell) {
  if (decision.limit > HiddenLimit::oscillating) return;
  Velocities f = one.f;
  auto start = one.alpha;
  if (tree == Tree::entering) {
    for (std::size_t j = 0; j < 2; ++j) {
      if (one.incoming[j] == 0) start[j] = entering_situation(one.f, one.incoming).alpha[j];
      if (one.incoming[j] != 0) start[j] = one.incoming[j] > 0 ? 1.0 : 0.0;
    }
  }
  for (std::size_t j = 0; j < 2; ++j) {
    for (std::size_t k = 0; k < 4; ++k) f[j][k] += eta * one.rates[j][k];
  }
  const auto outcome = HiddenSimulation(f, kappa).outcome(start, 400000);
  const Mode mode{decision.mode[0], decision.mode[1]};
  if (!outcome && mode != Mode{0, 0}) {
    ++cell.simulated_open;
  } else {
    ++cell.simulated;
    if (outcome.value_or(mode) != mode) ++cell.simulated_differ;
  }
}

/// Spirals inwards from outside, whatever the scaling; outwards from the root where that is unstable.
HiddenDecision follow_spiral(const AtlasInstance& one, const Scaling& kappa, const SlidingRoot& root, bool inwards) {
  const PlaneField field{one.f};
  const HiddenOptions options = plain_scaling(one.f, kappa);
  if (inwards) {
    return decide_by_hidden_dynamics(2, field, {{Arrival::from_below, Arrival::from_below}, {}}, options);
  }
  const Velocities constant{};
  return decide_leaving(2, field, PlaneField{constant},
                        {{Arrival::along, Arrival::along}, {root.alpha[0], root.alpha[1]}}, 1e-5, options);
}

}  // namespace

const std::vector<Scaling>& atlas_scalings(Tree tree) {
  static const std::vector<Scaling> entering{{1, 1}, {10, 1}, {100, 1}, {1000, 1}, {1, 10}, {1, 100}, {1, 1000}};
  static const std::vector<Scaling> unstable{{1, 1}, {1, 10}, {10, 1}, {100, 1}};
  static const std::vector<Scaling> others{{1, 1}, {10, 1}, {100, 1}, {1, 10}, {1, 100}};
  return tree == Tree::entering ? entering : tree == Tree::unstable ? unstable : others;
}

AtlasTable compare_tree(Tree tree, const AtlasOptions& options) {
  AtlasTable table;
  AtlasInstances instances(options.seed);
  const auto& scalings = atlas_scalings(tree);
  for (long i = 0; i < options.instances; ++i) {
    const AtlasInstance one = instances.next(tree);
    TreeAnswer answer = ask_tree(tree, one);
    if (!answer.decided) {
      // DU: both diagonals positive, so that no scaling stabilised the sliding that is said to end.
      const Derivatives at(one);
      const bool impossible = tree == Tree::fold && std::min(at.g[0][0], at.g[1][1]) > 0.0;
      ++table[{impossible ? "DU" : answer.leaf + " undecided", 0}].instances;
      continue;
    }
    for (std::size_t s = 0; s < std::min(scalings.size(), options.scalings); ++s) {
      const Scaling kappa = one.kappa(scalings[s]);
      if (tree == Tree::spiral) {
        const auto root = intersection_roots(plane_table(one.f)).rising;
        const bool stable = root->stable(kappa);
        auto expected = answer;
        // A stable root keeps the sliding, also where the fields spiral out.
        expected.spirals_out = answer.spirals_out && !stable;
        const std::string leaf = answer.leaf + (answer.spirals_out ? stable ? ", root stable" : ", root unstable" : "");
        count(expected, follow_spiral(one, kappa, *root, !answer.spirals_out), one, table[{leaf, s}]);
        continue;
      }
      if ((tree == Tree::edge || tree == Tree::fold) && !(Derivatives(one).trace(kappa) < 0.0)) continue;
      AtlasCell& cell = table[{answer.leaf, s}];
      const HiddenDecision decision = ask_resolver(tree, one, kappa, options.eta);
      count(answer, decision, one, cell);
      const bool comparable = tree != Tree::unstable;  // which way an unstable root is left depends on the nudge
      if (comparable && options.simulate_every > 0 && i % options.simulate_every == 0) {
        simulate(tree, one, kappa, options.eta, decision, cell);
      }
    }
  }
  return table;
}

}  // namespace saltus::switching
