// The operations of a function of scalars as data that never changes: any number of threads runs it at a time.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include <casadi/core/function.hpp>

namespace saltus::model {

/// Does what CasADi's interpreter does with a function of SX, operation by operation and bit by bit. It has none of its
/// counts of references and memory objects, which are not for several threads.
class Program {
 public:
  /// Makes the program, null where the function calls others. Under the symbolic lock.
  [[nodiscard]] static std::shared_ptr<const Program> of(const casadi::Function& function);

  /// Evaluates with the signature of CasADi: null arguments are zeros, null results are left out; `work` has room for
  /// sz_w() numbers.
  void operator()(const double* const* arguments, double* const* results, double* work) const;
  /// Returns the places of an argument that it reads, ascending.
  [[nodiscard]] std::vector<std::size_t> inputs(int argument) const;

 private:
  friend class ProgramParts;
  struct Operands {
    int first, second;
  };
  struct Instruction {
    int operation;
    int target;
    union {
      Operands operands;
      double constant;
    };
  };
  std::vector<Instruction> instructions_;
};

}  // namespace saltus::model
