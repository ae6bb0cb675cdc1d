// What a foreign file states, as expressions: what all readers leave and `Problem` is made of.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include <casadi/core/function.hpp>
#include <casadi/core/sx.hpp>

namespace saltus::foreign {

inline constexpr double infinity = std::numeric_limits<double>::infinity();

enum class Sense { minimize, maximize };

/// Holds a row lower <= expression <= upper.
struct Row {
  casadi::SX expression;
  double lower = -infinity;
  double upper = infinity;
  std::string name;  ///< may be empty, and so below
};

/// States 0 <= G _|_ H >= 0.
struct Pair {
  casadi::SX G;
  casadi::SX H;
  std::string name;
};

/// States body = plus - minus with two variables behind those of the file, both >= 0.
struct Split {
  casadi::SX body;
  int plus = 0;
};

struct Statement {
  std::vector<casadi::SX> symbols;  ///< scalars: the variables of the file, then those of splits
  std::vector<double> lower, upper, start;
  int file_variables = 0;
  std::vector<std::string> names;  ///< of the file's variables; empty if the file has none
  casadi::SX objective = 0.0;
  Sense sense = Sense::minimize;
  std::vector<Row> rows;
  std::vector<Pair> pairs;
  std::vector<Split> splits;
  std::vector<std::string> notes;  ///< what a person should know of how the file was read
};

/// Adds a mixed complementarity: lower <= side <= upper, both finite, and body >= 0 where the side is at lower, <= 0
/// where it is at upper, else 0. Becomes body = p - n with (side - lower) _|_ p and (upper - side) _|_ n.
void add_box(Statement& statement, const casadi::SX& side, double lower, double upper, const casadi::SX& body,
             const std::string& name);

}  // namespace saltus::foreign
