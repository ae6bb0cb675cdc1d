// A CasADi function with its work space, interpreted or as native code: call with raw pointers, no allocation per call.
#pragma once

#include <array>
#include <vector>

#include <casadi/core/function.hpp>
#include <casadi/core/sx.hpp>

namespace saltus::model {

class ModelFunction {
 public:
  ModelFunction() = default;
  ModelFunction(const std::string& name, const std::vector<casadi::SX>& in, std::vector<casadi::SX> out) {
    for (auto& expression : out) expression = casadi::SX::densify(expression);
    function_ = casadi::Function(name, in, out);
    memory_ = static_cast<int>(function_.checkout());
    arguments_.resize(function_.sz_arg());
    results_.resize(function_.sz_res());
    integers_.resize(function_.sz_iw());
    work_.resize(function_.sz_w());
  }
  ModelFunction(ModelFunction&& other) noexcept { swap(other); }
  ModelFunction& operator=(ModelFunction&& other) noexcept {
    swap(other);
    return *this;
  }
  ModelFunction(const ModelFunction&) = delete;
  ModelFunction& operator=(const ModelFunction&) = delete;
  ~ModelFunction() {
    if (!function_.is_null()) function_.release(memory_);
  }

  template <std::size_t n_in, std::size_t n_out>
  void operator()(const std::array<const double*, n_in>& in, const std::array<double*, n_out>& out) {
    for (std::size_t i = 0; i < n_in; ++i) arguments_[i] = in[i];
    for (std::size_t i = 0; i < n_out; ++i) results_[i] = out[i];
    if (native_ != nullptr) {
      native_(arguments_.data(), results_.data(), integers_.data(), work_.data(), 0);
      return;
    }
    function_(arguments_.data(), results_.data(), integers_.data(), work_.data(), memory_);
  }

  /// Signature of the functions that CasADi's code generator writes.
  using Native = int (*)(const double** arguments, double** results, casadi_int* integers, double* work, int memory);
  void use_native(Native native) { native_ = native; }
  [[nodiscard]] const casadi::Function& function() const { return function_; }
  /// Elementary operations of one interpreted evaluation.
  [[nodiscard]] long operations() const { return static_cast<long>(function_.n_instructions()); }

  [[nodiscard]] bool is_null() const { return function_.is_null(); }

 private:
  void swap(ModelFunction& other) noexcept {
    std::swap(function_, other.function_);
    std::swap(memory_, other.memory_);
    std::swap(native_, other.native_);
    std::swap(arguments_, other.arguments_);
    std::swap(results_, other.results_);
    std::swap(integers_, other.integers_);
    std::swap(work_, other.work_);
  }

  casadi::Function function_;
  int memory_ = 0;
  Native native_ = nullptr;
  std::vector<const double*> arguments_;
  std::vector<double*> results_;
  std::vector<casadi_int> integers_;
  std::vector<double> work_;
};

}  // namespace saltus::model
