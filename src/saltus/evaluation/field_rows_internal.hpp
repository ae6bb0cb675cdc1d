// Rows of the right-hand side as functions of their own.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "saltus/evaluation/field_structure.hpp"
#include "saltus/model/graph/model_function.hpp"

namespace saltus::evaluation {

/// Evaluates rows of f at the cost of these rows, with the bits of all of f. Never changes.
class FieldRows {
 public:
  /// Holds what a user of rows needs beside the arguments.
  struct Work {
    std::vector<double> constants, results, registers;
  };

  /// Takes f in its two parts, as prepare_field() and prepared_field() have it; null where one of them calls functions
  /// that are not made of operations on scalars. Under the symbolic lock. Cost: the operations of all rows.
  [[nodiscard]] static std::shared_ptr<const FieldRows> of(const model::ModelFunction& field,
                                                           const model::ModelFunction& constants);

  [[nodiscard]] const FieldStructure& structure() const { return structure_; }
  [[nodiscard]] Work work() const;
  [[nodiscard]] double operator()(std::size_t row, double t, const double* x, const double* p, const double* alpha,
                                  Work& work) const;

 private:
  struct Row {
    std::shared_ptr<const model::Program> constants;  ///< those that the row is made of
    std::shared_ptr<const model::Program> field;
  };
  void note(std::size_t row, std::vector<std::size_t> states, std::vector<std::size_t> selections);

  std::vector<Row> rows_;
  FieldStructure structure_;
  std::size_t constants_ = 0, registers_ = 0;
};

}  // namespace saltus::evaluation
