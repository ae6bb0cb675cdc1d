// Contacts of a kernel: their values, activities, and forces that are numbers.
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <tuple>
#include <vector>

#include "saltus/base/at.hpp"
#include "saltus/base/rounding_unit.hpp"
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

namespace {

/// The rate, or central differences over h along the field of the derivative of one order less.
double derivative_along(const ModelKernel& kernel, int function, int order, double h, double t,
                        const std::vector<double>& x, const double* alpha) {
  std::vector<double> slope(x.size()), there(x);
  kernel.field(t, x.data(), alpha, slope.data());
  if (order == 1) {
    double rate = 0.0;
    kernel.gradient(function, t, x.data(), alpha, there.data(), &rate);
    return std::inner_product(there.begin(), there.end(), slope.begin(), rate);
  }
  const auto at_time = [&](double time) {
    for (std::size_t i = 0; i < x.size(); ++i) there[i] = x[i] + time * slope[i];
    return derivative_along(kernel, function, order - 1, h, t + time, there, alpha);
  };
  return (at_time(h) - at_time(-h)) / (2.0 * h);
}

}  // namespace

/// Of a function that forces move: there is no expression of their rates.
double ModelKernel::derivative_by_differences(int function, int order, double t, const double* x,
                                              const double* alpha) const {
  const std::vector<double> here(x, x + states());
  std::vector<double> slope(here.size());
  field(t, x, alpha, slope.data());
  const double size = linalg::ConstView(here).norm(), speed = linalg::ConstView(slope).norm();
  // Where the error of the differences and their rounding are equally large; at rest no time says how fast it changes.
  const double part = std::pow(rounding_unit, 1.0 / (order + 1));
  const double most = std::max(1.0, std::abs(t));
  const double h = part * (speed * most > size && size > 0.0 ? size / speed : most);
  return derivative_along(*this, function, order, h, t, here, alpha);
}

}  // namespace saltus::evaluation
