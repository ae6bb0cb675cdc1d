// Single instants of a model, without a run.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "saltus/event_integrator/instant/resolver.hpp"
#include "saltus/model/builder.hpp"

namespace saltus::event_integrator::testing {

/// Takes what was decided, and notes how often it was asked.
class Client : public ResolverClient {
 public:
  void choose(Transition&) override { ++chosen; }
  [[nodiscard]] bool is_chosen(const Transition&) const override { return false; }
  bool note_switch(const ModeChange&) override { return true; }
  void leave_undecided(const Outcome& outcome) override { undecided = outcome.transition.message; }
  void begin_mode() override { ++begun; }
  [[nodiscard]] double longest_step() const override { return 0.0; }

  int chosen = 0, begun = 0;
  std::string undecided;
};

/// A model at one time, from its start on.
struct Instants {
  explicit Instants(model::Builder& builder, IntegrationOptions asked = {})
      : options(std::move(asked)),
        kernel(*evaluation::ModelKernel::compile(*builder.build())),
        run(kernel, options),
        resolver(run, client) {}

  /// Moves to (t, x) and resolves what is at zero there, by kind and number.
  void meet(double t, std::vector<double> x, const std::vector<std::pair<FunctionKind, int>>& zeros) {
    const Located here = located(t, std::move(x), zeros);
    ASSERT_EQ(here.functions.size(), zeros.size());
    run.here.move_to(t, here.x.data());
    static_cast<void>(resolver.resolve(Instant{.cause = Instant::Cause::zeros, .located = &here}));
  }
  /// Resolves what the last instant has come to once more.
  void again() {
    Instant instant{.cause = Instant::Cause::given};
    instant.transition.state = run.here.state;
    instant.transition.zero_order.assign(run.here.state.mode.size(), 0);
    static_cast<void>(resolver.resolve(instant));
  }
  /// What the stages share, of a cascade that begins here.
  [[nodiscard]] InstantContext context() {
    resolver.cascade().begin();
    return {run, resolver.cascade(), resolver.outcome()};
  }
  /// Returns what is zero at a point, by kind and number, with the signs before.
  [[nodiscard]] Located located(double t, std::vector<double> x,
                                const std::vector<std::pair<FunctionKind, int>>& zeros) const {
    Located found{t, std::move(x), {}, {}};
    for (std::size_t place = 0; place < run.search.functions().size(); ++place) {
      const auto& function = run.search.functions()[place];
      for (const auto& [kind, index] : zeros) {
        if (function.kind != kind || function.index != index) continue;
        found.functions.push_back(place);
        found.signs.push_back(function.sign);
      }
    }
    return found;
  }
  [[nodiscard]] const std::vector<int>& mode() const { return run.here.state.mode; }
  [[nodiscard]] const std::vector<double>& x() const { return run.here.x; }
  [[nodiscard]] long events() const { return run.recorder.events(); }

  const IntegrationOptions options;
  evaluation::ModelKernel kernel;
  RunState run;
  Client client;
  Resolver resolver;
};

}  // namespace saltus::event_integrator::testing
