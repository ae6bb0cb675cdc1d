#include <string>

#include "saltus/base/at.hpp"
#include "saltus/model/recognition/reduction_internal.hpp"
#include "saltus/model/statement/quantities_internal.hpp"

namespace saltus::model {
namespace {

class Mixture {
 public:
  Mixture(SxGraph& graph, const std::set<int>& sliding) : graph_(graph), sliding_(sliding) {}

  std::optional<Error> put(casadi::SX& expressions, const std::string& what) {
    for (SXElem& e : expressions.nonzeros()) {
      const auto node = graph_.add(e);
      if (!node) continue;  // a value of a jump with comparisons, which have one truth at an instant
      const auto mixture = interpolate(graph_, *node, sliding_, what);
      if (!mixture) return mixture.error();
      e = *mixture;
    }
    return std::nullopt;
  }

 private:
  SxGraph& graph_;
  const std::set<int>& sliding_;
};

}  // namespace

std::optional<Error> interpolate_quantities(SxGraph& graph, const std::set<int>& sliding, System& system) {
  if (system.inclusion == Inclusion::aizerman_pyatnitskii) return std::nullopt;
  Mixture mixture(graph, sliding);
  if (auto error = mixture.put(system.outputs, "the outputs")) return error;
  for (auto& event : system.events) {
    // The value of a condition is over the truths of its comparisons.
    auto& functions = event.guards.numel() > 0 ? event.guards : event.value;
    if (auto error = mixture.put(functions, "the event " + event.name)) return error;
  }
  for (auto& jump : system.jumps) {
    for (auto* expressions : {&jump.guards, &jump.values, &jump.priority, &jump.delay}) {
      if (auto error = mixture.put(*expressions, "the jump " + jump.name)) return error;
    }
  }
  return std::nullopt;
}

}  // namespace saltus::model
