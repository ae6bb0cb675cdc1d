// Where the variables of a chain of finite elements stand.
#pragma once

#include <string>
#include <vector>

namespace saltus::discretization {

/// Holds consecutive variables of an element: `count` groups of `size`.
struct VariableBlock {
  int first = 0;
  int count = 0;
  int size = 0;

  [[nodiscard]] int end() const { return first + count * size; }
  [[nodiscard]] int at(int group, int component = 0) const { return first + group * size + component; }
};

/// Holds the variables of one element, all elements alike, from the left: h; stages (states or slopes, selections,
/// lifted variables, mu of each simplex); multipliers lambda at the stages and at the right end if that is no stage;
/// state at the right end if that is no stage, or always if the stages are slopes; time at the right end of systems
/// that depend on time; the correction of the right end, positive and negative part.
struct ElementLayout {
  int stages = 0;
  bool has_end_point = false;  ///< the right end is no stage: c_s != 1
  int h = 0;
  VariableBlock stage;       ///< states or slopes, n_x each
  VariableBlock selection;   ///< one group per stage
  VariableBlock lifted;      ///< one group per stage
  VariableBlock lambda;      ///< one group per stage, one for the right end if has_end_point
  VariableBlock simplex;     ///< mu, groups as lambda
  VariableBlock end_state;   ///< 0 or 1 group
  VariableBlock end_time;    ///< 0 or 1 group of 1
  VariableBlock correction;  ///< 0 or 2 groups of one per selection
  int size = 0;              ///< of an element

  /// Returns the number of groups of lambda, the last of which belongs to the right end.
  [[nodiscard]] int points() const { return stages + (has_end_point ? 1 : 0); }
  /// Returns where the state at the right end stands.
  [[nodiscard]] int right_state() const { return end_state.count > 0 ? end_state.first : stage.at(stages - 1); }
};

/// Holds a chain: elements one after the other, then what the boundaries between them need.
struct VariableLayout {
  ElementLayout element;
  int elements = 0;
  int boundary_size = 0;  ///< variables per boundary

  [[nodiscard]] int first_of_element(int n) const { return n * element.size; }
  /// Returns the first variable of the boundary before element n >= 1.
  [[nodiscard]] int first_of_boundary(int n) const { return elements * element.size + (n - 1) * boundary_size; }
  [[nodiscard]] int size() const {
    return elements * element.size + (elements > 1 ? (elements - 1) * boundary_size : 0);
  }
  /// Returns "h[2]", "x[2,1](0)": element, stage and component count from 0.
  [[nodiscard]] std::string name(int variable) const;
};

}  // namespace saltus::discretization
