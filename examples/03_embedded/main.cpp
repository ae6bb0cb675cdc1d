// A model inside a program: x(t), a file of the result, many runs, threads of its own.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <saltus/base/symbolic_lock.hpp>
#include <saltus/io/json/json_result.hpp>
#include <saltus/model/builder.hpp>
#include <saltus/model/places.hpp>
#include <saltus/pipeline/options/stated_run.hpp>
#include <saltus/pipeline/simulate.hpp>
#include <saltus/pipeline/sweep.hpp>
#include <saltus/result/continuous.hpp>
#include <thread>
#include <vector>

namespace io = saltus::io;
namespace model = saltus::model;
namespace pipeline = saltus::pipeline;

void end_on(const saltus::Error& error) {
  std::puts(saltus::to_text(error).c_str());
  std::exit(2);
}

template <class T>
T value(saltus::Expected<T> expected) {
  if (!expected) end_on(expected.error());
  return std::move(*expected);
}

// A mass on a spring, braked by dry friction.
saltus::Expected<model::System> brake(double mu_value) {
  model::Builder m("brake");
  const auto mu = m.parameter("mu", mu_value), x = m.state("x", {0.0}), v = m.state("v", {3.0});
  m.dynamics("x", v);
  m.dynamics("v", -0.4 * x - mu * m.sign(v));
  return m.build();
}

// [many runs]
// Where it comes to rest, for each mu. What is computed does not depend on the number of threads.
std::vector<double> swept(const model::System& system, const std::vector<double>& mu) {
  const std::size_t place = value(model::parameter_place(system, "mu"));
  const auto state = [&](std::size_t run) -> saltus::Expected<pipeline::StatedRun> {
    pipeline::StatedRun stated{system, {.until = 30.0}};
    stated.system.parameter_values[place] = mu[run];
    return stated;
  };
  const auto outcome = value(pipeline::sweep({.runs = mu.size(), .jobs = 2}, state));
  std::vector<double> rest;
  for (const auto& run : outcome.runs) rest.push_back(run.result.final.x[0]);
  return rest;
}
// [own threads]
// The same in threads that the program has anyway: they share compiled functions, and each has its own system.
std::vector<double> in_threads(const model::System& system, const std::vector<double>& mu) {
  pipeline::KernelStore kernels;
  std::vector<double> rest(mu.size(), std::nan(""));
  const std::size_t place = value(model::parameter_place(system, "mu"));
  const auto work = [&](std::size_t begin, std::size_t end) {
    std::optional<model::System> own;
    {
      const saltus::SymbolicLock lock;  // expressions are copied, and dropped, by one thread at a time
      own = system;
    }
    for (std::size_t run = begin; run < end; ++run) {
      own->parameter_values[place] = mu[run];
      if (const auto result = pipeline::simulate(*own, {.until = 30.0}, {}, &kernels)) rest[run] = result->final.x[0];
    }
    const saltus::SymbolicLock lock;
    own.reset();
  };
  const std::size_t half = mu.size() / 2;
  std::thread first(work, 0, half), second(work, half, mu.size());
  first.join();
  second.join();
  return rest;
}
// [end]

int main() {
  const auto system = value(brake(2));
  // [x of t]
  const pipeline::SimulateOptions options{.until = 6.0, .continuous = true};
  const auto result = value(pipeline::simulate(system, options));
  const auto at = value(result.continuous->at({0.5, 1.0, 2.0}));
  for (std::size_t i = 0; i < at.t.size(); ++i) std::printf("x(%g) = %.9f\n", at.t[i], at.x[i][0]);
  const auto written = io::stream_file("brake.json", [&](io::Sink sink) { return io::write_json(result, sink); });
  if (!written) end_on(written.error());
  const auto stored = value(io::read_result("brake.json"));  // or in memory: io::to_json, io::parse_result
  // [done]
  std::printf("stored: %zu rows, %zu events, the same end: %s\n", stored.trajectory.t.size(), stored.events.size(),
              stored.final.x[0] == result.final.x[0] ? "yes" : "no");

  std::vector<double> mu;
  for (int i = 1; i <= 20; ++i) mu.push_back(0.2 * i);
  const auto rest = swept(system, mu);
  std::printf("at rest between %.6f and %.6f, the same in threads: %s\n", *std::min_element(rest.begin(), rest.end()),
              *std::max_element(rest.begin(), rest.end()), rest == in_threads(system, mu) ? "yes" : "no");

  // Without friction nothing jumps: a system that was built for it cannot be given some.
  auto frictionless = value(brake(0));
  frictionless.parameter_values[value(model::parameter_place(frictionless, "mu"))] = 2;
  if (const auto refused = pipeline::simulate(frictionless, options); !refused) {
    std::puts(saltus::to_text(refused.error()).c_str());
  }
}
