// x' = -sign(x), x(0) = 1: reaches 0 at t = 1 and stays there.
#include <saltus/model/builder.hpp>
#include <saltus/pipeline/simulate.hpp>

int main() {
  saltus::model::Builder model("sliding");
  model.dynamics("x", -model.sign(model.state("x", {1.0})));
  const auto result = saltus::pipeline::simulate(model.build().value(), {.until = 2.0});
  return result && result->events.size() == 1 && result->final.x.front() == 0.0 ? 0 : 1;
}
