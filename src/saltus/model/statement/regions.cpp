#include <casadi/core/function.hpp>

#include "saltus/base/at.hpp"
#include "saltus/model/statement/regions_internal.hpp"

namespace saltus::model {
namespace {

/// Calls visit(mode) for every mode by `indicator`.
template <class Visit>
void for_each_region(const Statement& statement, Visit&& visit) {
  for (const auto& group : statement.mode_groups) {
    if (!group.by_indicator()) continue;
    for (const auto& mode : group.modes) visit(mode);
  }
}

/// Switching functions whose selections occur in an expression.
std::vector<int> selections_in(const SXElem& expression, const casadi::SX& alpha) {
  std::vector<int> found;
  if (alpha.numel() == 0) return found;
  for (const auto column : casadi::SX::jacobian_sparsity(casadi::SX(expression), alpha).get_col()) {
    found.push_back(static_cast<int>(column));
  }
  return found;
}

/// What stands for each theta in f: 1 less the others for the reference.
SXElem weight_of(std::size_t region, const std::vector<SXElem>& theta, const std::vector<SXElem>& reference) {
  SXElem rest = 1.0;
  for (std::size_t other = 0; other < theta.size(); ++other) {
    if (other != region) rest -= theta[other];
  }
  return (1.0 - reference[region]) * theta[region] + reference[region] * rest;
}

}  // namespace

std::vector<std::pair<SXElem, SourceLocation>> indicators(const Statement& statement) {
  std::vector<std::pair<SXElem, SourceLocation>> found;
  for_each_region(statement, [&](const ModeStatement& mode) { found.emplace_back(*mode.indicator, mode.location); });
  return found;
}

std::vector<ModeRate> region_rates(const Statement& statement) {
  std::vector<ModeRate> found;
  for_each_region(statement,
                  [&](const ModeStatement& mode) { found.insert(found.end(), mode.rates.begin(), mode.rates.end()); });
  return found;
}

std::vector<bool> moved_by_regions(const Statement& statement) {
  std::vector<bool> moved(statement.states.size(), false);
  for (const auto& rate : region_rates(statement)) {
    if (!rate.rate.is_zero()) moved[at(rate.state)] = true;
  }
  return moved;
}

std::optional<Error> add_regions(SxGraph& graph, const Statement& statement, const std::set<int>& sliding,
                                 System& system) {
  const casadi::SX outer = system.alpha;
  std::vector<SXElem> alphas = outer.nonzeros();
  for (std::size_t g = 0; g < statement.mode_groups.size(); ++g) {
    const auto& modes = statement.mode_groups[g].modes;
    if (!statement.mode_groups[g].by_indicator()) continue;
    auto& group = system.mode_groups[g];
    group.first = static_cast<int>(system.switching.size());
    std::vector<SXElem> theta, reference;
    SXElem smallest = 0.0;
    for (const auto& mode : modes) {
      group.mode_names.push_back(mode.name);
      theta.push_back(SXElem::sym("theta"));
      reference.push_back(SXElem::sym("reference"));
      smallest += reference.back() * *mode.indicator;
    }
    group.reference = column(reference);
    alphas.insert(alphas.end(), theta.begin(), theta.end());
    for (std::size_t i = 0; i < modes.size(); ++i) {
      const SXElem psi = smallest - *modes[i].indicator;
      system.switching.push_back({modes[i].name, psi, SwitchingRole::region, false, selections_in(psi, outer)});
      const SXElem weight = weight_of(i, theta, reference);
      for (const auto& [state, rate, location] : modes[i].rates) {
        SXElem reduced = rate;
        if (statement.inclusion != Inclusion::aizerman_pyatnitskii) {
          const auto& name = statement.states[at(state)].name;
          auto component = interpolate(graph, graph.node(rate), sliding, "the dynamics of " + name);
          if (!component) return with_location(component.error(), location);
          reduced = *component;
        }
        system.f(state) += casadi::SX(graph.weighted(weight, reduced));
        system.f_as_written(state) += casadi::SX(graph.weighted(weight, rate));
      }
    }
  }
  system.alpha = column(alphas);
  return std::nullopt;
}

}  // namespace saltus::model
