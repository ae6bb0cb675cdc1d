// Compiled without vector instructions but those of lanes_internal.hpp. f writes one component after the other, and
// reading two of them at once has to wait until both are in the cache. That takes longer than a stage does otherwise
// (dopri5, 3 states: 120 instead of 70 ns a step).
#include <array>
#include <type_traits>
#include <utility>

#include "saltus/ode/explicit/explicit_pairs_internal.hpp"

namespace saltus::ode {
namespace {

template <class Method, std::size_t... less>
const ExplicitMethod& method_for(std::size_t n, std::index_sequence<less...>) {
  static constexpr std::array<const ExplicitMethod*, sizeof...(less)> methods{
      &ExplicitKernel<Method, std::integral_constant<std::size_t, less + 1>>::method...};
  return *methods[n - 1];
}

}  // namespace

const ExplicitMethod& dopri5_for_few(std::size_t n) {
  return method_for<Dopri5>(n, std::make_index_sequence<few_states>{});
}

const ExplicitMethod& dop853_for_few(std::size_t n) {
  return method_for<Dop853>(n, std::make_index_sequence<few_states>{});
}

}  // namespace saltus::ode
