#include "saltus/ode/explicit/explicit_pairs_internal.hpp"

namespace saltus::ode {

const ExplicitMethod& dopri5_for_any() { return ExplicitKernel<Dopri5, AnySize>::method; }
const ExplicitMethod& dop853_for_any() { return ExplicitKernel<Dop853, AnySize>::method; }

}  // namespace saltus::ode
