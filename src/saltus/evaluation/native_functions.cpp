#include "saltus/evaluation/native_functions.hpp"

#include <utility>

#include <casadi/core/code_generator.hpp>

#include "saltus/base/symbolic_lock.hpp"
#include "saltus/evaluation/native_job.hpp"
#include "saltus/evaluation/sparse/flat_code_internal.hpp"

namespace saltus::evaluation {
namespace {

/// Interpreted operations (about 5 ns each) after which looking into the cache, then compiling pays: that takes tenths
/// of a second of another processor, and more the more operations the source has.
constexpr double look_after = 2e6;
constexpr double compile_after = 1e8;
constexpr double compile_after_per_operation = 4e3;
/// Between two looks at the compiler.
constexpr double wait_for = 1e6;
/// Functions with more operations are written in parts.
constexpr long flat_from = 1500;
/// Operations of all functions beyond which a compiler needs too much memory, and more time than runs have.
constexpr double most_operations = 2e6;

}  // namespace

void NativeFunctions::write_source() {
  if (!source_.empty()) return;
  const SymbolicLock lock;
  casadi::CodeGenerator generator("saltus_model.c", {{"with_header", false}});
  std::string flat;
  for (const auto* function : functions_) {
    const std::string code = function->operations() >= flat_from ? flat_code(function->function()) : "";
    if (code.empty()) generator.add(function->function());
    flat += code;
  }
  source_ = generator.dump() + flat + appended_;
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
  double size = 0.0;
  for (const auto* function : functions_) {
    compile_after_ += compile_after_per_operation * static_cast<double>(function->operations());
    size += static_cast<double>(function->operations());
  }
  waiting_ = waiting_ && size <= most_operations;
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
  std::optional<NativeLibrary> found;
  if (job_) {
    next_attempt_ = operations_ + wait_for;
    if (!job_->has_ended()) return false;
    if (auto compiled = job_->finish()) found = std::move(*compiled);
    job_.reset();
    waiting_ = false;  // one attempt: without a compiler the interpreter goes on
  } else {
    write_source();
    found = find_native(source_);
    next_attempt_ = compile_after_;
  }
  if (!found && waiting_ && operations_ >= compile_after_) {
    next_attempt_ = operations_ + wait_for;
    auto job = NativeJob::start(source_);
    waiting_ = job.has_value();
    if (job) job_ = std::move(*job);
  }
  if (!found) return false;
  waiting_ = false;
  use(std::move(*found));
  return true;
}

}  // namespace saltus::evaluation
