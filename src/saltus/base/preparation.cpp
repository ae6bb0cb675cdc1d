#include "saltus/base/preparation.hpp"

#include <utility>

namespace saltus {
namespace {

PreparationScope*& current_preparation() {
  thread_local PreparationScope* scope = nullptr;
  return scope;
}

}  // namespace

std::string Preparation::text() const {
  std::string text(phase);
  if (of > 0) text += ": " + std::to_string(done) + " of " + std::to_string(of);
  return text;
}

PreparationScope::PreparationScope(std::function<bool(const Preparation&)> tell)
    : tell_(std::move(tell)),
      stop_([this] { return !tell_(now_); }),
      outer_(std::exchange(current_preparation(), this)) {}

PreparationScope::~PreparationScope() { current_preparation() = outer_; }

void prepares(std::string_view phase, std::size_t done, std::size_t of) {
  if (auto* scope = current_preparation()) scope->now_ = {phase, done, of};
  heed_stop();
}

}  // namespace saltus
