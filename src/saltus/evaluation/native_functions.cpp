#include "saltus/evaluation/native_functions.hpp"

#include <utility>

#include <casadi/core/code_generator.hpp>

#include "saltus/base/symbolic_lock.hpp"

namespace saltus::evaluation {
namespace {

/// Interpreted operations (about 5 ns each) after which looking into the cache, then compiling pays: that takes tenths
/// of a second, and more the more operations the source has.
constexpr double look_after = 2e6;
constexpr double compile_after = 1e8;
constexpr double compile_after_per_operation = 2e4;

}  // namespace

void NativeFunctions::write_source() {
  if (!source_.empty()) return;
  const SymbolicLock lock;
  casadi::CodeGenerator generator("saltus_model.c", {{"with_header", false}});
  for (const auto* function : functions_) generator.add(function->function());
  source_ = generator.dump() + appended_;
}

void NativeFunctions::use(NativeLibrary loaded) {
  for (auto* function : functions_) {
    function->use_native(reinterpret_cast<model::ModelFunction::Native>(loaded.symbol(function->function().name())));
  }
  library_ = std::move(loaded);
}

Expected<void> NativeFunctions::start(NativeCode wanted, std::vector<model::ModelFunction*> functions,
                                      std::string appended) {
  functions_ = std::move(functions);
  appended_ = std::move(appended);
  waiting_ = wanted == NativeCode::automatic;
  next_attempt_ = look_after;
  compile_after_ = compile_after;
  for (const auto* function : functions_) {
    compile_after_ += compile_after_per_operation * static_cast<double>(function->operations());
  }
  if (wanted != NativeCode::on) return {};
  write_source();
  auto found = find_native(source_);
  if (!found) {
    auto compiled = compile_native(source_);
    if (!compiled) return tl::unexpected(compiled.error());
    found = std::move(*compiled);
  }
  use(std::move(*found));
  return {};
}

bool NativeFunctions::look() {
  write_source();
  auto found = find_native(source_);
  if (!found && operations_ >= compile_after_) {
    if (auto compiled = compile_native(source_)) found = std::move(*compiled);
    waiting_ = false;  // one attempt: without a compiler the interpreter goes on
  }
  next_attempt_ = compile_after_;
  if (!found) return false;
  waiting_ = false;
  use(std::move(*found));
  return true;
}

}  // namespace saltus::evaluation
