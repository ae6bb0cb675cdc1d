#include "saltus/model/mechanics/gaps_at_start.hpp"

#include <vector>

#include <casadi/core/function.hpp>
#include <fmt/format.h>

namespace saltus::model {

std::optional<Error> check_gap_at_start(const std::string& contact, double gap, const std::string& when) {
  constexpr double rounding = 1e-12;
  if (gap >= -rounding) return std::nullopt;
  return Error{ErrorCode::invalid_model,
               fmt::format("the gap of '{}' is {} at the start{}", contact, gap, when),
               "bodies begin apart or in touch: the gap must not be negative; change the initial positions",
               {},
               {fmt::format("in [[contacts]] {}", contact)}};
}

std::optional<Error> check_gaps_at_start(const System& system, double from) {
  const auto& contacts = system.contacts;
  if (contacts.empty() || !casadi::SX::depends_on(contacts.gap, system.t)) return std::nullopt;
  const casadi::Function gaps("saltus_gaps_at_start", {system.t, system.x, system.p}, {contacts.gap});
  const auto values = gaps(std::vector<casadi::DM>{from, system.initial_state, system.parameter_values}).front();
  for (std::size_t i = 0; i < contacts.contacts.size(); ++i) {
    const auto row = static_cast<casadi_int>(i);
    if (!casadi::SX::depends_on(contacts.gap(row), system.t)) continue;
    auto error =
        check_gap_at_start(contacts.contacts[i].name, static_cast<double>(values(row)), fmt::format(", t = {}", from));
    if (error) return error;
  }
  return std::nullopt;
}

}  // namespace saltus::model
