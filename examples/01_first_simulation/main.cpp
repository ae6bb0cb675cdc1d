// A mass on a spring, braked by dry friction: where does it come to rest?
#include <cmath>
#include <cstdio>
#include <saltus/model/builder.hpp>
#include <saltus/pipeline/simulate.hpp>

int main() {
  saltus::model::Builder model("brake");
  const auto k = model.parameter("k", 0.4), mu = model.parameter("mu", 2.0);
  const auto x = model.state("x", {0.0}), v = model.state("v", {3.0});
  model.dynamics("x", v);
  model.dynamics("v", -k * x - mu * model.sign(v));

  const auto system = model.build();
  if (!system) return std::puts(saltus::to_text(system.error()).c_str()), 2;
  const auto result =
      saltus::pipeline::simulate(*system, {.until = 6.0, .output = saltus::pipeline::NumberOfPoints{7}});
  if (!result) return std::puts(saltus::to_text(result.error()).c_str()), 2;

  const auto& rows = result->trajectory;  // the points that were asked for, and two at an event: before and behind it
  for (std::size_t i = 0; i < rows.t.size(); ++i) {
    std::printf("t = %.6f  x = %.9f  v = %.9f\n", rows.t[i], rows.x[i][0], rows.x[i][1]);
  }
  for (const auto& event : result->events) {
    std::printf("t = %.9f  %s: %s\n", event.t, saltus::result::name(event.kind).data(), event.reason.c_str());
  }
  std::printf("at rest at x = %.9f\n", result->final.x[0]);

  // Until it stops, x'' = -k (x + mu/k): v vanishes where tan(w t) = v(0) w / mu, w = sqrt(k).
  const double w = std::sqrt(0.4), exact = std::atan(3.0 * w / 2.0) / w;
  std::printf("exact: t = %.9f, x = %.9f\n", exact, std::hypot(5.0, 3.0 / w) - 5.0);
  return result->events.size() == 1 && std::abs(result->events[0].t - exact) < 1e-7 ? 0 : 1;
}
