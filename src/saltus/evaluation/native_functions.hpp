// Functions that become native code together, and when.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/evaluation/native_code.hpp"
#include "saltus/model/graph/model_function.hpp"

namespace saltus::evaluation {

class NativeJob;

/// Interprets functions and counts their operations; from the cache, or compiled, they go on as native code once they
/// have done so much work that it pays. The compiler works beside them. Results do not depend on the moment: they are
/// bit-identical.
class NativeFunctions {
 public:
  /// Begins with `functions`, which have names of their own and outlive this without moving; `appended` is C source
  /// that may call them. Fails (not_available) if native code is insisted on and cannot be had.
  [[nodiscard]] Expected<void> start(NativeCode wanted, std::vector<model::ModelFunction*> functions,
                                     std::string appended = "");
  /// Counts an interpreted call that is about to be made. True if the functions are native from now on.
  bool count(const model::ModelFunction& function) {
    if (!waiting_) return false;
    operations_ += static_cast<double>(function.operations());
    return operations_ >= next_attempt_ && look();
  }
  template <std::size_t n_in, std::size_t n_out>
  void call(model::ModelFunction& function, const std::array<const double*, n_in>& in,
            const std::array<double*, n_out>& out) {
    count(function);
    function(in, out);
  }
  /// Returns the address of a function of the native code; nullptr as long as everything is interpreted.
  [[nodiscard]] void* symbol(const std::string& name) const { return library_ ? library_->symbol(name) : nullptr; }

 private:
  void write_source();
  void use(NativeLibrary loaded);
  bool look();

  std::vector<model::ModelFunction*> functions_;
  std::string appended_;
  bool waiting_ = false;       ///< for the work to be enough
  double operations_ = 0.0;    ///< interpreted so far
  double next_attempt_ = 0.0;  ///< to find or compile native code, in operations
  double compile_after_ = 0.0;
  std::string source_;  ///< once it was needed
  std::optional<NativeLibrary> library_;
  std::shared_ptr<NativeJob> job_;  ///< while the compiler works; never shared
};

}  // namespace saltus::evaluation
