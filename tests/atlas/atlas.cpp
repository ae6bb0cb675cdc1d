#include "atlas.hpp"

#include <algorithm>
#include <optional>

#include "../unit/switching/hidden_cases.hpp"
#include "../unit/switching/hidden_simulation.hpp"
#include "saltus/switching/hidden/hidden_dynamics.hpp"
#include "saltus/switching/plane/intersection_roots.hpp"
#include "saltus/switching/plane/spiral.hpp"

namespace saltus::switching {
namespace {

using Mode = std::array<int, 2>;
using Point = HiddenSimulation::Point;

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
  const bool in = one.inwards();
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

std::string text(const Mode& mode) { return "R(" + std::to_string(mode[0]) + "," + std::to_string(mode[1]) + ")"; }

/// What the resolver or a simulation says.
struct Finding {
  bool decided = false;
  bool spirals_out = false;
  Mode mode{};

  bool operator==(const Finding&) const = default;
};

void count(const TreeAnswer& answer, const Finding& finding, const AtlasInstance& one, AtlasTally& tally) {
  if (!finding.decided) {
    ++tally.open;
  } else if (answer.spirals_out || finding.spirals_out) {
    if (answer.spirals_out && finding.spirals_out) {
      ++tally.agree;
    } else {
      ++tally.differ[finding.spirals_out ? "spiral out" : text(one.made(finding.mode))];
    }
  } else {
    const auto found = std::find(answer.modes.begin(), answer.modes.end(), finding.mode);
    if (found == answer.modes.begin()) {
      ++tally.agree;
    } else if (found != answer.modes.end()) {
      ++tally.other;
    } else {
      ++tally.differ[text(one.made(finding.mode))];
    }
  }
}

HiddenDecision ask_resolver(Tree tree, const AtlasInstance& one, const Scaling& kappa, double eta) {
  const PlaneField field{one.f};
  const HiddenOptions options = plain_scaling(one.f, kappa);
  if (tree == Tree::entering) {
    return decide_by_hidden_dynamics(2, field, entering_situation(one.f, one.incoming), options);
  }
  if (tree == Tree::spiral && one.inwards()) {
    return decide_by_hidden_dynamics(2, field, {{Arrival::from_below, Arrival::from_below}, {}}, options);
  }
  return decide_leaving(2, field, PlaneField{one.rates},
                        {{Arrival::along, Arrival::along}, {one.alpha[0], one.alpha[1]}}, eta, options);
}

Finding finding_of(const HiddenDecision& decision) {
  if (decision.limit == HiddenLimit::undecided) return {};
  if (decision.limit == HiddenLimit::spirals_out) return {true, true, {}};
  return {true, false, {decision.mode[0], decision.mode[1]}};
}

/// A solution that has not left after all steps slides, its regularised form oscillating, if a cycle is possible at
/// all.
Finding finding_of(const HiddenSimulation::Outcome& outcome, bool may_oscillate) {
  if (outcome.kind == HiddenSimulation::Outcome::Kind::moving) return {may_oscillate, false, {}};
  return {true, outcome.kind == HiddenSimulation::Outcome::Kind::spirals_out, outcome.mode};
}

Velocities later(Velocities f, double time, const Velocities& rates) {
  for (std::size_t j = 0; j < 2; ++j) {
    for (std::size_t k = 0; k < 4; ++k) f[j][k] += time * rates[j][k];
  }
  return f;
}

/// At most so many steps; exits are integrated from so long before their event to so long behind it, with so small an
/// eps.
struct Effort {
  int steps;
  double before;
  double eps;
};
/// The next one decides where one ends open, or an exit differs from the tree: other events, or the delay eps^(2/3),
/// may be as near.
constexpr Effort efforts[]{{30000, 1e-3, 1e-6}, {600000, 1e-5, 1e-9}, {3000000, 1e-7, 1e-12}};

/// The regularised system. Entries and spirals: from where the solution comes. Exits (a) and (b): through the event,
/// from the root shortly before it. Exit (c), where no scaling gives a stable root: from four places beside the root,
/// `turn` of them, with the fields eta later.
Finding simulate(Tree tree, const AtlasInstance& one, const Scaling& kappa, double eta, bool oscillates,
                 std::size_t turn, const Effort& effort) {
  constexpr double beside = 1e-4;
  switch (tree) {
    case Tree::entering: {
      const auto start = entering_situation(one.f, one.incoming).alpha;
      Point u{};
      for (std::size_t j = 0; j < 2; ++j) u[j] = one.incoming[j] == 0 ? start[j] : one.incoming[j] > 0 ? 1.0 : 0.0;
      return finding_of(HiddenSimulation(one.f, kappa).follow(u, effort.steps), oscillates);
    }
    case Tree::edge:
    case Tree::fold: {
      const auto root = intersection_roots(plane_table(later(one.f, -effort.before, one.rates))).rising;
      if (!root) return {};
      return finding_of(
          HiddenSimulation(one.f, one.rates, kappa, effort.eps, effort.before).follow(root->alpha, effort.steps),
          false);
    }
    case Tree::unstable: {
      const Point u{one.alpha[0] + (turn % 2 == 0 ? beside : -beside), one.alpha[1] + (turn < 2 ? beside : -beside)};
      return finding_of(HiddenSimulation(later(one.f, eta, one.rates), kappa).follow(u, effort.steps), false);
    }
    case Tree::spiral: {
      const Point outside{-1000.0, -1000.0};
      const Point inside{one.alpha[0] + beside, one.alpha[1]};
      return finding_of(HiddenSimulation(one.f, kappa).follow(one.inwards() ? outside : inside, effort.steps),
                        oscillates || one.inwards());
    }
  }
  return {};
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
  const auto& of_tree = atlas_scalings(tree);
  for (long i = 0; i < options.instances; ++i) {
    AtlasInstance one = instances.next(tree);
    const TreeAnswer answer = ask_tree(tree, one);
    if (!answer.decided) {
      // DU: both diagonals positive, so that no scaling stabilised the sliding that is said to end.
      const Derivatives at(one);
      const bool impossible = tree == Tree::fold && std::min(at.g[0][0], at.g[1][1]) > 0.0;
      ++table[{impossible ? "DU" : answer.leaf + " undecided", 0}].instances;
      continue;
    }
    for (std::size_t s = 0; s < std::min(of_tree.size(), options.scalings); ++s) {
      const Scaling kappa = one.kappa(of_tree[s]);
      if ((tree == Tree::edge || tree == Tree::fold) && !(Derivatives(one).trace(kappa) < 0.0)) continue;
      auto expected = answer;
      std::string leaf = answer.leaf;
      if (tree == Tree::spiral && answer.spirals_out) {
        // A stable root keeps the sliding, also where the fields spiral out.
        expected.spirals_out = !(Derivatives(one).trace(kappa) < 0.0);
        leaf += expected.spirals_out ? ", root unstable" : ", root stable";
      }
      AtlasCell& cell = table[{leaf, s}];
      ++cell.instances;
      const HiddenDecision decision = ask_resolver(tree, one, kappa, options.eta);
      const Finding resolved = finding_of(decision);
      count(expected, resolved, one, cell.resolver);
      const bool oscillates = decision.limit == HiddenLimit::oscillating;
      cell.cycles += oscillates && !answer.modes.empty() && resolved.mode == answer.modes.front() ? 1 : 0;
      // Through an event slower than the slow one of very different speeds: too long for explicit steps.
      const bool passes = tree == Tree::edge || tree == Tree::fold;
      const bool stiff = std::max(kappa[0], kappa[1]) > 10.0;
      if (options.simulate_every == 0 || i % options.simulate_every != 0 || (passes && stiff)) continue;
      for (std::size_t turn = 0; turn < (tree == Tree::unstable ? 4 : 1); ++turn) {
        Finding simulated;
        for (const Effort& effort : efforts) {
          simulated = simulate(tree, one, kappa, options.eta, oscillates, turn, effort);
          if (simulated.decided && (!passes || simulated == Finding{true, false, answer.modes.front()})) break;
          if (&effort == &efforts[0]) ++cell.closer;
        }
        count(expected, simulated, one, cell.simulated);
        // Which way an unstable root is left depends on the nudge: nothing to compare.
        if (tree != Tree::unstable && resolved.decided && simulated.decided && resolved != simulated) ++cell.apart;
      }
    }
  }
  return table;
}

}  // namespace saltus::switching
