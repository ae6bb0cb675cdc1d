// Models for tests in a few lines: tables of name and text, with the positions a file would give.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include <casadi/core/function.hpp>
#include <gtest/gtest.h>

#include "saltus/expression/parser.hpp"
#include "saltus/model/build.hpp"

namespace saltus::model {

using Entry = std::pair<std::string, std::string>;
using Table = std::vector<Entry>;

/// Every entry stands on a line of its own, the name in column 1, the expression in column 21.
struct ModelText {
  Table parameters{}, states{}, controls{}, definitions{}, switching{}, dynamics{}, outputs{};
  std::vector<Entry> events{};  ///< name (may be empty) and `when`
  Table inputs{};
  Inclusion inclusion = Inclusion::filippov;
};

inline expression::NodePtr parsed(const std::string& text, const SourceLocation& location) {
  auto node = expression::parse(text, location);
  EXPECT_TRUE(node.has_value()) << text << ": " << (node ? "" : to_text(node.error()));
  return node ? *node : expression::number(0.0, location);
}

class Lines {
 public:
  std::vector<NamedExpression> table(const Table& entries) {
    std::vector<NamedExpression> result;
    for (const auto& [name, text] : entries) {
      const SourceLocation place = next();
      result.push_back({name, parsed(text, {place.file, place.line, 21}), place});
    }
    return result;
  }
  SourceLocation next() { return {"model.toml", ++line_, 1}; }

 private:
  int line_ = 0;
};

inline Description describe(const ModelText& text) {
  Lines lines;
  Description description;
  description.file = "model.toml";
  description.name = "test";
  description.inclusion = text.inclusion;
  description.parameters = lines.table(text.parameters);
  for (const auto& [name, initial, location] : lines.table(text.states)) {
    description.states.push_back({name, initial, nullptr, nullptr, location});
  }
  for (const auto& [name, initial, location] : lines.table(text.controls)) {
    description.controls.push_back({name, initial, nullptr, nullptr, location});
  }
  description.definitions = lines.table(text.definitions);
  description.switching = lines.table(text.switching);
  description.dynamics = lines.table(text.dynamics);
  description.outputs = lines.table(text.outputs);
  for (const auto& [name, when, location] : lines.table(text.events)) {
    UserEventDescription event;
    if (!name.empty()) event.name = name;
    event.when = when;
    event.location = location;
    description.events.push_back(event);
  }
  description.inputs = lines.table(text.inputs);
  return description;
}

inline System built(const ModelText& text, const std::vector<Override>& overrides = {}) {
  auto system = build(describe(text), overrides);
  EXPECT_TRUE(system.has_value()) << (system ? "" : to_text(system.error()));
  return system ? *system : System{};
}

inline Error refused(const ModelText& text, const std::vector<Override>& overrides = {}) {
  auto system = build(describe(text), overrides);
  EXPECT_FALSE(system.has_value()) << "the model was accepted";
  return system ? Error{} : system.error();
}

inline Override set(const std::string& name, const std::string& value) { return {name, parsed(value, {})}; }

/// Values of a column of expressions at a point.
inline std::vector<double> values(const System& system, const casadi::SX& expression, const std::vector<double>& x,
                                  const std::vector<double>& alpha, double t = 0.0, std::vector<double> u = {}) {
  if (u.empty()) u = system.control_initial;
  const casadi::Function f("f", {system.t, system.x, system.u, system.p, system.alpha}, {expression});
  const auto result = f(std::vector<casadi::DM>{t, x, u, system.parameter_values, alpha});
  return std::vector<double>(result.front());
}

inline double value(const System& system, const casadi::SX& expression, const std::vector<double>& x,
                    const std::vector<double>& alpha, double t = 0.0) {
  return values(system, expression, x, alpha, t).at(0);
}

/// Alphas by the signs of their psi (1/2 on a surface): the right-hand side as it is off the surfaces.
inline std::vector<double> alphas_at(const System& system, const std::vector<double>& x, double t = 0.0) {
  std::vector<double> alpha(system.switching.size(), 0.5);
  for (std::size_t j = 0; j < alpha.size(); ++j) {
    const double psi = value(system, system.switching[j].psi, x, alpha, t);
    alpha[j] = psi > 0.0 ? 1.0 : (psi < 0.0 ? 0.0 : 0.5);
  }
  return alpha;
}

inline std::vector<double> f_at(const System& system, const std::vector<double>& x, double t = 0.0) {
  return values(system, system.f, x, alphas_at(system, x, t), t);
}

/// Names of the columns of the result.
inline std::vector<std::string> columns(const System& system) {
  std::vector<std::string> names;
  for (const auto& column : system.columns) names.push_back(column.name);
  return names;
}

using Names = std::vector<std::string>;

}  // namespace saltus::model
