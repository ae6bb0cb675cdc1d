#include "saltus/evaluation/explanations.hpp"

#include "saltus/base/symbolic_lock.hpp"
#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/model/decisions.hpp"
#include "saltus/model/vanishing_norm.hpp"

namespace saltus::evaluation {

std::string vanishing_norm(const ModelKernel& kernel, double t, const std::vector<double>& x) {
  const SymbolicLock lock;
  return model::vanishing_norm(kernel.stated(), t, x);
}

std::optional<std::string> find_indefinite_mass(const ModelKernel& kernel, const std::vector<double>& x) {
  return model::find_indefinite_mass(kernel.stated(), x);
}

}  // namespace saltus::evaluation
