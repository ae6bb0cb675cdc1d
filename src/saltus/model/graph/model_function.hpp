// A compiled function with its work space, interpreted or as native code: call with raw pointers, no allocation per
// call.
#pragma once

#include <array>
#include <memory>
#include <utility>
#include <vector>

#include <casadi/core/function.hpp>
#include <casadi/core/sx.hpp>

#include "saltus/model/graph/program.hpp"

namespace saltus::model {

/// Holds one of several copies with work space of their own; what they run is shared, and any thread may run one.
/// Making, copying and dropping take the symbolic lock of the caller.
class ModelFunction {
 public:
  ModelFunction() = default;
  ModelFunction(const std::string& name, const std::vector<casadi::SX>& in, std::vector<casadi::SX> out) {
    for (auto& expression : out) expression = casadi::SX::densify(expression);
    function_ = casadi::Function(name, in, out);
    program_ = Program::of(function_);
    operations_ = static_cast<long>(function_.n_instructions());
    arguments_.resize(function_.sz_arg());
    results_.resize(function_.sz_res());
    integers_.resize(function_.sz_iw());
    work_.resize(function_.sz_w());
  }

  template <std::size_t n_in, std::size_t n_out>
  void operator()(const std::array<const double*, n_in>& in, const std::array<double*, n_out>& out) {
    run(program_.get(), in, out);
  }

  /// Runs a part of its program instead, unless it is native.
  /// @param part  null where the function calls others
  template <std::size_t n_in, std::size_t n_out>
  void run(const Program* part, const std::array<const double*, n_in>& in, const std::array<double*, n_out>& out) {
    for (std::size_t i = 0; i < n_in; ++i) arguments_[i] = in[i];
    for (std::size_t i = 0; i < n_out; ++i) results_[i] = out[i];
    if (native_ != nullptr) {
      native_(arguments_.data(), results_.data(), integers_.data(), work_.data(), 0);
    } else if (part != nullptr) {
      (*part)(arguments_.data(), results_.data(), work_.data());
    } else {
      function_(arguments_.data(), results_.data(), integers_.data(), work_.data());
    }
  }

  /// Signature of the functions that CasADi's code generator writes.
  using Native = int (*)(const double** arguments, double** results, casadi_int* integers, double* work, int memory);
  void use_native(Native native) { native_ = native; }
  [[nodiscard]] const casadi::Function& function() const { return function_; }
  /// Makes the program, null where the function calls others.
  [[nodiscard]] const std::shared_ptr<const Program>& program() const { return program_; }
  /// Returns the number of elementary operations of one interpreted evaluation.
  [[nodiscard]] long operations() const { return operations_; }

  [[nodiscard]] bool is_null() const { return function_.is_null(); }

 private:
  casadi::Function function_;
  std::shared_ptr<const Program> program_;  ///< null where the function calls others
  long operations_ = 0;
  Native native_ = nullptr;
  std::vector<const double*> arguments_;
  std::vector<double*> results_;
  std::vector<casadi_int> integers_;
  std::vector<double> work_;
};

}  // namespace saltus::model
