#include "saltus/foreign/problem.hpp"

#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/base/contracts.hpp"
#include "saltus/foreign/functions_internal.hpp"

namespace saltus::foreign {

Problem::Problem(std::unique_ptr<Implementation> implementation) : implementation_(std::move(implementation)) {}
Problem::~Problem() = default;

int Problem::variables() const { return static_cast<int>(implementation_->statement.symbols.size()); }
int Problem::constraints() const { return static_cast<int>(implementation_->statement.rows.size()); }
int Problem::pairs() const { return static_cast<int>(implementation_->statement.pairs.size()); }
const mpcc::Bounds& Problem::variable_bounds() const { return implementation_->variable_bounds; }
const mpcc::Bounds& Problem::constraint_bounds() const { return implementation_->constraint_bounds; }
const mpcc::Bounds& Problem::row_ranges() const { return implementation_->row_ranges; }
const std::vector<mpcc::Sign>& Problem::signs() const { return implementation_->signs; }
const mpcc::Pattern& Problem::jacobian_pattern() const { return implementation_->jacobian_pattern; }
const mpcc::Pattern& Problem::hessian_pattern() const { return implementation_->hessian_pattern; }

double Problem::objective(mpcc::ConstVectorView w) {
  implementation_->values.at(w);
  return implementation_->values.first()[0];
}

void Problem::functions(mpcc::ConstVectorView w, mpcc::VectorView c) {
  implementation_->values.at(w);
  c = implementation_->values.second();
}

void Problem::objective_gradient(mpcc::ConstVectorView w, mpcc::VectorView gradient) {
  implementation_->derivatives.at(w);
  gradient = implementation_->derivatives.first();
}

void Problem::jacobian(mpcc::ConstVectorView w, mpcc::VectorView values) {
  implementation_->derivatives.at(w);
  values = implementation_->derivatives.second();
}

void Problem::hessian(mpcc::ConstVectorView w, double objective_factor, mpcc::ConstVectorView y,
                      mpcc::VectorView values) {
  SALTUS_ASSERT(w.is_contiguous() && y.is_contiguous() && values.is_contiguous());
  implementation_->hessian(std::array<const double*, 3>{w.data(), &objective_factor, y.data()},
                           std::array<double*, 1>{values.data()});
}

linalg::Vector Problem::start() const {
  const auto& start = implementation_->statement.start;
  return completed(linalg::ConstView(start.data(), file_variables()));
}

linalg::Vector Problem::completed(mpcc::ConstVectorView x) const {
  auto& all = *implementation_;
  linalg::Vector w = linalg::Vector::zero(variables());
  w.head(file_variables()) = x;
  w = w.at_least(all.variable_bounds.lower).at_most(all.variable_bounds.upper);
  const auto& splits = all.statement.splits;
  if (splits.empty()) return w;
  linalg::Vector bodies(index(splits.size()));
  all.bodies(std::array<const double*, 1>{w.data()}, std::array<double*, 1>{bodies.data()});
  for (std::size_t i = 0; i < splits.size(); ++i) {
    const double body = bodies[index(i)];
    if (!std::isfinite(body)) continue;
    w[splits[i].plus] = std::max(body, 0.0);
    w[splits[i].plus + 1] = std::max(-body, 0.0);
  }
  return w;
}

std::string Problem::name(int variable) const {
  const auto& names = file_names();
  if (at(variable) < names.size()) return names[at(variable)];
  return variable < file_variables() ? fmt::format("x[{}]", variable)
                                     : implementation_->statement.symbols[at(variable)].name();
}

std::string Problem::row_name(int row) const {
  const auto& statement = implementation_->statement;
  const bool of_g = row < constraints();
  const auto pair = at((row - constraints()) % std::max(pairs(), 1));
  const auto& name = of_g ? statement.rows[at(row)].name : statement.pairs[pair].name;
  if (name.empty()) return mpcc::Problem::row_name(row);
  return of_g ? name : fmt::format("{} ({})", name, row < constraints() + pairs() ? "G" : "H");
}

int Problem::file_variables() const { return implementation_->statement.file_variables; }
const std::vector<std::string>& Problem::file_names() const { return implementation_->statement.names; }
const std::vector<std::string>& Problem::notes() const { return implementation_->statement.notes; }

double Problem::in_sense_of_file(double objective) const {
  return implementation_->statement.sense == Sense::maximize ? -objective : objective;
}

}  // namespace saltus::foreign
