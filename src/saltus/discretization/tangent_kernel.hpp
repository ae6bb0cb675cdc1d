// First derivatives of a dynamic complementarity system with respect to everything, for sensitivities. No CasADi in
// sight.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/evaluation/model_kernel.hpp"

namespace saltus::reformulation {
struct Dcs;
}

namespace saltus::discretization {

/// Holds values at one point and their derivatives; matrices by columns, rows first in the names' order. n columns of
/// selections, n_p of parameters.
struct TangentValues {
  std::vector<double> f, f_t, f_x, f_selection, f_p;                     ///< n_x rows
  std::vector<double> indicator, indicator_t, indicator_x, indicator_p;  ///< n rows: psi_j, or g_i
  std::vector<double> rate_t, rate_x, rate_selection, rate_p;            ///< n rows: of indicator_x f + indicator_t
};

/// Holds the direction f_selection v of a projection along selections v, and its derivatives; n_x rows.
struct DirectionValues {
  std::vector<double> f_selection, by_t, by_x, by_selection, by_p;
};

/// Holds derivatives of the arguments of what is held within a simulation step, one row each; each argument depends on
/// the values of those before it.
struct HeldTangent {
  std::vector<double> by_t, by_x, by_held, by_p;
};

/// Is one kernel per thread: the work space is inside.
class TangentKernel {
 public:
  /// Takes `parameters`, the values of Dcs::p. Controls are replaced by their inputs, lifted variables by their
  /// products. Fails (invalid_model) if the symbolic layer refuses an expression, (not_available) if native code is
  /// insisted on and cannot be had. Cost: that of the second derivatives of the indicators.
  [[nodiscard]] static Expected<TangentKernel> compile(const reformulation::Dcs& dcs, std::vector<double> parameters,
                                                       evaluation::NativeCode native = evaluation::NativeCode::off);
  TangentKernel(TangentKernel&&) noexcept;
  TangentKernel& operator=(TangentKernel&&) noexcept;
  ~TangentKernel();

  [[nodiscard]] std::size_t states() const;
  [[nodiscard]] std::size_t selections() const;
  [[nodiscard]] std::size_t parameters() const;
  /// Returns the number of symbols that are held within a simulation step.
  [[nodiscard]] std::size_t held() const;

  /// Makes `values` as large as evaluate() needs it.
  void size(TangentValues& values) const;
  void evaluate(double t, const double* x, const double* selection, const double* held, TangentValues& values) const;
  /// Evaluates the direction of a projection: changes of the selections, v. Makes `values` as large as needed.
  void direction(double t, const double* x, const double* selection, const double* held, const double* along,
                 DirectionValues& values) const;
  /// Evaluates how the times move at which something held changes: argument(t, x, p) = the bound that it reaches.
  void held_tangent(double t, const double* x, const double* held, HeldTangent& values) const;

 private:
  struct Implementation;
  explicit TangentKernel(std::unique_ptr<Implementation> implementation);
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace saltus::discretization
