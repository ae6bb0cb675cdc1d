// A local function at many places of a sparse problem.
#pragma once

#include <vector>

#include "saltus/discretization/local_function_internal.hpp"
#include "saltus/linalg/matrix.hpp"

namespace saltus::discretization {

/// Gives places of local variables: >= 0 a variable of the problem, else the constant constant_place() was made of.
[[nodiscard]] constexpr int constant_place(int constant) { return -1 - constant; }
[[nodiscard]] constexpr int constant_number(int place) { return -1 - place; }
[[nodiscard]] inline double value_at(int place, mpcc::ConstVectorView w, const linalg::Vector& constants) {
  return place >= 0 ? w[place] : constants[-1 - place];
}

/// Holds the first rows of a copy, and the sizes of the problem that turn a pair into rows of G and H.
struct RowPlace {
  int first_equation = 0;
  int first_pair = 0;
  int equations = 0;  ///< of the problem
  int pairs = 0;
};

/// Holds copies of one LocalFunction with their variables and rows; entries with respect to constants are left out.
class PlacedFunction {
 public:
  explicit PlacedFunction(LocalFunction& function);
  /// @param places  one per local variable
  void add(const std::vector<int>& places, const RowPlace& rows);

  void write_signs(std::vector<mpcc::Sign>& signs, int equations) const;
  void add_patterns(mpcc::Pattern& jacobian, mpcc::Pattern& hessian) const;

  [[nodiscard]] int copies() const { return static_cast<int>(copies_.size()); }
  /// Returns rows of a copy in the problem: its equations, then G, then H.
  [[nodiscard]] const std::vector<int>& rows_of(int copy) const { return copies_[static_cast<std::size_t>(copy)].rows; }
  /// Returns the local variables of a copy; overwritten by the next call.
  const std::vector<double>& gather(int copy, mpcc::ConstVectorView w, const linalg::Vector& constants);
  [[nodiscard]] double objective(mpcc::ConstVectorView w, const linalg::Vector& constants,
                                 const linalg::Vector& parameters);
  /// Adds factor times the gradient of the objective.
  void add_gradient(mpcc::ConstVectorView w, const linalg::Vector& constants, const linalg::Vector& parameters,
                    mpcc::VectorView gradient, double factor = 1.0);
  void rows(mpcc::ConstVectorView w, const linalg::Vector& constants, const linalg::Vector& parameters,
            mpcc::VectorView c);
  /// Returns values in the order of add_patterns from `next` on; returns what follows them.
  double* jacobian(mpcc::ConstVectorView w, const linalg::Vector& constants, const linalg::Vector& parameters,
                   double* next);
  double* hessian(mpcc::ConstVectorView w, const linalg::Vector& constants, const linalg::Vector& parameters,
                  double factor, mpcc::ConstVectorView y, double* next);

 private:
  struct Copy {
    std::vector<int> places;    ///< of local variables
    std::vector<int> rows;      ///< of local rows
    std::vector<int> jacobian;  ///< local entries that are kept
    std::vector<int> hessian;
  };
  LocalFunction& function_;
  std::vector<Copy> copies_;
  std::vector<double> z_, rows_, entries_;
};

}  // namespace saltus::discretization
