#include <algorithm>
#include <optional>
#include <utility>

#include "saltus/base/symbolic_lock.hpp"
#include "saltus/model/structure.hpp"
#include "saltus/pipeline/simulate.hpp"

namespace saltus::pipeline {

Expected<KernelStore::Kept> KernelStore::take(const model::System& system, evaluation::NativeCode native) {
  std::vector<std::uint64_t> structure;
  {
    const SymbolicLock lock;
    structure = model::structure(system);
  }
  const auto find = [&]() -> std::optional<Kept> {
    const std::lock_guard guard(mutex_);
    const auto fits = [&](const Kept& kept) { return kept.native == native && kept.structure == structure; };
    const auto found = std::find_if(waiting_.begin(), waiting_.end(), fits);
    if (found == waiting_.end()) return std::nullopt;
    std::optional<Kept> taken(std::move(*found));
    *found = std::move(waiting_.back());
    waiting_.pop_back();
    return taken;
  };
  if (auto found = find(); found && found->kernel.set_parameters(system.parameter_values)) return std::move(*found);
  auto kernel = evaluation::ModelKernel::compile(system, native);
  if (!kernel) return tl::unexpected(kernel.error());
  return Kept{std::move(structure), native, std::move(*kernel)};
}

void KernelStore::give_back(Kept kept) {
  // What it is changed for is dropped when the mutex is free: that takes the symbolic lock.
  const std::lock_guard guard(mutex_);
  if (waiting_.size() < most_kept) {
    waiting_.push_back(std::move(kept));
  } else {
    std::swap(waiting_[next_++ % most_kept], kept);
  }
}

}  // namespace saltus::pipeline
