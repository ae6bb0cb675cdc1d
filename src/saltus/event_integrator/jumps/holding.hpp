// Guards that are held at zero behind an accumulation of jumps.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/event_integrator/contact/contacts.hpp"
#include "saltus/event_integrator/sliding/normal_rows.hpp"
#include "saltus/linalg/matrix.hpp"
#include "saltus/linalg/row_basis.hpp"
#include "saltus/model/layout.hpp"

namespace saltus::event_integrator {

/// Holds a held guard and the sign it would get by itself: that of its second derivative while it is held.
struct HeldGuard {
  evaluation::Hold hold;
  int inward = -1;
};

/// Holds guards at rest.
struct HeldGuards {
  std::vector<HeldGuard> guards;  ///< held by the kernel
  std::vector<HeldGuard> followers;

  [[nodiscard]] bool empty() const { return guards.empty() && followers.empty(); }
  [[nodiscard]] bool holds(int function) const;
  [[nodiscard]] std::vector<HeldGuard> all() const;
};

/// Keeps g = 0 and dg/dt = 0 for guards at rest. The kernel's fields keep d^2 g/dt^2 = 0; what steps and roundings
/// leave is removed by Newton steps: the position along grad g, its rate in the states that the jump sets.
///
/// Of guards at rest whose rates depend on each other (three legs of a plate, two guards of one contact, a jump that
/// counts impacts beside the one that reflects) an independent part is held by the kernel; the others follow.
class Holding {
 public:
  explicit Holding(evaluation::ModelKernel& kernel);
  Holding(const Holding&) = delete;
  Holding& operator=(const Holding&) = delete;
  ~Holding();  ///< the kernel is as it was

  [[nodiscard]] const HeldGuards& held() const { return held_; }
  [[nodiscard]] const std::vector<HeldGuard>& guards() const { return held_.guards; }
  [[nodiscard]] bool holds(int function) const { return held_.holds(function); }
  /// Holds these guards from now on, and those of `loose` that they press on or take along; puts x there. Guards of
  /// `loose` that are left out leave by themselves. Returns what is wrong if they cannot be held.
  [[nodiscard]] std::optional<std::string> hold(std::vector<HeldGuard> guards, std::vector<HeldGuard> loose, double t,
                                                const std::vector<double>& alpha, std::vector<double>& x);
  void release_all();
  /// Holds the guards() of another one of this system, which are known to be held; false where the kernel refuses.
  [[nodiscard]] bool put(const std::vector<HeldGuard>& guards);
  /// Holds contacts at zero with the guards.
  void keep(Contacts* contacts) { contacts_ = contacts; }
  /// Puts x on g = 0, dg/dt = 0; returns whether it changed.
  bool project(double t, const std::vector<double>& alpha, std::vector<double>& x);
  /// Returns whether the jump of a guard at zero can keep it there: what it sets has an influence on dg/dt, and stops
  /// or turns around a motion inward. One that lets it go on (the foot of a rocking block) does not push.
  [[nodiscard]] bool can_rest(const HeldGuard& guard, double t, const std::vector<double>& alpha,
                              const std::vector<double>& x);
  /// Returns the largest |dg/dt| at a point, and there behind the jumps of the guards at rest: an impact at rest
  /// changes nothing.
  [[nodiscard]] double largest_rate(double t, const std::vector<double>& alpha, const std::vector<double>& x) const;
  /// Returns f as if nothing was held, n_x.
  [[nodiscard]] std::vector<double> free_field(double t, const std::vector<double>& alpha,
                                               const std::vector<double>& x) const;

 private:
  double find_rate_row(const evaluation::Hold& hold, const std::vector<int>& states, double t,
                       const std::vector<double>& alpha, std::vector<double>& x);
  [[nodiscard]] bool lets_go_on(const HeldGuard& guard, double square, double t, const std::vector<double>& alpha,
                                std::vector<double> point) const;
  bool is_independent(const HeldGuard& guard, double t, const std::vector<double>& alpha, std::vector<double>& x);
  [[nodiscard]] std::vector<evaluation::Hold> holds() const;
  [[nodiscard]] std::optional<std::string> set(double t, const std::vector<double>& alpha, std::vector<double>& x);
  [[nodiscard]] std::optional<std::string> moves_what_is_compared(double t, const std::vector<double>& alpha,
                                                                  std::vector<double>& x);
  [[nodiscard]] double second_derivative(const HeldGuard& guard, double t, const std::vector<double>& alpha,
                                         const std::vector<double>& x) const;
  void resize_rows();
  bool find_positions(double t, const std::vector<double>& alpha, const std::vector<double>& x);
  bool find_rates(double t, const std::vector<double>& alpha, std::vector<double>& x);

  evaluation::ModelKernel& kernel_;
  const model::Layout& layout_;
  Contacts* contacts_ = nullptr;
  HeldGuards held_;
  double pressing_ = 0.0;              ///< the largest |d^2 g/dt^2| without a hold that was met: what counts as none
  std::vector<int> absorbing_;         ///< states that the jumps in question set
  linalg::RowBasis basis_{0, 0, 0.0};  ///< of the rows of rates of guards()
  std::vector<double> values_, row_;
  NormalRows rows_;          ///< of all held guards
  linalg::Vector residual_;  ///< likewise
};

}  // namespace saltus::event_integrator
