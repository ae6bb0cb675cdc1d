#include <algorithm>
#include <memory>
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
  const auto fits = [&](const auto& known) { return known.native == native && known.structure == structure; };
  std::optional<Kept> found;
  std::shared_ptr<evaluation::CompiledModel> compiled;
  {
    const std::lock_guard guard(mutex_);
    if (const auto kept = std::find_if(waiting_.begin(), waiting_.end(), fits); kept != waiting_.end()) {
      found = std::move(*kept);
      *kept = std::move(waiting_.back());
      waiting_.pop_back();
    } else if (const auto known = std::find_if(compiled_.begin(), compiled_.end(), fits); known != compiled_.end()) {
      compiled = known->model;
    }
  }
  if (compiled) {
    auto kernel = evaluation::ModelKernel::of(std::move(compiled), native);
    if (!kernel) return tl::unexpected(kernel.error());
    found = Kept{structure, native, std::move(*kernel)};
  }
  if (found && found->kernel.set_values(system)) return std::move(*found);
  auto kernel = evaluation::ModelKernel::compile(system, native);
  if (!kernel) return tl::unexpected(kernel.error());
  remember({structure, native, kernel->compiled()});
  return Kept{std::move(structure), native, std::move(*kernel)};
}

void KernelStore::remember(Compiled made) {
  // What it is changed for is dropped when the mutex is free: that takes the symbolic lock.
  const std::lock_guard guard(mutex_);
  const auto same = [&](const Compiled& known) {
    return known.native == made.native && known.structure == made.structure;
  };
  if (const auto known = std::find_if(compiled_.begin(), compiled_.end(), same); known != compiled_.end()) {
    std::swap(*known, made);
  } else if (compiled_.size() < most_models) {
    compiled_.push_back(std::move(made));
  } else {
    std::swap(compiled_[next_model_++ % most_models], made);
  }
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
