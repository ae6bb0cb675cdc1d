#include "saltus/model/optimal_control/ocp_influence.hpp"

#include <algorithm>
#include <cstddef>
#include <exception>

#include <casadi/core/sx.hpp>
#include <casadi/core/sx_elem.hpp>
#include <fmt/format.h>

#include "saltus/model/ocp.hpp"

namespace saltus::model {
namespace {

/// Which entries of a group of symbols can be moved by what is optimised.
struct Moved {
  casadi::SX symbols;
  std::vector<bool> entries;
};

class Influence {
 public:
  explicit Influence(const Ocp& ocp) : ocp_(ocp) {
    const auto& system = ocp.system;
    const auto size = [](const casadi::SX& symbols) { return static_cast<std::size_t>(symbols.numel()); };
    states_ = {system.x, std::vector<bool>(size(system.x), ocp.horizon.free)};
    for (std::size_t i = 0; i < ocp.free_states.size(); ++i) {
      if (ocp.free_states[i]) states_.entries[i] = true;
    }
    controls_ = {system.u, std::vector<bool>(size(system.u), true)};
    parameters_ = {system.p, ocp.free_parameters};
    parameters_.entries.resize(size(system.p), false);
    selections_ = {system.alpha, std::vector<bool>(size(system.alpha), false)};
    for (const auto& cell : system.cells) {
      cells_.symbols = casadi::SX::vertcat({cells_.symbols, cell.symbols});
      first_constants_.push_back(cells_.entries.size());
      cells_.entries.resize(size(cells_.symbols), false);
    }
    spread();
  }

  [[nodiscard]] bool reaches(const casadi::SX& value) const {
    const auto touched = [&](const Moved& group) { return touches(value, group); };
    return touched(states_) || touched(controls_) || touched(parameters_) || touched(selections_) || touched(cells_);
  }

 private:
  static bool touches(const casadi::SX& value, const Moved& group) {
    if (value.numel() == 0 || group.entries.empty()) return false;
    for (const auto column : casadi::SX::jacobian_sparsity(value, group.symbols).get_col()) {
      if (group.entries[static_cast<std::size_t>(column)]) return true;
    }
    return false;
  }

  /// From what is moved to what follows it, until nothing is added.
  void spread() {
    for (bool grows = true; grows;) {
      grows = false;
      for (std::size_t j = 0; j < ocp_.system.switching.size() && j < selections_.entries.size(); ++j) {
        grows = add(ocp_.system.switching[j].psi, selections_, j) || grows;
      }
      for (std::size_t i = 0; i < states_.entries.size(); ++i) {
        grows = add(ocp_.system.f(static_cast<casadi_int>(i)), states_, i) || grows;
      }
      grows = spread_to_cells() || grows;
    }
  }

  bool add(const casadi::SX& value, Moved& group, std::size_t entry) {
    if (group.entries[entry] || !reaches(value)) return false;
    group.entries[entry] = true;
    return true;
  }

  /// All constants of a cell change with its argument.
  bool spread_to_cells() {
    bool grows = false;
    for (std::size_t c = 0; c < first_constants_.size(); ++c) {
      const auto& cell = ocp_.system.cells[c];
      if (!add(cell.argument, cells_, first_constants_[c])) continue;
      std::fill_n(cells_.entries.begin() + static_cast<std::ptrdiff_t>(first_constants_[c]), cell.symbols.numel(),
                  true);
      grows = true;
    }
    return grows;
  }

  const Ocp& ocp_;
  Moved states_, controls_, parameters_, selections_;
  Moved cells_{casadi::SX(0, 1), {}};         ///< constants of all cells
  std::vector<std::size_t> first_constants_;  ///< of each cell
};

}  // namespace

std::vector<std::string> idle_costs(const Ocp& ocp) {
  std::vector<std::string> found;
  if (!ocp.running_cost && !ocp.terminal_cost && ocp.horizon.time_weight == 0.0 && ocp.least_squares.empty()) {
    found.emplace_back("nothing is minimised: every feasible point is as good as any other");
  }
  if (ocp.horizon.time_weight != 0.0 && !ocp.horizon.free) {
    found.emplace_back("minimize_time adds a constant: the horizon is fixed");
  }
  try {
    const Influence influence(ocp);
    const auto reached = [&](int output) {
      return influence.reaches(ocp.system.outputs(static_cast<casadi_int>(output)));
    };
    const std::string sentence = "neither controls nor anything that is free influences {}";
    if (ocp.running_cost && !ocp.horizon.free && !reached(*ocp.running_cost)) {
      found.push_back(fmt::format(fmt::runtime(sentence), "running_cost"));
    }
    if (ocp.terminal_cost && !reached(*ocp.terminal_cost)) {
      found.push_back(fmt::format(fmt::runtime(sentence), "terminal_cost"));
    }
    for (std::size_t i = 0; i < ocp.least_squares.size(); ++i) {
      const auto& of = ocp.least_squares[i].of;
      if (!std::any_of(of.begin(), of.end(), reached)) {
        found.push_back(fmt::format(fmt::runtime(sentence), fmt::format("entry {} of least_squares", i + 1)));
      }
    }
  } catch (const std::exception&) {
    return found;  // what the symbolic layer cannot tell is no reason to warn
  }
  return found;
}

}  // namespace saltus::model
