// A dynamic complementarity system at one point, as plain functions of doubles. No CasADi in sight.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/discretization/entry_pattern.hpp"
#include "saltus/evaluation/model_kernel.hpp"

namespace saltus::reformulation {
struct Dcs;
}

namespace saltus::discretization {

/// Holds f, the indicators and their derivatives at one point; of matrices the entries of `pattern`.
struct StageValues {
  std::vector<double> f;            ///< n_x
  std::vector<double> indicator;    ///< n_selections: psi_j, or g_i
  std::vector<double> f_x;          ///< n_x by n_x
  std::vector<double> f_selection;  ///< n_x by n_selections
  std::vector<double> indicator_x;  ///< n_selections by n_x
  std::vector<double> indicator_t;  ///< n_selections
  const StagePattern* pattern = nullptr;
};

/// Holds what Dcs::roots are to a point: unknowns of their own; matrices by columns.
struct RootValues {
  std::vector<double> base;    ///< n_roots
  std::vector<double> base_x;  ///< n_roots by n_x
  std::vector<double> f_root;  ///< n_x by n_roots
};

/// Evaluates functions that take t, x (n_x), the selections (n_selections) and what is held (n_held), and write to the
/// caller's memory. Values that are not finite mark points where the model is undefined. The work space is inside: one
/// kernel per thread.
class StageKernel {
 public:
  /// Takes `parameters`, the values of Dcs::p. Controls are replaced by their inputs, lifted variables by their
  /// products. Fails (invalid_model) if the symbolic layer refuses an expression, (not_available) if native code is
  /// insisted on and cannot be had.
  [[nodiscard]] static Expected<StageKernel> compile(const reformulation::Dcs& dcs, std::vector<double> parameters,
                                                     evaluation::NativeCode native = evaluation::NativeCode::off);
  StageKernel(StageKernel&&) noexcept;
  StageKernel& operator=(StageKernel&&) noexcept;
  ~StageKernel();

  [[nodiscard]] std::size_t states() const;
  [[nodiscard]] std::size_t selections() const;
  /// Returns few entries of a system of some size with few, else all. Lives as long as the kernel.
  [[nodiscard]] const StagePattern& pattern() const;

  /// Returns exponents of Dcs::roots.
  [[nodiscard]] const std::vector<double>& root_exponents() const;
  /// Makes `values` as large as evaluate() needs it.
  void size(StageValues& values) const;
  void size(RootValues& values) const;
  /// Evaluates everything of StageValues.
  void evaluate(double t, const double* x, const double* selection, const double* held, StageValues& values) const;
  /// Evaluates f and the indicators of StageValues; their derivatives stay as they are.
  void values(double t, const double* x, const double* selection, const double* held, StageValues& values) const;
  /// Evaluates the same as evaluate() at given values of the roots, and what these are unknowns for: f_x and
  /// f_selection are those at fixed roots. Only for systems that have some.
  void evaluate(double t, const double* x, const double* selection, const double* held, const double* root,
                StageValues& values, RootValues& roots) const;
  /// Evaluates f alone.
  void field(double t, const double* x, const double* selection, const double* held, double* f) const;
  /// Evaluates the indicators alone.
  void indicators(double t, const double* x, const double* held, double* indicator) const;
  /// Returns the number of evaluations of f so far, with derivatives or without.
  [[nodiscard]] long evaluations() const;

 private:
  struct Implementation;
  explicit StageKernel(std::unique_ptr<Implementation> implementation);
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace saltus::discretization
