// Contacts of a kernel: their values, activities, and forces that are numbers.
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <tuple>
#include <vector>

#include "saltus/base/at.hpp"
#include "saltus/evaluation/contact_functions.hpp"
#include "saltus/evaluation/kernel_internal.hpp"
#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/model/system.hpp"

namespace saltus::evaluation {

using casadi::SX;

/// Guards of contacts are numbers of order 1, in the units of their modes; a gap is a length.
SX CompiledModel::sizes_of_contact_guards(const model::System& system) const {
  SX sizes = SX::zeros(phi.numel(), 1);
  const auto& [contacts, activities] = std::tie(system.contacts.contacts, system.contacts.activities);
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const auto guards = static_cast<int>(system.jumps[at(contacts[i].jump)].guards.numel());
    const SX closed = activities(model::Activity::closed, static_cast<casadi_int>(i));
    for (int g = 0; g < guards; ++g) {
      sizes(functions.jumps.guard(contacts[i].jump, g)) = contacts[i].has_gap && g == 0 ? closed : SX(1.0);
    }
  }
  return sizes;
}

/// For what depends on what: forces that are numbers depend on all that their equations read.
SX CompiledModel::with_what_forces_read(const SX& expression, const model::System& system) const {
  if (forces.is_empty()) return expression;
  const auto& touching = system.contacts;
  const SX equations = SX::vertcat({SX::vec(touching.rows), SX::vec(touching.responses), touching.acceleration,
                                    touching.cone, SX::vec(touching.activities)});
  SX read = 0.0;
  for (const SX& symbol : SX::symvar(equations)) read += symbol;
  const SX all = SX::substitute(expression, forces, SX::repmat(read, forces.numel(), 1));
  return system.u.numel() == 0 ? all : SX::substitute(all, system.u, input);
}

void CompiledModel::compile_contacts(const model::System& system) {
  const auto& touching = system.contacts;
  const std::vector<SX> arguments{t, x, p, alpha};
  contact_sizes = {touching.gap.numel(), touching.rows.size1(), touching.rows.size2()};
  const SX acceleration =
      system.u.numel() == 0 ? touching.acceleration : SX::substitute(touching.acceleration, system.u, input);
  functions.contact_function = ModelFunction("saltus_contacts", arguments,
                                             {touching.gap, touching.velocity, touching.rows, touching.responses,
                                              acceleration, touching.friction, touching.restitution});
  if (!forces.is_empty()) functions.contact_solve = ContactSolve(touching, acceleration, symbols(), phi);
}

void ModelKernel::contacts(double t, const double* x, const double* alpha, ContactValues& values) const {
  auto& self = *implementation_;
  const auto& [m, r, n] = self.compiled->contact_sizes;
  values.gap.resize(m);
  values.velocity.resize(r);
  values.rows.resize(r, n);
  values.responses.resize(n, r);
  values.acceleration.resize(r);
  values.friction.resize(m);
  values.restitution.resize(m);
  self.contact_function(
      std::array<const double*, 4>{&t, x, self.parameters.data(), alpha},
      std::array<double*, 7>{values.gap.data(), values.velocity.data(), values.rows.data(), values.responses.data(),
                             values.acceleration.data(), values.friction.data(), values.restitution.data()});
}

const std::vector<model::Activity>& ModelKernel::activities() const { return implementation_->activities; }

void ModelKernel::set_activity(int contact, const model::Activity& activity) {
  auto& self = *implementation_;
  self.KernelValues::set_activity(self.compiled->first_activity, at(contact), activity);
  self.constant_gradients.reset();
}

void ModelKernel::set_activities(const std::vector<model::Activity>& activities) {
  for (std::size_t i = 0; i < activities.size(); ++i) set_activity(static_cast<int>(i), activities[i]);
}

PointArguments ModelKernel::Implementation::point(const double* t, const double* x, const double* alpha) const {
  return {{{t, 1}, {x, at(compiled->x.numel())}, parameters, {alpha, at(compiled->n_psi)}}};
}

const double* ModelKernel::Implementation::with_forces(double t, const double* x, const double* alpha) {
  const double* const end = parameters_at(t, x, alpha) + parameters.size();
  moving.assign(x, x + compiled->x.numel());
  moving.insert(moving.end(), end - contact_solve.forces(), end);
  return moving.data();
}

/// Of event functions that forces move, at the last scales: their gradients are those of the forces.
void ModelKernel::Implementation::scale_forces(double t, const double* x, const double* alpha) {
  std::vector<double> row(at(compiled->x.numel()));
  for (std::size_t j = 0; j < last_scales.slope.size(); ++j) {
    if (!contact_solve.moves(static_cast<int>(j))) continue;
    double rate = 0.0, size = 1.0, sum = 0.0;  // a guard of a contact is a number of order 1
    gradient_at(static_cast<int>(j), t, x, alpha, row.data(), &rate);
    size += std::abs(rate * t);
    for (std::size_t i = 0; i < row.size(); ++i) {
      size += std::abs(row[i] * x[i]);
      sum += std::abs(row[i]);
    }
    last_scales.magnitude[j] = size;
    last_scales.slope[j] = sum;
  }
}

/// Of what forces turn: there is no expression to differentiate. Beyond the rate, central differences of it.
double ModelKernel::turned_by_forces(int function, int order, double t, const double* x, const double* alpha) const {
  auto& self = *implementation_;
  const auto n = at(states());
  std::vector<double> slope(n), along(n), row(n), there(x, x + n);
  field(t, x, alpha, slope.data());
  const double size = linalg::ConstView(there).norm(), speed = linalg::ConstView(slope).norm();
  constexpr double part = 1e-5;  // the third root of the rounding
  const double h = speed > 0.0 && size > 0.0 ? part * size / speed : part;
  const auto rate_at = [&](double time) {
    for (std::size_t i = 0; i < n; ++i) there[i] = x[i] + time * slope[i];
    field(t + time, there.data(), alpha, along.data());
    double rate = 0.0;
    self.gradient_at(function, t + time, there.data(), alpha, row.data(), &rate);
    return std::inner_product(row.begin(), row.end(), along.begin(), rate);
  };
  const int differences = order - 1;
  double sum = 0.0, weight = 1.0;
  for (int k = 0; k <= differences; ++k) {
    sum += weight * rate_at((0.5 * differences - k) * h);
    weight *= -static_cast<double>(differences - k) / (k + 1);
  }
  return sum / std::pow(h, differences);
}

}  // namespace saltus::evaluation
