// Guards that are held at zero behind an accumulation of jumps.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/model/system.hpp"

namespace saltus::event_integrator {

/// A held guard and the sign it would get by itself: that of its second derivative while it is held.
struct HeldGuard {
  evaluation::Hold hold;
  int inward = -1;
};

/// Keeps g = 0 and dg/dt = 0 for the held guards. The kernel's fields keep d^2 g/dt^2 = 0; what steps and roundings
/// leave is removed by Newton steps: the position along grad g, its rate in the continuous states that the jump sets.
class Holding {
 public:
  Holding(const evaluation::ModelKernel& kernel, const model::System& system);
  Holding(const Holding&) = delete;
  Holding& operator=(const Holding&) = delete;
  ~Holding();  ///< the kernel is as it was

  [[nodiscard]] const std::vector<HeldGuard>& guards() const { return guards_; }
  [[nodiscard]] bool holds(int function) const;
  /// Holds exactly these guards from now on. Returns what is wrong if the kernel cannot.
  [[nodiscard]] std::optional<std::string> set(std::vector<HeldGuard> guards);
  /// Puts x on g = 0, dg/dt = 0; returns whether it changed.
  bool project(double t, const std::vector<double>& alpha, std::vector<double>& x);
  /// Whether what the jump sets has an influence on dg/dt.
  [[nodiscard]] bool can_rest(const evaluation::Hold& hold, double t, const std::vector<double>& alpha,
                              const std::vector<double>& x);
  /// The largest |dg/dt| at a point.
  [[nodiscard]] double largest_rate(double t, const std::vector<double>& alpha, const std::vector<double>& x) const;

 private:
  double find_rate_row(const evaluation::Hold& hold, double t, const std::vector<double>& alpha,
                       std::vector<double>& x);
  bool find_positions(double t, const std::vector<double>& alpha, const std::vector<double>& x);
  bool find_rates(double t, const std::vector<double>& alpha, std::vector<double>& x);
  bool correct(std::vector<double>& x);

  const evaluation::ModelKernel& kernel_;
  const model::System& system_;
  std::vector<HeldGuard> guards_;
  std::vector<double> values_, row_;
  Eigen::MatrixXd rows_, normal_;  ///< of all held guards
  Eigen::VectorXd residual_;
  Eigen::LLT<Eigen::MatrixXd> cholesky_;
};

}  // namespace saltus::event_integrator
