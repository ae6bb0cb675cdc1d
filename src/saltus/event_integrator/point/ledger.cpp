#include "saltus/event_integrator/point/ledger.hpp"

namespace saltus::event_integrator {

Ledger::Ledger(const evaluation::ModelKernel& kernel)
    : first_user_(kernel.switching_functions()),
      signs_(at(kernel.event_functions() - first_user_ - 2 * kernel.cells()), 0),
      orders_(at(kernel.event_functions()), 0) {}

void Ledger::forget_zeros() {
  for (const int function : zeros_) orders_[at(function)] = 0;
  zeros_.clear();
}

void Ledger::add(int function, int order) {
  if (!has(function)) zeros_.push_back(function);
  orders_[at(function)] = order;
}

}  // namespace saltus::event_integrator
