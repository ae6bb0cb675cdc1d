#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <span>

#include <fmt/format.h>

#include "saltus/model/graph/sharing_internal.hpp"
#include "saltus/model/recognition/decisions_internal.hpp"

namespace saltus::model {
namespace {

constexpr double undecided = std::numeric_limits<double>::quiet_NaN();

double sign_of(double value) { return value > 0.0 ? 1.0 : (value < 0.0 ? -1.0 : value); }

double orientation(const Tape& tape, int psi, int other) {
  SharingIndex index;
  index.insert(tape, psi, 0);
  const auto found = index.find(tape, other, [](const SharedFunction&) { return true; });
  return found ? found->orientation : 0.0;
}

double excluded(const Tape& tape, int psi, int other) {
  const auto signs = impossible_signs(threshold_samples(tape, psi), threshold_samples(tape, other));
  if (!signs) return orientation(tape, psi, other);
  return 2.0 + (signs->first ? 1.0 : 0.0) + (signs->second ? 2.0 : 0.0);
}

bool has_parameter(const Tape& tape, int node) {
  return node >= 0 && (tape[node].reached & kind_bit(VariableKind::parameter)) != 0;
}

bool has_alpha(const Tape& tape, int node, const std::set<int>& wanted) {
  const auto alphas = alpha_nodes(tape, std::span(&node, 1), Links::written);
  return std::any_of(alphas.begin(), alphas.end(), [&](int alpha) { return wanted.contains(alpha); });
}

}  // namespace

double outcome(const Tape& tape, const Decision& decision) {
  const auto constant = [&] { return constant_value(tape, decision.node).value_or(undecided); };
  switch (decision.kind) {
    case Decision::Kind::value:
      return constant();
    case Decision::Kind::sign:
      return sign_of(constant());
    case Decision::Kind::cell: {
      const double value = constant();
      return std::isnan(value) ? value : static_cast<double>(decision.table->cell(value));
    }
    case Decision::Kind::multiple:
      return orientation(tape, decision.node, decision.other);
    case Decision::Kind::excluded:
      return excluded(tape, decision.node, decision.other);
  }
  __builtin_unreachable();
}

bool has_parameters(const Tape& tape, const Decision& decision) {
  return has_parameter(tape, decision.node) || has_parameter(tape, decision.other);
}

Decision decided(const Tape& tape, Decision decision) {
  decision.outcome = outcome(tape, decision);
  if (decision.kind == Decision::Kind::value) decision.text += fmt::format(" is {}", decision.outcome);
  if (decision.kind == Decision::Kind::sign) {
    decision.text += decision.outcome > 0.0 ? " is positive" : decision.outcome < 0.0 ? " is negative" : " is 0";
  }
  return decision;
}

std::shared_ptr<const Decisions> on_tape_of_their_own(const Tape& tape, Decisions decisions) {
  std::set<int> kinks;
  for (const auto& kink : decisions.kinks) kinks.insert(kink.alpha);
  if (kinks.empty()) decisions.targets.clear();
  std::erase_if(decisions.targets,
                [&](int node) { return !has_parameter(tape, node) || !has_alpha(tape, node, kinks); });
  std::vector<int> roots;
  for (const auto& decision : decisions.noted) roots.insert(roots.end(), {decision.node, decision.other});
  for (const auto& [psi, name] : decisions.functions) roots.push_back(psi);
  for (const auto& kink : decisions.kinks) roots.insert(roots.end(), {kink.psi, kink.alpha});
  roots.insert(roots.end(), decisions.targets.begin(), decisions.targets.end());
  const bool any = std::any_of(roots.begin(), roots.end(), [&](int node) { return has_parameter(tape, node); });
  if (!any && decisions.mass_pivots.empty()) return nullptr;
  for (const auto& pivot : decisions.mass_pivots) roots.push_back(pivot.node);
  decisions.tape = tape.part(roots);
  const auto move = [&](int& node) { node = decisions.tape.place_of(node); };
  for (auto& decision : decisions.noted) {
    move(decision.node);
    move(decision.other);
  }
  for (auto& [psi, name] : decisions.functions) move(psi);
  for (auto& kink : decisions.kinks) {
    move(kink.psi);
    move(kink.alpha);
  }
  for (int& target : decisions.targets) move(target);
  for (auto& pivot : decisions.mass_pivots) move(pivot.node);
  Selections discrete;
  for (const auto& [alpha, value] : decisions.discrete) {
    if (const int place = decisions.tape.place_of(alpha); place >= 0) discrete.emplace(place, value);
  }
  decisions.discrete = std::move(discrete);
  decisions.tape.renumber();
  return std::make_shared<const Decisions>(std::move(decisions));
}

}  // namespace saltus::model
