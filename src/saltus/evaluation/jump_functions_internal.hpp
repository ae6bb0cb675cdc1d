// What the kernel knows of [[jumps]]: conditions, values, priorities and delays as compiled functions.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "saltus/model/graph/model_function.hpp"
#include "saltus/model/system.hpp"

namespace saltus::evaluation {

using model::ModelFunction;

class JumpFunctions {
 public:
  JumpFunctions() = default;
  /// @param arguments       t, x, p, alpha
  /// @param input           u as an expression of t, p, alpha; replaces system.u
  /// @param first_function  event function of the first guard of the first jump
  JumpFunctions(const model::System& system, const std::vector<casadi::SX>& arguments, const casadi::SX& input,
                int first_function);

  /// t, x, p, alpha
  using Arguments = std::array<const double*, 4>;

  [[nodiscard]] int guard(int jump, int guard) const;
  [[nodiscard]] bool condition(int jump, const Arguments& at, const double* guard_alpha);
  void values(int jump, const Arguments& at, double* values);
  [[nodiscard]] double priority(int jump, const Arguments& at);
  [[nodiscard]] double delay(int jump, const Arguments& at);
  /// Returns all of them, with names of their own. Valid as long as this does not move.
  [[nodiscard]] std::vector<ModelFunction*> functions();

 private:
  /// Mostly a number; a function otherwise.
  struct Quantity {
    std::optional<double> constant;
    ModelFunction function;
  };
  static double value(Quantity& quantity, const Arguments& at);
  struct Entry {
    int first_guard = 0, guards = 0;
    ModelFunction condition;  ///< null unless the trigger is a condition
    ModelFunction values;
    Quantity priority, delay;
  };
  Entry& entry(int jump);
  std::vector<Entry> entries_;
};

}  // namespace saltus::evaluation
