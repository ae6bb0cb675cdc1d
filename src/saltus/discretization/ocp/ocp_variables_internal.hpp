// Variables, constants and slacks of a problem while its structure is made.
#pragma once

#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "saltus/discretization/ocp/ocp_structure_internal.hpp"

namespace saltus::discretization {

class OcpVariables {
 public:
  explicit OcpVariables(OcpStructure& made) : made_(made), zero_(constant(0.0)) {}

  int constant(double value) {
    constants_.push_back(value);
    return constant_place(static_cast<int>(constants_.size()) - 1);
  }
  [[nodiscard]] int zero() const { return zero_; }
  int variable(double lower, double upper, std::string name) {
    lower_.push_back(lower);
    upper_.push_back(upper);
    made_.names.push_back(std::move(name));
    return next() - 1;
  }
  /// Adds so many more without names, unbounded.
  void add(int count) {
    lower_.resize(lower_.size() + static_cast<std::size_t>(count), -std::numeric_limits<double>::infinity());
    upper_.resize(lower_.size(), std::numeric_limits<double>::infinity());
    made_.names.resize(lower_.size());
  }
  void set_bounds(int variable, double lower, double upper) {
    lower_[static_cast<std::size_t>(variable)] = lower;
    upper_[static_cast<std::size_t>(variable)] = upper;
  }
  [[nodiscard]] int next() const { return static_cast<int>(lower_.size()); }

  /// Returns the variable of the largest violation of each soft constraint, -1 where each point has a slack of its own.
  [[nodiscard]] std::vector<int> largest(const std::vector<model::OcpConstraint>& constraints) {
    std::vector<int> places;
    for (const auto& constraint : constraints) {
      if (constraint.norm == model::ConstraintNorm::hard) continue;
      const bool common = constraint.norm == model::ConstraintNorm::linf;
      places.push_back(common ? slack(constraint, "largest violation") : -1);
    }
    return places;
  }
  /// Returns slacks of the soft constraints at one more point.
  [[nodiscard]] std::vector<int> slacks(const std::vector<model::OcpConstraint>& constraints,
                                        const std::vector<int>& largest_places) {
    std::vector<int> places;
    for (const auto& constraint : constraints) {
      if (constraint.norm == model::ConstraintNorm::hard) continue;
      const int common = largest_places[places.size()];
      places.push_back(common >= 0 ? common : slack(constraint, "violation"));
    }
    return places;
  }

  /// Hands everything to the structure.
  void finish() {
    made_.n_w = next();
    made_.constants = linalg::ConstView(constants_);
    made_.w_bounds = {linalg::ConstView(lower_), linalg::ConstView(upper_)};
  }

 private:
  int slack(const model::OcpConstraint& constraint, const std::string& what) {
    const int v =
        variable(0.0, std::numeric_limits<double>::infinity(), fmt::format("{} of '{}'", what, constraint.name));
    made_.penalties.push_back({v, constraint.penalty, constraint.norm == model::ConstraintNorm::l2});
    return v;
  }

  OcpStructure& made_;
  std::vector<double> constants_, lower_, upper_;
  int zero_;
};

/// Places the functions of the kernel, whose slacks are further variables, and the linear rows.
void place_functions(const model::Ocp& ocp, const std::vector<int>& largest_path,
                     const std::vector<int>& largest_terminal, OcpVariables& variables, OcpStructure& made);

/// Places least squares at times: a copy per time and element of its interval.
void place_measurements(const model::Ocp& ocp, OcpVariables& variables, OcpStructure& made);

/// Numbers rows and pairs once all variables are there: bounds, signs, groups of pairs, the chain.
void number_rows(OcpStructure& made);

}  // namespace saltus::discretization
