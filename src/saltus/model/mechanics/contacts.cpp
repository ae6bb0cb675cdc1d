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
    declare_activities();
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
  /// Forces up to which an elimination as an expression is made and evaluated as fast as one in numbers.
  static constexpr casadi_int most_eliminated = 8;

  /// A name of such a constant has a point in it, which no name of a user has.
  void declare_activities() {
    system_.activities = SX::zeros(Activity::constants, m_);
    for (casadi_int i = 0; i < m_; ++i) {
      for (int k = 0; k < Activity::constants; ++k) {
        system_.activities(k, i) =
            recognition_.graph.symbol(fmt::format("{}.{}", system_.contacts[at_(i)].name, k),
                                      {.kind = VariableKind::activity, .index = static_cast<int>(i)});
      }
    }
  }

  [[nodiscard]] SX constant(casadi_int i, casadi_int which) const { return system_.activities(which, i); }

  /// Every contact has two equations that its mode blends: the acceleration is 0, or the force is given. An elimination
  /// is an expression over all contacts; in numbers it is one over those that are closed.
  void set_forces() {
    const casadi_int m = m_;
    // Tangential ones first: their block has no minor that is 0, as M^-1 has none.
    std::vector<casadi_int> order;
    bool varies = false;
    system_.cone = SX::zeros(system_.rows.size1() - m, 1);
    for (casadi_int row = m; row < system_.rows.size1(); ++row) {
      const auto& contact = system_.contacts[at_(row % m)];
      if (row < 2 * m ? !contact.has_friction : !contact.in_plane) continue;
      order.push_back(row);
      system_.cone(row - m) = system_.friction(row % m) * share(row % m, row / m - 1);
      varies = varies || contact.friction_varies;
    }
    const auto symmetry = order.empty() ? Symmetry::symmetric : Symmetry::none;
    for (casadi_int i = 0; i < m; ++i) order.push_back(i);
    if (static_cast<casadi_int>(order.size()) > most_eliminated && !varies) return declare_forces();
    eliminate_forces(order, symmetry);
  }

  void declare_forces() {
    system_.forces = SX::zeros(system_.rows.size1(), 1);
    for (casadi_int row = 0; row < system_.rows.size1(); ++row) {
      const casadi_int i = row % m_;
      system_.forces(row) =
          recognition_.graph.symbol(fmt::format("{}.force{}", system_.contacts[at_(i)].name, row / m_),
                                    {.kind = VariableKind::force, .index = static_cast<int>(i)});
    }
    system_.normal_force = system_.forces(casadi::Slice(0, m_));
    system_.tangential_force = system_.forces(casadi::Slice(m_, system_.forces.size1()));
  }

  void eliminate_forces(const std::vector<casadi_int>& order, Symmetry symmetry) {
    const casadi_int m = m_;
    const SX influence = SX::mtimes(system_.rows, system_.responses);  // d acceleration / d force
    const auto n = static_cast<casadi_int>(order.size());
    SX matrix = SX::zeros(n, n), right = SX::zeros(n, 1);
    for (casadi_int r = 0; r < n; ++r) {
      const casadi_int i = order[at_(r)] % m, tangent = order[at_(r)] / m - 1;
      const bool tangential = tangent >= 0;
      const auto& contact = system_.contacts[at_(i)];
      const SX held = tangential        ? constant(i, Activity::holding + tangent)
                      : contact.has_gap ? constant(i, Activity::carrying)
                                        : SX(0.0);
      right(r) = -held * system_.acceleration(order[at_(r)]);
      if (!tangential && !contact.has_gap) right(r) = 1.0;
      for (casadi_int c = 0; c < n; ++c) {
        SX entry = held * influence(order[at_(r)], order[at_(c)]);
        // Without friction what is not held has no force: its column is 0, as its row is.
        if (c != r && symmetry == Symmetry::symmetric) entry *= constant(order[at_(c)], Activity::carrying);
        if (c == r) entry += 1.0 - held;
        if (tangential && order[at_(c)] == i) entry += (1.0 - held) * system_.cone(order[at_(r)] - m);
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
    const SX own = constant(i, Activity::sharing + tangent);
    if (!contact.in_plane) return own;
    const SX slip = constant(i, Activity::slipping), speed = norm(tangential_velocity(i, 0), tangential_velocity(i, 1));
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
    const SX closed = constant(i, Activity::closed), active = constant(i, Activity::carrying);
    std::vector<SX> result;
    if (contact.has_gap) {
      result.push_back((1.0 - closed) * system_.gap(i) +
                       closed *
                           (active * system_.normal_force(i) / constant(i, Activity::unit_of_forces) + (1.0 - active)));
    }
    if (contact.in_plane) add_guards_in_plane(i, result);
    if (contact.has_friction && !contact.in_plane) add_guards_along(i, result);
    if (!contact.friction_varies) return result;
    const SX smooth = constant(i, Activity::smooth);
    result.push_back(smooth * (2.0 * no_friction - system_.friction(i)) + (1.0 - smooth));
    result.push_back(closed * (system_.friction(i) + 2.0 * no_friction) + (1.0 - closed));
    return result;
  }

  void add_guards_along(casadi_int i, std::vector<SX>& guards) const {
    const SX stick = constant(i, Activity::holding), slip = constant(i, Activity::slipping);
    const SX unit = constant(i, Activity::unit_of_forces),
             speed = system_.velocity(m_ + i) / constant(i, Activity::unit_of_speeds);
    const SX limit = system_.friction(i) * system_.normal_force(i) / unit,
             friction = system_.tangential_force(i) / unit;
    guards.push_back(stick * (limit - friction) + slip * constant(i, Activity::sharing) * speed + (1.0 - stick - slip));
    guards.push_back(stick * (limit + friction) + (1.0 - stick));
  }

  /// What is left of the cone, and the bounds of the speed of slip.
  void add_guards_in_plane(casadi_int i, std::vector<SX>& guards) const {
    const SX first = constant(i, Activity::holding), second = constant(i, Activity::holding + 1);
    const SX slip = constant(i, Activity::slipping);
    const SX sticks = first + second - first * second, limit = system_.friction(i) * system_.normal_force(i);
    const SX along = system_.tangential_force(i), across = system_.tangential_force(m_ + i);
    guards.push_back(sticks * (limit - norm(along, across)) / constant(i, Activity::unit_of_forces) + (1.0 - sticks));
    // Quotients: speeds may be smaller than the rounding of 1.
    guards.push_back(slip * (speed_squared(i) / constant(i, Activity::least_speed) - 1.0) + (1.0 - slip));
    guards.push_back(slip * (1.0 - speed_squared(i) / constant(i, Activity::largest_speed)) + (1.0 - slip));
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
    for (const int velocity : system_.velocities) {
      jump.set.push_back({velocity, statement_.states[at(velocity)].symbol, location});
    }
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
    add("impulse", SX(0.0));  // of an event, which gives it to its row
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
