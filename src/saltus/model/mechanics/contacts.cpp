#include <utility>

#include <fmt/format.h>

#include "saltus/model/mechanics/contact_motion_internal.hpp"
#include "saltus/model/mechanics/contacts_internal.hpp"
#include "saltus/model/mechanics/symbolic_ldl_internal.hpp"

namespace saltus::model {

using casadi::SX;

namespace {

class ContactBuild {
 public:
  ContactBuild(Recognition& recognition, Statement& statement, ContactSystem system,
               std::vector<SourceLocation> locations)
      : recognition_(recognition),
        statement_(statement),
        system_(std::move(system)),
        locations_(std::move(locations)),
        m_(static_cast<casadi_int>(system_.contacts.size())) {}

  [[nodiscard]] SX run() {
    system_.first_hidden = static_cast<int>(statement_.states.size());
    for (auto& contact : system_.contacts) declare(contact);
    set_forces();
    for (std::size_t i = 0; i < system_.contacts.size(); ++i) {
      add_jump(i);
      if (system_.contacts[i].has_gap) add_outputs(i);
    }
    const SX forces = SX::vertcat({system_.normal_force, system_.tangential_force});
    statement_.contacts = std::move(system_);
    return forces;
  }

 private:
  int declare_state(const std::string& name) {
    const auto index = static_cast<int>(statement_.states.size());
    const SXElem symbol = recognition_.graph.symbol(name, {.kind = VariableKind::discrete, .index = index});
    statement_.states.push_back({.name = name, .symbol = symbol, .dynamics = SXElem(0.0)});
    return index;
  }

  /// A name of a hidden state has a point in it, which no name of a user has. Those that friction needs are missing
  /// without it: every step pays for each of them.
  void declare(Contact& contact) {
    contact.closed = declare_state(contact.name + ".closed");
    contact.active = declare_state(contact.name + ".active");
    if (contact.has_friction) {
      contact.stick = declare_along(contact, ".stick");
      contact.slip = declare_state(contact.name + ".slip");
      contact.share = declare_along(contact, ".share");
      if (contact.friction_varies) contact.smooth = declare_state(contact.name + ".smooth");
    }
    if (contact.in_plane) {
      contact.speeds = declare_unit(contact.name + ".least_speed");
      static_cast<void>(declare_unit(contact.name + ".largest_speed"));
    }
    contact.force_unit = declare_unit(contact.name + ".force_unit");
    if (contact.has_friction) contact.speed_unit = declare_unit(contact.name + ".speed_unit");
    contact.impulse = declare_state(contact.name + ".impulse");
    declare_along(contact, ".impulse_t");
  }

  int declare_unit(const std::string& name) {
    const int index = declare_state(name);
    statement_.states[at(index)].initial = 1.0;
    return index;
  }

  /// One state per tangent; returns the first one.
  int declare_along(const Contact& contact, const std::string& name) {
    const int first = declare_state(contact.name + name);
    if (contact.in_plane) declare_state(contact.name + name + "2");
    return first;
  }

  SX state(int index) const { return SX(statement_.states[at(index)].symbol); }

  /// Every contact has two equations that its mode blends: the acceleration is 0, or the force is given.
  void set_forces() {
    const casadi_int m = m_;
    const SX influence = SX::mtimes(system_.rows, system_.responses);  // d acceleration / d force
    // Tangential ones first: their block has no minor that is 0, as M^-1 has none.
    std::vector<casadi_int> order;
    for (casadi_int row = m; row < system_.rows.size1(); ++row) {
      const auto& contact = system_.contacts[at_(row % m)];
      if (row < 2 * m ? contact.has_friction : contact.in_plane) order.push_back(row);
    }
    const auto symmetry = order.empty() ? Symmetry::symmetric : Symmetry::none;
    for (casadi_int i = 0; i < m; ++i) order.push_back(i);
    const auto n = static_cast<casadi_int>(order.size());
    SX matrix = SX::zeros(n, n), right = SX::zeros(n, 1);
    for (casadi_int r = 0; r < n; ++r) {
      const casadi_int i = order[at_(r)] % m, tangent = order[at_(r)] / m - 1;
      const bool tangential = tangent >= 0;
      const auto& contact = system_.contacts[at_(i)];
      const SX held = tangential        ? state(contact.stick + static_cast<int>(tangent))
                      : contact.has_gap ? state(contact.active)
                                        : SX(0.0);
      right(r) = -held * system_.acceleration(order[at_(r)]);
      if (!tangential && !contact.has_gap) right(r) = 1.0;
      for (casadi_int c = 0; c < n; ++c) {
        SX entry = held * influence(order[at_(r)], order[at_(c)]);
        // Without friction what is not held has no force: its column is 0, as its row is.
        if (c != r && symmetry == Symmetry::symmetric) entry *= state(system_.contacts[at_(order[at_(c)])].active);
        if (c == r) entry += 1.0 - held;
        if (tangential && order[at_(c)] == i) entry += (1.0 - held) * system_.friction(i) * share(i, tangent);
        matrix(r, c) = entry;
      }
    }
    const SX forces = eliminate(matrix, right, symmetry);
    system_.normal_force = SX::zeros(m, 1);
    system_.tangential_force = SX::zeros(system_.rows.size1() - m, 1);
    for (casadi_int r = 0; r < n; ++r) {
      const casadi_int row = order[at_(r)];
      (row >= m ? system_.tangential_force(row - m) : system_.normal_force(row)) = forces(r);
    }
  }

  [[nodiscard]] SX tangential_velocity(casadi_int i, casadi_int tangent) const {
    return system_.velocity((1 + tangent) * m_ + i);
  }

  /// The square of the speed of slip in a plane.
  [[nodiscard]] SX speed_squared(casadi_int i) const {
    const SX first = tangential_velocity(i, 0), second = tangential_velocity(i, 1);
    return first * first + second * second;
  }

  /// NOTE: with less than the rounding of any speed at which a contact slips, derivatives are finite at 0.
  static SX norm(const SX& first, const SX& second) {
    constexpr double nothing = 1e-120;
    return sqrt(first * first + second * second + nothing);
  }

  /// Of the edge of the friction cone, along a tangent.
  [[nodiscard]] SX share(casadi_int i, casadi_int tangent) const {
    const auto& contact = system_.contacts[at_(i)];
    const SX own = state(contact.share + static_cast<int>(tangent));
    if (!contact.in_plane) return own;
    const SX slip = state(contact.slip), speed = norm(tangential_velocity(i, 0), tangential_velocity(i, 1));
    return slip * tangential_velocity(i, tangent) / speed + (1.0 - slip) * own;
  }

  static std::size_t at_(casadi_int i) { return static_cast<std::size_t>(i); }

  /// What is positive as long as the mode lasts: the gap, or the normal force; with friction also what is left of the
  /// friction cone on both sides, or the speed of slipping. Forces and speeds are relative to the units of the mode:
  /// they stand beside the 1 of other modes, whatever the user's units are. A coefficient that varies comes last: where
  /// friction begins, and where it turns negative.
  [[nodiscard]] std::vector<SX> guards(std::size_t k) const {
    const auto i = static_cast<casadi_int>(k);
    const auto& contact = system_.contacts[k];
    const SX closed = state(contact.closed), active = state(contact.active);
    std::vector<SX> result;
    if (contact.has_gap) {
      result.push_back((1.0 - closed) * system_.gap(i) +
                       closed * (active * system_.normal_force(i) / state(contact.force_unit) + (1.0 - active)));
    }
    if (contact.in_plane) add_guards_in_plane(i, result);
    if (contact.has_friction && !contact.in_plane) add_guards_along(i, result);
    if (!contact.friction_varies) return result;
    const SX smooth = state(contact.smooth);
    result.push_back(smooth * (2.0 * no_friction - system_.friction(i)) + (1.0 - smooth));
    result.push_back(closed * (system_.friction(i) + 2.0 * no_friction) + (1.0 - closed));
    return result;
  }

  void add_guards_along(casadi_int i, std::vector<SX>& guards) const {
    const auto& contact = system_.contacts[at_(i)];
    const SX stick = state(contact.stick), slip = state(contact.slip);
    const SX unit = state(contact.force_unit), speed = system_.velocity(m_ + i) / state(contact.speed_unit);
    const SX limit = system_.friction(i) * system_.normal_force(i) / unit,
             friction = system_.tangential_force(i) / unit;
    guards.push_back(stick * (limit - friction) + slip * state(contact.share) * speed + (1.0 - stick - slip));
    guards.push_back(stick * (limit + friction) + (1.0 - stick));
  }

  /// What is left of the cone, and the bounds of the speed of slip.
  void add_guards_in_plane(casadi_int i, std::vector<SX>& guards) const {
    const auto& contact = system_.contacts[at_(i)];
    const SX first = state(contact.stick), second = state(contact.stick + 1), slip = state(contact.slip);
    const SX sticks = first + second - first * second, limit = system_.friction(i) * system_.normal_force(i);
    const SX along = system_.tangential_force(i), across = system_.tangential_force(m_ + i);
    guards.push_back(sticks * (limit - norm(along, across)) / state(contact.force_unit) + (1.0 - sticks));
    // Quotients: speeds may be smaller than the rounding of 1.
    guards.push_back(slip * (speed_squared(i) / state(contact.speeds) - 1.0) + (1.0 - slip));
    guards.push_back(slip * (1.0 - speed_squared(i) / state(contact.speeds + 1)) + (1.0 - slip));
  }

  /// The engine finds the new mode, and the velocities behind an impact; the values here only say what changes.
  void add_jump(std::size_t k) {
    auto& contact = system_.contacts[k];
    contact.jump = static_cast<int>(statement_.jumps.size());
    const auto& location = locations_[k];
    JumpStatement jump{.name = contact.name};
    Condition leaves = Condition::never();
    for (const SX& guard : guards(k)) leaves = leaves || less(SX::densify(guard), 0.0);
    jump.condition = leaves;
    const auto set = [&](int index) { jump.set.push_back({index, statement_.states[at(index)].symbol, location}); };
    for (const int velocity : system_.velocities) set(velocity);
    for (int index = system_.first_hidden; index < static_cast<int>(statement_.states.size()); ++index) set(index);
    jump.persistent = false;
    jump.evaluated = JumpValues::at_execution;
    jump.location = jump.when_location = jump.delay_location = location;
    statement_.jumps.push_back(std::move(jump));
  }

  void add_outputs(std::size_t k) {
    const auto i = static_cast<casadi_int>(k);
    const auto& contact = system_.contacts[k];
    const auto add = [&](const char* kind, const SX& value, const char* tangent = "") {
      statement_.automatic_outputs.push_back(
          {fmt::format("{}({}){}", kind, contact.name, tangent), SX::densify(value).scalar()});
    };
    add("gap", system_.gap(i));
    add("force", system_.normal_force(i));
    if (contact.in_plane) {
      add("friction", system_.tangential_force(i), "[1]");
      add("friction", system_.tangential_force(m_ + i), "[2]");
    } else if (contact.has_friction) {
      add("friction", system_.tangential_force(i));
    }
    add("impulse", state(contact.impulse));
  }

  Recognition& recognition_;
  Statement& statement_;
  ContactSystem system_;
  std::vector<SourceLocation> locations_;
  casadi_int m_;
};

}  // namespace

SX state_contact_modes(Recognition& recognition, Statement& statement, ContactSystem system,
                       std::vector<SourceLocation> locations) {
  return ContactBuild(recognition, statement, std::move(system), std::move(locations)).run();
}

Expected<SX> add_contacts(Recognition& recognition, Statement& statement, const std::vector<ContactStatement>& contacts,
                          const MotionWithoutContacts& motion) {
  auto system = contact_motion(recognition, statement, contacts, motion);
  if (!system) return tl::unexpected(system.error());
  const SX rows = system->rows;
  std::vector<SourceLocation> locations;
  for (const auto& contact : contacts) locations.push_back(contact.location);
  return motion.force +
         SX::mtimes(rows.T(), state_contact_modes(recognition, statement, std::move(*system), std::move(locations)));
}

}  // namespace saltus::model
