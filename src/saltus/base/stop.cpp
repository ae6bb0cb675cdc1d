#include "saltus/base/stop.hpp"

#include <utility>

namespace saltus {
namespace {

StopScope*& current() {
  thread_local StopScope* scope = nullptr;
  return scope;
}

}  // namespace

StopScope::StopScope(std::function<bool()> is_wanted, Clock::duration pause)
    : is_wanted_(std::move(is_wanted)), pause_(pause), outer_(std::exchange(current(), this)) {}

StopScope::~StopScope() { current() = outer_; }

void heed_stop() {
  StopScope* scope = current();
  if (scope == nullptr || !scope->is_wanted_) return;
  const auto now = StopScope::Clock::now();
  if (now - scope->asked_ < scope->pause_) return;
  scope->asked_ = now;
  if (scope->is_wanted_()) throw Stopped();
}

}  // namespace saltus
