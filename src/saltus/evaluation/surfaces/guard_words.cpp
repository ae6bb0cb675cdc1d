#include "saltus/evaluation/surfaces/guard_words.hpp"

#include <cmath>
#include <cstddef>
#include <limits>

#include "saltus/base/at.hpp"
#include "saltus/model/system.hpp"

namespace saltus::evaluation {
namespace {

using casadi::SX;

/// Conditions of more guards than this are tried in too many ways.
constexpr std::size_t most_guards = 6;

/// The state that a jump turns from 0 to 1 and back, and that has its name; -1 without one.
int turned_state(const model::System& system, const model::Jump& jump) {
  if (jump.targets.size() != 1 || jump.value.numel() != 1) return -1;
  const int state = jump.targets.front();
  const bool is_turn = SX::is_equal(jump.values(0), 1.0 - system.x(state), 2);
  return is_turn && system.state_names[at(state)] == jump.name ? state : -1;
}

double number_of(const SX& expression) {
  return expression.is_constant() ? static_cast<double>(expression.scalar()) : std::numeric_limits<double>::quiet_NaN();
}

/// Of every guard whether the condition of a jump depends on it where its state has a value.
std::vector<bool> guards_at(const model::System& system, const model::Jump& jump, int state, double value) {
  const SX x = system.x(state);
  std::vector<double> selections;
  std::vector<std::size_t> open;  // guards that this state alone does not decide
  for (std::size_t i = 0; i < jump.true_at_equality.size(); ++i) {
    const double guard = number_of(SX::substitute(SX(jump.guards(static_cast<casadi_int>(i))), x, SX(value)));
    if (std::isnan(guard)) open.push_back(i);
    selections.push_back(guard > 0.0 || (guard == 0.0 && jump.true_at_equality[i]) ? 1.0 : 0.0);
  }
  std::vector<bool> depends(selections.size(), false);
  if (open.size() > most_guards) return depends;
  std::vector<double> truth;  // by the bits of the open ones
  for (std::size_t bits = 0; bits < (std::size_t{1} << open.size()); ++bits) {
    for (std::size_t k = 0; k < open.size(); ++k) selections[open[k]] = (bits >> k & 1U) != 0U ? 1.0 : 0.0;
    truth.push_back(number_of(SX::substitute(jump.value, jump.guard_alpha, SX(selections))));
  }
  for (std::size_t bits = 0; bits < truth.size(); ++bits) {
    for (std::size_t k = 0; k < open.size(); ++k) {
      if (truth[bits] != truth[bits ^ (std::size_t{1} << k)]) depends[open[k]] = true;
    }
  }
  return depends;
}

}  // namespace

std::vector<std::string> guard_words(const model::System& system, const model::Jump& jump) {
  std::vector<std::string> words(static_cast<std::size_t>(jump.guards.numel()));
  const int state = turned_state(system, jump);
  if (state < 0) return words;
  const auto on = guards_at(system, jump, state, 0.0), off = guards_at(system, jump, state, 1.0);
  for (std::size_t i = 0; i < on.size(); ++i) {
    if (on[i] != off[i]) words[i] = on[i] ? "on" : "off";
  }
  return words;
}

}  // namespace saltus::evaluation
