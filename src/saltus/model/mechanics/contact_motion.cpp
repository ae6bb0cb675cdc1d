#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <casadi/core/dm.hpp>
#include <casadi/core/function.hpp>
#include <fmt/format.h>

#include "saltus/base/contains.hpp"
#include "saltus/model/mechanics/contact_motion_internal.hpp"
#include "saltus/model/mechanics/contacts_at_start.hpp"
#include "saltus/model/mechanics/smooth_check_internal.hpp"
#include "saltus/model/statement/start_values_internal.hpp"

namespace saltus::model {

using casadi::SX;

namespace {

Error contact_error(const SourceLocation& location, std::string message, std::string remedy) {
  return {ErrorCode::invalid_model, std::move(message), std::move(remedy), location, {"in [[contacts]]"}};
}

class ContactMotion {
 public:
  ContactMotion(Recognition& recognition, Statement& statement, const std::vector<ContactStatement>& contacts,
                const MotionWithoutContacts& motion)
      : recognition_(recognition),
        statement_(statement),
        contacts_(contacts),
        motion_(motion),
        q_(symbols_of(statement, motion.positions)),
        v_(symbols_of(statement, motion.velocities)) {}

  [[nodiscard]] Expected<ContactSystem> run() {
    system_.positions = motion_.positions;
    system_.velocities = motion_.velocities;
    for (const auto& stated : contacts_) {
      if (auto error = check_values(stated)) return tl::unexpected(*error);
      if (auto error = check_gap(stated)) return tl::unexpected(*error);
      if (auto error = check_jumps(stated)) return tl::unexpected(*error);
      Contact contact{.name = stated.name};
      const SXElem friction = stated.friction.scalar();
      const auto constant = recognition_.parameter_value(friction);
      contact.friction_varies = !stated.tangents.is_empty() && !constant;
      contact.has_friction = contact.friction_varies || (!stated.tangents.is_empty() && *constant > 0.0);
      recognition_.note({.kind = Decision::Kind::sign, .node = recognition_.graph.node(friction)},
                        [&] { return fmt::format("the friction of '{}'", stated.name); });
      contact.in_plane = contact.has_friction && stated.tangents.size1() == 2;
      if (contact.has_friction) {
        if (auto error = check_tangents(stated)) return tl::unexpected(*error);
      }
      system_.contacts.push_back(std::move(contact));
    }
    set_motion();
    return std::move(system_);
  }

 private:
  Expected<double> at_start(const SX& expression) {
    return recognition_.graph.add(SX::densify(expression).scalar()).map([&](int node) {
      return value_at_start(recognition_, statement_, node);
    });
  }

  /// One over positions or t is what it is when the run gets there; at the start, if that is known.
  struct Coefficient {
    std::string what;  ///< "the friction of 'ground'"
    const SX& stated;
    const SourceLocation& location;
    double largest;
    const char* range;  ///< in words
  };

  /// Its value, or one of its range if it depends on t: nobody knows yet when it starts.
  Expected<double> check_coefficient(const Coefficient& coefficient) {
    auto value = recognition_.parameter_value(coefficient.stated.scalar());
    const bool varies = !value;
    if (varies) {
      const auto node = recognition_.graph.add(coefficient.stated.scalar());
      if (!node) return tl::unexpected(with_location(node.error(), coefficient.location));
      const SmoothOf allowed{motion_.positions, true, coefficient.what, coefficient.location, true};
      if (auto error = check_smooth(recognition_, statement_, *node, allowed)) {
        return tl::unexpected(with_context(*error, "in [[contacts]]"));
      }
      value = SX::depends_on(coefficient.stated, SX(statement_.time)) ? 1.0
                                                                      : value_at_start(recognition_, statement_, *node);
    }
    if (*value >= 0.0 && *value <= coefficient.largest) return *value;
    return tl::unexpected(contact_error(
        coefficient.location, fmt::format("{} is {}{}", coefficient.what, *value, varies ? " at the start" : ""),
        fmt::format("it is a number {}, or an expression of parameters, positions and t", coefficient.range)));
  }

  std::optional<Error> check_values(const ContactStatement& contact) {
    const auto friction =
        check_coefficient({fmt::format("the friction of '{}'", contact.name), contact.friction,
                           contact.friction_location, std::numeric_limits<double>::max(), "that is 0 or positive"});
    if (!friction) return friction.error();
    if (*friction > 0.0 && contact.tangents.is_empty()) {
      return contact_error(contact.friction_location,
                           fmt::format("the contact '{}' has friction and no `tangent`", contact.name),
                           "write tangent = { x = 1 }: the direction in which it slips, over the positions");
    }
    const auto restitution = check_coefficient({fmt::format("the restitution of '{}'", contact.name),
                                                contact.restitution, contact.restitution_location, 1.0, "in [0, 1]"});
    return restitution ? std::nullopt : std::optional(restitution.error());
  }

  /// They are not 0, not along the normal, and two of them span a plane at the start.
  std::optional<Error> check_tangents(const ContactStatement& contact) {
    for (casadi_int k = 0; k < contact.tangents.size1(); ++k) {
      if (auto error = check_reach(contact.tangents(k, casadi::Slice()), contact)) return error;
    }
    const SX rows = SX::densify(SX::vertcat({SX::jacobian(contact.gap, q_), contact.tangents}));
    if (SX::depends_on(rows, SX(statement_.time))) return std::nullopt;  // nobody knows yet when it starts
    std::vector<std::vector<double>> values;
    for (casadi_int i = 0; i < rows.size1(); ++i) {
      auto& row = values.emplace_back();
      for (casadi_int k = 0; k < rows.size2(); ++k) {
        const auto value = at_start(rows(i, k));
        if (!value) return with_location(value.error(), contact.tangent_location);
        row.push_back(*value);
      }
    }
    auto error = check_tangents_at_start(contact.name, values);
    if (error) error->location = contact.tangent_location;
    return error;
  }

  /// Its rate and its derivatives are those of positions and t.
  std::optional<Error> check_reach(const SX& tangent, const ContactStatement& contact) {
    const SX row = SX::densify(tangent);
    for (const SXElem& entry : row.nonzeros()) {
      const auto node = recognition_.graph.add(entry);
      if (!node) return with_location(node.error(), contact.tangent_location);
      auto error = check_smooth(
          recognition_, statement_, *node,
          {motion_.positions, true, fmt::format("the tangent of '{}'", contact.name), contact.tangent_location});
      if (error) return with_context(*error, "in [[contacts]]");
    }
    return std::nullopt;
  }

  /// A jump of the user's at the same place would turn the velocity before the contact sees it.
  std::optional<Error> check_jumps(const ContactStatement& contact) const {
    const auto& velocities = motion_.velocities;
    for (const auto& jump : statement_.jumps) {
      const bool sets_velocity = std::any_of(jump.set.begin(), jump.set.end(), [&](const auto& assignment) {
        return contains(velocities, assignment.state);
      });
      if (!sets_velocity) continue;
      const bool is_there = (jump.guard && is_gap(SX(*jump.guard), contact)) ||
                            (jump.condition && compares_gap(*jump.condition, contact));
      if (!is_there) continue;
      return Error{ErrorCode::invalid_model,
                   fmt::format("a jump sets velocities where the gap of the contact '{}' closes", contact.name),
                   "leave one of them out: the contact turns the velocity itself, by its `restitution` and `friction`",
                   jump.when_location,
                   {"in [[jumps]]"}};
    }
    return std::nullopt;
  }

  /// Whether two expressions are the same but for a factor: their quotient is one number wherever one looks.
  [[nodiscard]] bool is_gap(const SX& expression, const ContactStatement& contact) const {
    const auto symbols = SX::symvar(SX::vertcat({expression, contact.gap}));
    const casadi::Function both("both", {SX::vertcat(symbols)}, {expression, contact.gap});
    double quotient = std::numeric_limits<double>::quiet_NaN();
    for (int place = 1; place <= 4; ++place) {
      std::vector<double> values;
      for (std::size_t k = 0; k < symbols.size(); ++k) {
        values.push_back(
            0.3 +
            0.7 * std::fmod(0.618034 * static_cast<double>(place) * (static_cast<double>(k + 1)) + 0.1 * place, 1.0));
      }
      const auto found = both(std::vector<casadi::DM>{values});
      const double here = static_cast<double>(found[0]) / static_cast<double>(found[1]);
      if (!std::isfinite(here) || (place > 1 && std::abs(here - quotient) > 1e-9 * std::abs(quotient))) return false;
      quotient = here;
    }
    return quotient != 0.0;
  }

  [[nodiscard]] bool compares_gap(const Condition& condition, const ContactStatement& contact) const {
    switch (condition.kind()) {
      case Condition::Kind::comparison:
        return is_gap(condition.comparison().difference, contact);
      case Condition::Kind::conjunction:
      case Condition::Kind::disjunction:
        return compares_gap(condition.left(), contact) || compares_gap(condition.right(), contact);
      case Condition::Kind::negation:
        return compares_gap(condition.left(), contact);
      case Condition::Kind::constant:
        return false;
    }
    __builtin_unreachable();
  }

  std::optional<Error> check_gap(const ContactStatement& contact) {
    const auto node = recognition_.graph.add(contact.gap.scalar());
    if (!node) return with_location(node.error(), contact.gap_location);
    if (auto error = check_smooth(
            recognition_, statement_, *node,
            {motion_.positions, true, fmt::format("the gap of '{}'", contact.name), contact.gap_location})) {
      return with_context(*error, "in [[contacts]]");
    }
    if (!SX::depends_on(contact.gap, q_)) {
      return contact_error(contact.gap_location, fmt::format("the gap of '{}' has no position in it", contact.name),
                           "a gap is an expression of the positions of [mechanics], of parameters and t");
    }
    if (SX::depends_on(contact.gap, SX(statement_.time))) return std::nullopt;  // nobody knows yet when it starts
    const auto gap = at_start(contact.gap);
    if (!gap) return with_location(gap.error(), contact.gap_location);
    auto error = check_gap_at_start(contact.name, *gap);
    if (error) error->location = contact.gap_location;
    return error;
  }

  void set_motion() {
    const auto m = static_cast<casadi_int>(contacts_.size());
    std::vector<SX> gaps, friction, restitution;
    casadi_int directions = 0;
    for (const auto& contact : system_.contacts) {
      if (contact.has_friction) directions = std::max<casadi_int>(directions, contact.tangents());
    }
    SX tangents = SX::zeros(directions * m, q_.numel());
    for (casadi_int i = 0; i < m; ++i) {
      const auto& stated = contacts_[static_cast<std::size_t>(i)];
      gaps.push_back(stated.gap);
      friction.push_back(stated.friction);
      restitution.push_back(stated.restitution);
      if (!system_.contacts[static_cast<std::size_t>(i)].has_friction) continue;
      for (casadi_int k = 0; k < stated.tangents.size1(); ++k) {
        tangents(k * m + i, casadi::Slice()) = stated.tangents(k, casadi::Slice());
      }
    }
    const SX time(statement_.time);
    system_.gap = SX::densify(SX::vertcat(gaps));
    system_.friction = SX::densify(SX::vertcat(friction));
    system_.restitution = SX::densify(SX::vertcat(restitution));
    const SX normals = SX::densify(SX::jacobian(system_.gap, q_));
    system_.rows = SX::vertcat({normals, tangents});
    system_.velocity =
        SX::densify(SX::vertcat({SX::mtimes(normals, v_) + SX::jacobian(system_.gap, time), SX::mtimes(tangents, v_)}));
    system_.responses = motion_.mass.solve(system_.rows.T());
    const SX bias = SX::jtimes(system_.velocity, q_, v_) + SX::jacobian(system_.velocity, time);
    system_.acceleration = SX::densify(SX::mtimes(system_.responses.T(), motion_.force) + bias);
  }

  Recognition& recognition_;
  Statement& statement_;
  const std::vector<ContactStatement>& contacts_;
  const MotionWithoutContacts& motion_;
  SX q_, v_;
  ContactSystem system_;
};

}  // namespace

Expected<ContactSystem> contact_motion(Recognition& recognition, Statement& statement,
                                       const std::vector<ContactStatement>& contacts,
                                       const MotionWithoutContacts& motion) {
  return ContactMotion(recognition, statement, contacts, motion).run();
}

}  // namespace saltus::model
