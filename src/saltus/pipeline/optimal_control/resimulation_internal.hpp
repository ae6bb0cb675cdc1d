// Event-driven simulations of optimised controls: of one interval, or of all.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/event_integrator/integrate.hpp"
#include "saltus/linalg/matrix.hpp"
#include "saltus/model/ocp.hpp"
#include "saltus/pipeline/optimal_control/verify.hpp"

namespace saltus::pipeline {

/// Holds the system with the controls and parameters of a solution, compiled once.
class Resimulation {
 public:
  /// Fails if the symbolic layer refuses the model. `path` must outlive it.
  [[nodiscard]] static Expected<Resimulation> make(const model::System& system, const OptimizedPath& path);

  struct Segment {
    event_integrator::Integration run;
    bool is_complete = false;  ///< it came to its end
    bool was_chosen = false;   ///< the mode somewhere is that of the solution, and not what the engine takes
    /// By how much states were moved onto those of the optimised trajectory inside of it; empty: not at all.
    std::vector<double> moved{};
  };
  /// Returns whether an end is that of the optimised trajectory.
  using IsNear = std::function<bool(const std::vector<double>&)>;
  /// Simulates from node k with the controls of interval k to its end. The solution from there may not be unique. Then
  /// the mode that the optimised trajectory has is taken if it is one of those that are possible. Where this ends
  /// elsewhere, the interval is cut where the optimised trajectory switches. Each piece begins at its state there, in
  /// its mode if that is possible: it may leave a surface that it could stay on, or meet two at once.
  [[nodiscard]] Segment interval(std::size_t k, const IsNear& is_near, const std::function<bool()>& is_interrupted);
  /// Simulates from the first node over the whole horizon, likewise; pieces begin where the last one has ended.
  [[nodiscard]] Segment open_loop(const IsNear& is_near, const std::function<bool()>& is_interrupted);
  /// Returns the 2-norm of d x(T) / d x(from), the product of the derivatives of all intervals, by central differences
  /// in steps of 1e-5 `scales`. Bodies that touch at a node stay in touch. NaN if a simulation does not come to its
  /// end.
  [[nodiscard]] double amplification(const std::vector<double>& scales, const std::function<bool()>& is_interrupted);

 private:
  Resimulation(model::System system, evaluation::ModelKernel kernel, const OptimizedPath& path);
  /// A run, and what it began with.
  struct Piece {
    std::vector<double> start;
    event_integrator::IntegrationOptions options;
    Segment segment;
  };
  /// Where a piece begins.
  enum class Restart { at_plan, where_it_is };
  [[nodiscard]] Segment from_node(std::size_t k, const event_integrator::IntegrationOptions& options, Restart restart,
                                  const IsNear& is_near, const std::function<bool()>& is_interrupted);
  /// @param last  the whole of it, from node k
  [[nodiscard]] Segment in_pieces(std::size_t k, Piece last, Restart restart,
                                  const std::function<bool()>& is_interrupted);
  /// In the wanted mode if that is one of those that are possible.
  [[nodiscard]] Piece piece(std::vector<double> start, event_integrator::IntegrationOptions options,
                            const std::optional<result::Mode>& wanted, const std::function<bool()>& is_interrupted);
  /// Puts a state onto the surfaces that the mode slides on, if they are no farther than what equations leave.
  void put_on_surfaces(double t, const result::Mode& mode, std::vector<double>& x) const;
  [[nodiscard]] event_integrator::Integration run(const event_integrator::IntegrationOptions& options,
                                                  const std::function<bool()>& is_interrupted);
  /// NaN if the run from `start` does not come to the end of interval k.
  [[nodiscard]] linalg::Vector end_of(std::size_t k, std::vector<double> start,
                                      const std::function<bool()>& is_interrupted);
  [[nodiscard]] std::vector<std::pair<int, int>> forced_mode(const event_integrator::Integration& run,
                                                             const std::optional<result::Mode>& wanted) const;

  model::System system_;
  evaluation::ModelKernel kernel_;
  const OptimizedPath* path_;
};

/// Simulates from the first node over the whole horizon, in interval k with u_k + K_k (x(t_k) - x_k), moved onto the
/// bounds of the controls. Simulates Ocp::plant if there is one.
/// @param gains  K_k over all controls and the states of the result
[[nodiscard]] Expected<Resimulation::Segment> simulate_closed_loop(const model::Ocp& ocp, const OptimizedPath& path,
                                                                   const std::vector<linalg::Matrix>& gains,
                                                                   const std::function<bool()>& is_interrupted);

/// Returns the gains that simulate_closed_loop uses, by time.
[[nodiscard]] std::vector<result::FeedbackGain> used_gains(const OptimizedPath& path,
                                                           const std::vector<linalg::Matrix>& gains);

/// Returns options so sharp that defects of 1e-9 of the range are those of the solution; `rows` + 1 rows of equal
/// distance.
[[nodiscard]] event_integrator::IntegrationOptions resimulation_options(double from, double until, std::size_t rows);

}  // namespace saltus::pipeline
