#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "saltus/model/mechanics/contact_motion_internal.hpp"
#include "saltus/model/time_freezing/freeze_internal.hpp"
#include "saltus/model/time_freezing/negative_friction.hpp"

namespace saltus::model {

using casadi::SX;

namespace {

Error not_frozen(std::string message, std::string remedy) {
  // Member by member: g++ 12 takes the aggregate for uninitialised.
  Error error;
  error.code = ErrorCode::not_available;
  error.message = std::move(message);
  error.remedy = std::move(remedy);
  return error;
}

}  // namespace

std::optional<Error> freeze_hysteresis(Recognition& recognition, Statement& statement, int state, const SXElem& input,
                                       const HysteresisThresholds& thresholds, FreezingPlan& plan) {
  for (const auto& [threshold, location] :
       {std::pair{thresholds.on, &thresholds.on_location}, std::pair{thresholds.off, &thresholds.off_location}}) {
    if (is_of_parameters(statement, threshold)) continue;
    auto error = not_frozen(
        fmt::format("the thresholds of the hysteresis '{}' vary, and time-freezing needs constants", thresholds.name),
        "simulate with method = \"event\", or give numbers or parameters");
    return with_location(std::move(error), *location);
  }
  if (auto error = begin_hysteresis(recognition, statement, state, input, thresholds)) return error;
  const SX w(statement.states[at(state)].symbol), on(thresholds.on), off(thresholds.off);
  const SX width = on - off, side = width / sqrt(width * width);  // whichever of both is higher
  if (plan.takes_plane) {
    plan.plane = {thresholds.name, (SX(input) - off) / width, w, state};
    return std::nullopt;
  }
  // NOTE: no region pulls back to 0 or 1 where the state waits. Between two such regions the point where they meet the
  // threshold would be at rest, too, and time would stand still there for ever.
  std::vector<SX> alphas;
  for (const auto& [psi, name] : {std::pair{side * (SX(input) - on), "on"}, std::pair{side * (off - SX(input)), "off"},
                                  std::pair{w - 1.0, "one"}, std::pair{w, "zero"}}) {
    const auto alpha = recognition.surface(SX::densify(psi).scalar(), fmt::format("{}.{}", thresholds.name, name));
    if (!alpha) return with_location(alpha.error(), thresholds.location);
    alphas.emplace_back(*alpha);
  }
  const SX up = alphas[0] * (1.0 - alphas[2]), down = alphas[1] * alphas[3];
  plan.added.push_back({state, plan.numbers.transfer * (up - down)});
  plan.waits *= (1.0 - up) * (1.0 - down);
  return std::nullopt;
}

namespace {

class ContactFreezing {
 public:
  ContactFreezing(Recognition& recognition, Statement& statement, const ContactSystem& system, FreezingPlan& plan)
      : recognition_(recognition),
        statement_(statement),
        system_(system),
        plan_(plan),
        m_(static_cast<casadi_int>(system.contacts.size())) {}

  [[nodiscard]] std::optional<Error> run(const std::vector<ContactStatement>& contacts) {
    for (std::size_t i = 0; i < system_.contacts.size(); ++i) {
      if (!recognition_.parameter_value(contacts[i].restitution.scalar())) {
        auto varies = not_frozen(
            fmt::format("the restitution of '{}' varies, and time-freezing needs a number", contacts[i].name),
            "simulate with method = \"event\", or give a number");
        return with_location(with_context(std::move(varies), "in [[contacts]]"), contacts[i].restitution_location);
      }
      const int restitution = recognition_.graph.node(contacts[i].restitution.scalar());
      recognition_.note({.kind = Decision::Kind::value, .node = restitution, .computed = ComputedNumber{}},
                        [&] { return fmt::format("the restitution of '{}'", contacts[i].name); });
      auto error = plan_.made.contacts[i].is_elastic ? take_elastic(i) : take_inelastic(i);
      if (error) return with_location(*error, contacts[i].location);
    }
    return std::nullopt;
  }

 private:
  Expected<SX> selection(const SX& psi, const std::string& name, FrozenSelection& found) {
    const auto alpha = recognition_.surface(SX::densify(psi).scalar(), name);
    if (!alpha) return tl::unexpected(alpha.error());
    plan_.selections.emplace_back(*alpha, &found);
    return SX(*alpha);
  }

  [[nodiscard]] SX response(casadi_int row) const { return system_.responses(casadi::Slice(), row); }

  void add_to(const std::vector<int>& states, const SX& rates) {
    for (std::size_t k = 0; k < states.size(); ++k) {
      plan_.added.push_back({states[k], plan_.waits * rates(static_cast<casadi_int>(k))});
    }
  }

  /// Stops the rate of the gap, as fast as a_n says; held at 0 it balances the other forces.
  std::optional<Error> take_inelastic(std::size_t k) {
    const auto i = static_cast<casadi_int>(k);
    auto& made = plan_.made.contacts[k];
    const auto gap = selection(system_.gap(i), made.name + ".gap", made.gap);
    if (!gap) return gap.error();
    const auto rate = selection(system_.velocity(i), made.name + ".rate", made.normal);
    if (!rate) return rate.error();
    plan_.moves *= *gap + *rate - *gap * *rate;
    const SX normal = plan_.numbers.a_n * (1.0 - *gap) * (1.0 - *rate);
    SX tangential(0, 1), rates = response(i) * normal;
    if (system_.contacts[k].has_friction) {
      const auto [psi, directions] = slip(k);
      const auto side = selection(psi, made.name + ".slip", made.tangent);
      if (!side) return side.error();
      if (system_.contacts[k].friction_varies) stop_below_none(k);
      tangential = -system_.friction(i) * (2.0 * *side - 1.0) * normal * directions;
      made.tangents = static_cast<int>(directions.numel());
    }
    for (int j = 0; j < made.tangents; ++j) rates += response((1 + j) * m_ + i) * tangential(j);
    add_to(system_.velocities, rates);
    if (!plan_.stabilisation.is_zero()) {
      add_to(system_.positions, -plan_.stabilisation * response(i) * system_.gap(i) * (1.0 - *gap) * (1.0 - *rate));
    }
    if (plan_.purpose == FrozenFor::optimisation && plan_.numbers.correction > 0.0 && is_curved(system_.gap(i))) {
      if (auto error = hold(k, *rate)) return error;
    }
    add_outputs(k, normal, tangential);
    return std::nullopt;
  }

  /// An event of a simulation, where friction turns negative at a gap that is closed.
  void stop_below_none(std::size_t k) {
    constexpr double closed = 1e-6;
    if (plan_.purpose != FrozenFor::simulation) return;
    const auto i = static_cast<casadi_int>(k);
    EventStatement stop{.name = plan_.made.contacts[k].name + negative_friction, .action = AtEvent::stop};
    stop.condition = less(system_.friction(i), -no_friction) && less(system_.gap(i), closed);
    statement_.events.push_back(std::move(stop));
  }

  /// What is positive in slip, and the directions against which friction acts. In a plane it is the speed beyond eps_t,
  /// rounded at 0, so that it has a gradient: slower ones are driven to it, and friction that holds has a direction.
  [[nodiscard]] std::pair<SX, SX> slip(std::size_t k) const {
    const auto i = static_cast<casadi_int>(k);
    const SX first = system_.velocity(m_ + i);
    if (!system_.contacts[k].in_plane) return {first, 1.0};
    const double eps_t = plan_.numbers.eps_t, rounded = 0.1 * eps_t;
    const SX velocity = SX::vertcat({first, system_.velocity(2 * m_ + i)});
    const SX speed = sqrt(SX::sumsqr(velocity) + rounded * rounded);
    return {speed - std::hypot(eps_t, rounded), velocity / speed};
  }

  /// Whether a scheme that holds its rate at the stages does not hold the gap.
  [[nodiscard]] bool is_curved(const SX& gap) const {
    SX moving(0, 1);
    for (const auto& state : statement_.states) moving = SX::vertcat({moving, SX(state.symbol)});
    return SX::depends_on(SX::jacobian(gap, moving), moving);
  }

  /// Where the rate is held at 0, the difference of two selections of its surface is a speed of either sign that keeps
  /// the gap at 0; elsewhere it is 0. In exact motions it is 0 there, too, so that they stay what they are.
  ///
  /// NOTE: equal functions, and multiples, have one selection. This one has the same sign and surface, and is none.
  std::optional<Error> hold(std::size_t k, const SX& rate) {
    const auto i = static_cast<casadi_int>(k);
    const SX value = system_.velocity(i), square = value * value;
    const SX same_surface = value * (1.0 + square / (1.0 + square));
    const auto other = recognition_.surface(SX::densify(same_surface).scalar(), plan_.made.contacts[k].name + ".held");
    if (!other) return other.error();
    const SX inverse_mass = SX::mtimes(system_.rows(i, casadi::Slice()), response(i));
    add_to(system_.positions, plan_.numbers.correction * (rate - SX(*other)) * response(i) / inverse_mass);
    return std::nullopt;
  }

  /// A constant force stops the gap's rate v_n, while a depth y falls with it, y' = v_n. Then e^2 of the force takes y
  /// back to 0, where v_n is -e of what it was. So y is quadratic, and exact in schemes of order 2. Positions stand,
  /// so that normal and mass are constants.
  std::optional<Error> take_elastic(std::size_t k) {
    const auto i = static_cast<casadi_int>(k);
    auto& made = plan_.made.contacts[k];
    if (system_.contacts[k].has_friction) {
      auto both = not_frozen(
          fmt::format("the contact '{}' has friction and restitution: time-freezing covers one of both", made.name),
          "simulate with method = \"event\", or leave one of them out");
      return with_context(std::move(both), "in [[contacts]]");
    }
    const SX depth(statement_.states[at(plan_.depth[k])].symbol);
    const auto open = selection(system_.gap(i) + depth, made.name + ".gap", made.gap);
    if (!open) return open.error();
    const double e = plan_.restitution[k];
    SX rate = system_.velocity(i), part = 1.0;
    if (e != 1.0 || plan_.purpose == FrozenFor::simulation) {
      const auto opens = selection(rate, made.name + ".rate", made.normal);
      if (!opens) return opens.error();
      part = 1.0 - (1.0 - e * e) * *opens;
      // NOTE: the rate itself, in a form that names its selection: with e = 1 nothing else does. At rest the gap holds
      // its rate whatever e is.
      rate = 0.5 * rate * *opens + 0.5 * rate * (2.0 - *opens);
    }
    const SX normal = plan_.numbers.a_n * part * (1.0 - *open);
    plan_.moves *= *open;
    plan_.added.push_back({plan_.depth[k], plan_.waits * (1.0 - *open) * rate});
    add_to(system_.velocities, response(i) * normal);
    add_outputs(k, normal, SX(0, 1));
    return std::nullopt;
  }

  /// Forces are those of numerical time: divided by the clock's rate they are forces.
  void add_outputs(std::size_t k, const SX& normal, const SX& tangential) {
    auto& made = plan_.made.contacts[k];
    made.gap_output = static_cast<int>(statement_.outputs.size() + statement_.automatic_outputs.size());
    const auto add = [&](const char* kind, const SX& value, const char* tangent = "") {
      statement_.automatic_outputs.push_back(
          {fmt::format("{}({}){}", kind, made.name, tangent), SX::densify(value).scalar()});
    };
    add("gap", system_.gap(static_cast<casadi_int>(k)));
    add("force", plan_.waits * normal);
    for (int j = 0; j < made.tangents; ++j) {
      add("friction", plan_.waits * tangential(j), made.tangents < 2 ? "" : j == 0 ? "[1]" : "[2]");
    }
    add("impulse", 0.0);
    if (made.impulse < 0) return;
    plan_.added.push_back({made.impulse, plan_.waits * normal});
    for (int j = 0; j < made.tangents; ++j) plan_.added.push_back({made.impulse + 1 + j, plan_.waits * tangential(j)});
  }

  Recognition& recognition_;
  Statement& statement_;
  const ContactSystem& system_;
  FreezingPlan& plan_;
  casadi_int m_;
};

}  // namespace

Expected<SX> freeze_contacts(Recognition& recognition, Statement& statement,
                             const std::vector<ContactStatement>& contacts, const MotionWithoutContacts& motion,
                             FreezingPlan& plan) {
  const auto system = contact_motion(recognition, statement, contacts, motion);
  if (!system) return tl::unexpected(system.error());
  plan.made.velocities = motion.velocities;
  if (auto error = ContactFreezing(recognition, statement, *system, plan).run(contacts)) return tl::unexpected(*error);
  return motion.force;
}

void freeze_rates(Statement& statement, const FreezingPlan& plan) {
  if (plan.plane) return freeze_in_plane(statement, plan);
  const SX rate = plan.waits * plan.moves;
  for (int i = 0; i < plan.made.first_hidden; ++i) {
    auto& dynamics = statement.states[at(i)].dynamics;
    if (dynamics) dynamics = SX(SX(*dynamics) * rate).scalar();
  }
  statement.states[at(plan.made.clock)].dynamics = rate.scalar();
  for (const auto& [state, added] : plan.added) {
    auto& dynamics = statement.states[at(state)].dynamics;
    dynamics = SX::densify(SX(*dynamics) + added).scalar();
  }
  statement.time = plan.numerical_time;
  statement.automatic_outputs.push_back({"clock_rate", rate.scalar()});
}

void find_selections(const System& system, FreezingPlan& plan) {
  const SX alpha = SX::densify(system.alpha);
  for (const auto& [selection, found] : plan.selections) {
    for (casadi_int j = 0; j < alpha.numel(); ++j) {
      const SX one = alpha(j);
      if (!SX::depends_on(SX(selection), one)) continue;
      found->function = static_cast<int>(j);
      found->orientation = SX::is_equal(SX(selection), one, 1) ? 1 : -1;
    }
  }
  plan.made.clock_rate = static_cast<int>(system.output_names.size()) - 1;
}

}  // namespace saltus::model
