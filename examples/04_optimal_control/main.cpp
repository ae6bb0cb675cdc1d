// The best controls inside a program: from rest to rest in least time, and the same again for another distance.
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <saltus/model/builder.hpp>
#include <saltus/model/optimal_control/ocp_builder.hpp>
#include <saltus/pipeline/optimal_control/optimize.hpp>
#include <utility>

namespace model = saltus::model;
namespace pipeline = saltus::pipeline;
namespace result = saltus::result;

template <class T>
T value(saltus::Expected<T> expected) {
  if (expected) return std::move(*expected);
  std::puts(saltus::to_text(expected.error()).c_str());
  std::exit(2);
}

// [problem]
// A car whose turbo makes it three times as strong above a speed of 10.
saltus::Expected<model::Ocp> turbo_car(double distance) {
  model::Builder m("turbo-car");
  const auto q = m.state("q", {0.0}), v = m.state("v", {0.0, -20.0, 20.0}), u = m.control("u", {0.0, -5.0, 5.0});
  m.dynamics("q", v);
  m.dynamics("v", m.if_(model::greater(v, 10), 3, 1) * u);
  model::OcpBuilder problem(std::move(m));
  problem.free_horizon(10, 1, 100);
  problem.minimize_time();
  problem.terminal_constraint("q == distance", distance, q, distance);
  problem.terminal_constraint("v == 0", 0, v, 0);
  return problem.build();
}
int main() {
  pipeline::OptimizeOptions options;
  options.control_intervals = 10;
  auto first = value(pipeline::optimize(value(turbo_car(200)), options));
  const auto& found = *first.optimization;
  std::printf("%s: T = %.4f\n", std::string(name(first.status.termination)).c_str(), found.horizon);
  for (std::size_t k = 0; k < found.u.size(); ++k)
    std::printf("from t = %.4f: u = %.4f\n", found.grid[k], found.u[k][0]);

  // A start that solves a similar problem is taken as a solution: its mode sequence comes first.
  const int cold = found.statistics.iterations;
  options.start_from = std::make_shared<const result::Result>(std::move(first));
  const auto next = value(pipeline::optimize(value(turbo_car(210)), options));
  std::printf("%s: T = %.4f with %d instead of %d iterations\n", std::string(name(next.status.termination)).c_str(),
              next.optimization->horizon, next.optimization->statistics.iterations, cold);
}
// [end]
