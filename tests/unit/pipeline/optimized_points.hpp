// Optimised points written down from exact solutions, for tests of what is done with them.
#pragma once

#include <algorithm>
#include <functional>
#include <initializer_list>

#include <gtest/gtest.h>

#include "saltus/linalg/matrix.hpp"
#include "saltus/pipeline/optimal_control/optimized_run.hpp"

namespace saltus::pipeline {

inline linalg::Vector vector(std::initializer_list<double> values) { return values; }

/// A solution as functions of time.
struct Exact {
  std::function<linalg::Vector(double)> x, selections, lambda;
};

inline discretization::ButcherTableau radau() {
  return *discretization::butcher_tableau(discretization::TableauFamily::radau_iia, 2);
}

inline discretization::SolvedElement element(double t, double h, const Exact& exact) {
  const auto tableau = radau();
  discretization::SolvedElement made;
  made.t = t;
  made.h = h;
  made.end = exact.x(t + h);
  made.states.resize(made.end.size(), 2);
  made.selections.resize(exact.selections(t).size(), 2);
  made.lambda.resize(exact.lambda(t).size(), 3);
  made.lambda.col(0) = exact.lambda(t);
  for (int m = 0; m < 2; ++m) {
    const double time = t + tableau.c[m] * h;
    made.states.col(m) = exact.x(time);
    made.selections.col(m) = exact.selections(time);
    made.lambda.col(m + 1) = exact.lambda(time);
  }
  return made;
}

/// lambda_n and lambda_p.
inline linalg::Vector sides(double psi) { return vector({std::max(-psi, 0.0), std::max(psi, 0.0)}); }

inline OptimizedRun run_of(const model::Ocp& ocp, const discretization::OcpSolution& solution,
                           reformulation::Form form = reformulation::Form::step) {
  const auto run = optimized_run(ocp, solution, {form, 2}, radau());
  EXPECT_TRUE(run.has_value()) << (run ? "" : to_text(run.error()));
  return run ? *run : OptimizedRun{};
}

}  // namespace saltus::pipeline
