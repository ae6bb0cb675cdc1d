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
  ContactBuild(Recognition& recognition, Statement& statement, const std::vector<ContactStatement>& contacts,
               const MotionWithoutContacts& motion)
      : recognition_(recognition), statement_(statement), contacts_(contacts), motion_(motion) {}

  [[nodiscard]] Expected<SX> run() {
    auto motion = contact_motion(recognition_, statement_, contacts_, motion_);
    if (!motion) return tl::unexpected(motion.error());
    system_ = std::move(*motion);
    system_.first_hidden = static_cast<int>(statement_.states.size());
    for (auto& contact : system_.contacts) declare(contact);
    set_forces();
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
      add_jump(i);
      add_outputs(i);
    }
    const SX forces = SX::vertcat({system_.normal_force, system_.tangential_force});
    SX total = motion_.force + SX::mtimes(system_.rows.T(), forces);
    statement_.contacts = std::move(system_);
    return total;
  }

 private:
  int declare_state(const std::string& name) {
    const auto index = static_cast<int>(statement_.states.size());
    const SXElem symbol = recognition_.graph.symbol(name, {.kind = VariableKind::discrete, .index = index});
    statement_.states.push_back({.name = name, .symbol = symbol, .dynamics = SXElem(0.0)});
    return index;
  }

  /// A name of a hidden state has a point in it, which no name of a user has.
  void declare(Contact& contact) {
    contact.closed = declare_state(contact.name + ".closed");
    contact.active = declare_state(contact.name + ".active");
    contact.stick = declare_state(contact.name + ".stick");
    contact.slip = declare_state(contact.name + ".slip");
    contact.share = declare_state(contact.name + ".share");
    contact.impulse = declare_state(contact.name + ".impulse");
    declare_state(contact.name + ".impulse_t");
  }

  SX state(int index) const { return SX(statement_.states[at(index)].symbol); }

  /// Every contact has two equations that its mode blends: the acceleration is 0, or the force is given.
  void set_forces() {
    const auto m = static_cast<casadi_int>(contacts_.size());
    const SX influence = SX::mtimes(system_.rows, system_.responses);  // d acceleration / d force
    // Tangential ones first: their block has no minor that is 0, as M^-1 has none.
    std::vector<casadi_int> order;
    for (casadi_int i = 0; i < m; ++i) {
      if (system_.contacts[static_cast<std::size_t>(i)].has_friction) order.push_back(m + i);
    }
    for (casadi_int i = 0; i < m; ++i) order.push_back(i);
    const auto n = static_cast<casadi_int>(order.size());
    SX matrix = SX::zeros(n, n), right = SX::zeros(n, 1);
    for (casadi_int r = 0; r < n; ++r) {
      const bool tangential = order[at_(r)] >= m;
      const casadi_int i = tangential ? order[at_(r)] - m : order[at_(r)];
      const auto& contact = system_.contacts[at_(i)];
      const SX held = state(tangential ? contact.stick : contact.active);
      right(r) = -held * system_.acceleration(order[at_(r)]);
      for (casadi_int c = 0; c < n; ++c) {
        SX entry = held * influence(order[at_(r)], order[at_(c)]);
        if (c == r) entry += 1.0 - held;
        if (tangential && order[at_(c)] == i) entry += (1.0 - held) * system_.friction(i) * state(contact.share);
        matrix(r, c) = entry;
      }
    }
    const SX forces = eliminate(matrix, right);
    system_.normal_force = system_.tangential_force = SX::zeros(m, 1);
    for (casadi_int r = 0; r < n; ++r) {
      const casadi_int row = order[at_(r)];
      (row >= m ? system_.tangential_force(row - m) : system_.normal_force(row)) = forces(r);
    }
  }

  static std::size_t at_(casadi_int i) { return static_cast<std::size_t>(i); }

  /// What is positive as long as the mode lasts: the gap, or the normal force; with friction also what is left of the
  /// friction cone on both sides, or the speed of slipping.
  [[nodiscard]] std::vector<SX> guards(std::size_t k) const {
    const auto i = static_cast<casadi_int>(k);
    const auto& contact = system_.contacts[k];
    const SX closed = state(contact.closed), active = state(contact.active);
    std::vector<SX> result{(1.0 - closed) * system_.gap(i) +
                           closed * (active * system_.normal_force(i) + 1.0 - active)};
    if (!contact.has_friction) return result;
    const SX stick = state(contact.stick), slip = state(contact.slip);
    const SX limit = system_.friction(i) * system_.normal_force(i), friction = system_.tangential_force(i);
    const auto m = static_cast<casadi_int>(contacts_.size());
    result.push_back(stick * (limit - friction) + slip * state(contact.share) * system_.velocity(m + i) + 1.0 - stick -
                     slip);
    result.push_back(stick * (limit + friction) + 1.0 - stick);
    return result;
  }

  /// The engine finds the new mode, and the velocities behind an impact; the values here only say what changes.
  void add_jump(std::size_t k) {
    auto& contact = system_.contacts[k];
    contact.jump = static_cast<int>(statement_.jumps.size());
    const auto& location = contacts_[k].location;
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
    const auto add = [&](const char* kind, const SX& value) {
      statement_.automatic_outputs.push_back({fmt::format("{}({})", kind, contact.name), SX::densify(value).scalar()});
    };
    add("gap", system_.gap(i));
    add("force", system_.normal_force(i));
    if (contact.has_friction) add("friction", system_.tangential_force(i));
    add("impulse", state(contact.impulse));
  }

  Recognition& recognition_;
  Statement& statement_;
  const std::vector<ContactStatement>& contacts_;
  const MotionWithoutContacts& motion_;
  ContactSystem system_;
};

}  // namespace

Expected<SX> add_contacts(Recognition& recognition, Statement& statement, const std::vector<ContactStatement>& contacts,
                          const MotionWithoutContacts& motion) {
  return ContactBuild(recognition, statement, contacts, motion).run();
}

}  // namespace saltus::model
