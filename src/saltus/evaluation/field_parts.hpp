// Rows of the right-hand side as functions of their own: those that a selection is in, and the states around them.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

namespace saltus::evaluation {

struct CompiledModel;
struct FieldConstants;

/// FieldParts evaluates few rows of f at the cost of these rows, with the bits of all of f. One user at a time.
class FieldParts {
 public:
  struct Part {
    std::vector<std::size_t> rows;    ///< ascending
    std::vector<std::size_t> inputs;  ///< other states that they are made of, ascending
    std::vector<std::size_t> border;  ///< those of the rows that move states outside of the part
    std::size_t number = 0;           ///< of its function
  };

  /// Takes those of the free motion. Cost: the patterns of f.
  explicit FieldParts(CompiledModel& model);
  FieldParts(FieldParts&&) noexcept;
  ~FieldParts();

  /// Returns the rows that hold alpha_selection, and `rings` times what these move. Null where that is more than a
  /// quarter of all states, or none. Stays where it is. Cost: that of the part, the first time.
  [[nodiscard]] const Part* of(int selection, int rings);
  /// Writes these rows of xdot (n_x). Reads `rows` and `inputs` of x (n_x) only.
  void operator()(const Part& part, double t, const double* x, const FieldConstants& constants, double* xdot);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace saltus::evaluation
