// Where the variables, rows and constants of an optimal control problem stand.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "saltus/discretization/ocp/ocp_kernel_internal.hpp"
#include "saltus/discretization/placed_function_internal.hpp"
#include "saltus/linalg/matrix.hpp"
#include "saltus/mpcc/chain.hpp"

namespace saltus::discretization {

/// Says which part of the objective a function belongs to.
enum class Term { none, running, terminal, least_squares, method };

/// Holds copies of one function of the kernel, each with where it belongs.
struct Placed {
  struct Copy {
    int interval = 0, element = 0;  ///< numbers over the whole problem; -1: none
    int first_row = 0;              ///< of g
    int first_pair = 0;
  };
  LocalFunction* function = nullptr;
  std::string what;  ///< for names of rows
  Term term = Term::none;
  const std::vector<ConstraintRow>* bounds = nullptr;  ///< null: equations
  bool is_dormant = false;                             ///< rows that only a branch problem may make equations
  bool of_method = false;                              ///< rows and pairs that steer relaxed problems only
  std::vector<std::vector<int>> places;
  std::vector<Copy> copies;
  std::unique_ptr<PlacedFunction> placed{};
};

/// States sum coefficient w_variable = right-hand side.
struct LinearRow {
  std::vector<std::pair<int, double>> entries;
  double value = 0.0;
  std::string name;
};

/// Holds a slack of a soft constraint: factor v or factor v^2 in the objective.
struct Penalty {
  int variable = 0;
  double factor = 0.0;
  bool squared = false;
};

/// Holds one element: its variables but the length stand together.
struct OcpElement {
  int interval = 0;
  int number = 0;         ///< within the interval
  int length = 0;         ///< place of hhat: a variable or a constant
  int first = 0;          ///< variable of local variable 1 is `first`
  std::vector<int> left;  ///< places of left state, left time, left lambda
  [[nodiscard]] int variable(int local) const { return first + local - 1; }
};

struct OcpStart {
  std::vector<int> state, lambda;  ///< places
  std::vector<int> own;            ///< mu and theta of the start: variables
};

/// Holds a time of measurements: constants of the elements of its interval are 1 for the one that holds it, else 0.
struct Measurement {
  double share = 0.0;      ///< of the interval, in [0, 1]
  std::vector<int> holds;  ///< numbers of the constants, one per element
};

struct OcpInterval {
  std::vector<int> shared;         ///< places, SharedSizes
  std::vector<int> shared_at_end;  ///< the same with what is held as it is at the time itself of its end
  int first_element = 0, elements = 0;
  mpcc::IndexRange own;      ///< variables shared by its elements
  std::vector<int> lengths;  ///< variables hhat; empty for one element or fixed lengths
  int t_left = 0;            ///< place of the time at its left end, if time matters
  std::vector<Measurement> measurements;
};

/// Holds the whole problem without its functions' values.
struct OcpStructure {
  std::shared_ptr<OcpKernel> owner;
  OcpKernel::Implementation& kernel;
  int intervals = 0;
  std::vector<OcpInterval> interval;
  std::vector<OcpElement> element;
  int horizon = 0;              ///< place of T
  std::vector<int> parameters;  ///< variables of the free ones
  OcpStart start;
  std::vector<int> boundary_own;  ///< variables of step equilibration
  std::vector<Placed> functions;
  std::vector<LinearRow> linear;
  std::vector<Penalty> penalties;
  int first_linear_row = 0;
  int n_w = 0, n_g = 0, n_pairs = 0;
  mpcc::Bounds w_bounds, g_bounds;
  std::vector<mpcc::Sign> signs;
  std::vector<int> pair_group;
  linalg::Vector constants, local_parameters;
  mpcc::Chain chain;
  double from = 0.0;
  std::vector<std::string> names;  ///< of variables

  explicit OcpStructure(std::shared_ptr<OcpKernel> kernel_owner)
      : owner(std::move(kernel_owner)), kernel(owner->parts()) {}
  /// Returns the place of a boundary's left lambda: right end of the element before, or the start.
  [[nodiscard]] std::vector<int> left_lambda(int element_number) const;
  [[nodiscard]] std::vector<int> element_places(int element_number) const;
  [[nodiscard]] std::vector<int> end_places(int element_number) const;  ///< t, x, selections of its last stage
};

/// Returns multipliers of all pairs: lambda_p = max(psi, 0), lambda_n = -min(psi, 0); lambda_i = g_i - min g
/// [nurkanovic2024] eq. (17).
[[nodiscard]] linalg::Vector multipliers_of(const OcpKernel::Implementation& kernel, linalg::Vector psi);

/// Returns variables of the state at the right end of an element.
[[nodiscard]] std::vector<int> right_state(const OcpStructure& made, const OcpElement& element);

[[nodiscard]] Expected<std::unique_ptr<OcpStructure>> ocp_structure(std::shared_ptr<OcpKernel> kernel,
                                                                    const model::Ocp& ocp,
                                                                    const reformulation::Dcs& dcs,
                                                                    const std::vector<int>& elements);

/// Finds the elements that hold the measurements, by the lengths of w.
void find_measurements(OcpStructure& made, mpcc::ConstVectorView w);

/// Holds values of Dcs::held, a row per interval.
struct HeldInIntervals {
  linalg::Matrix inside;
  linalg::Matrix at_end;  ///< at the time itself at which the interval ends
};
/// Returns them, or an error where one on which the problem depends changes inside an interval, or with a control or a
/// free parameter.
[[nodiscard]] Expected<HeldInIntervals> held_in_intervals(const model::Ocp& ocp, const reformulation::Dcs& dcs,
                                                          const casadi::Function& arguments, int intervals);

}  // namespace saltus::discretization
