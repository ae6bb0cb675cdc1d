// A problem that counts how often it is evaluated, and lets tests say what pairs belong together; for tests.
#pragma once

#include <functional>
#include <vector>

#include "saltus/mpcc/problem.hpp"

namespace saltus::mpcc {

/// Hands everything on. Refers to the other problem.
class CountingProblem final : public Problem {
 public:
  explicit CountingProblem(Problem& problem) : problem_(problem) {}

  [[nodiscard]] int functions_count() const { return functions_; }
  [[nodiscard]] int jacobian_count() const { return jacobian_; }
  [[nodiscard]] int hessian_count() const { return hessian_; }
  void forget_counts() { functions_ = jacobian_ = hessian_ = 0; }
  /// One number per pair.
  void set_groups(std::vector<int> groups) { groups_ = std::move(groups); }
  void set_closure(std::function<BranchClosure(const std::vector<ActiveSide>&)> closure) {
    closure_ = std::move(closure);
  }

  [[nodiscard]] int variables() const override { return problem_.variables(); }
  [[nodiscard]] int constraints() const override { return problem_.constraints(); }
  [[nodiscard]] int pairs() const override { return problem_.pairs(); }
  [[nodiscard]] const Bounds& variable_bounds() const override { return problem_.variable_bounds(); }
  [[nodiscard]] const Bounds& constraint_bounds() const override { return problem_.constraint_bounds(); }
  [[nodiscard]] const std::vector<Sign>& signs() const override { return problem_.signs(); }
  [[nodiscard]] double objective(ConstVectorView w) override { return problem_.objective(w); }
  void objective_gradient(ConstVectorView w, VectorView gradient) override { problem_.objective_gradient(w, gradient); }
  void functions(ConstVectorView w, VectorView c) override {
    ++functions_;
    problem_.functions(w, c);
  }
  void jacobian(ConstVectorView w, VectorView values) override {
    ++jacobian_;
    problem_.jacobian(w, values);
  }
  void hessian(ConstVectorView w, double objective_factor, ConstVectorView y, VectorView values) override {
    ++hessian_;
    problem_.hessian(w, objective_factor, y, values);
  }
  [[nodiscard]] const Pattern& jacobian_pattern() const override { return problem_.jacobian_pattern(); }
  [[nodiscard]] const Pattern& hessian_pattern() const override { return problem_.hessian_pattern(); }
  [[nodiscard]] int pair_group(int pair) const override {
    return groups_.empty() ? pair : groups_[static_cast<std::size_t>(pair)];
  }
  [[nodiscard]] BranchClosure close_branch(const std::vector<ActiveSide>& sides) const override {
    return closure_ ? closure_(sides) : BranchClosure{};
  }

 private:
  Problem& problem_;
  std::vector<int> groups_;
  std::function<BranchClosure(const std::vector<ActiveSide>&)> closure_;
  int functions_ = 0;
  int jacobian_ = 0;
  int hessian_ = 0;
};

}  // namespace saltus::mpcc
