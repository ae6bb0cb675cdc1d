// Rows of a function alone: the operations that they need.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "saltus/model/graph/program.hpp"

namespace saltus::model {

/// Cuts programs for some rows of its results out of a program; they give the bits of the whole one.
class ProgramParts {
 public:
  /// Cost: once through the program.
  explicit ProgramParts(std::shared_ptr<const Program> whole);

  /// Rows by result, of the first ones.
  using Rows = std::vector<std::vector<std::size_t>>;
  /// Takes the same arguments, results and work space as the whole one, and writes these rows only. Cost: that of the
  /// part.
  [[nodiscard]] std::shared_ptr<const Program> of(const Rows& rows) const;

 private:
  static constexpr int nowhere = -1;
  std::shared_ptr<const Program> whole_;
  std::vector<int> first_, second_;       ///< of every operation: the one that has made its operand
  std::vector<std::vector<int>> output_;  ///< by result and row
};

}  // namespace saltus::model
