// User events along accepted elements.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "saltus/fesd_integrator/record/recorder.hpp"
#include "saltus/fesd_integrator/run/context_internal.hpp"
#include "saltus/fesd_integrator/run/element_interior_internal.hpp"
#include "saltus/fesd_integrator/run/output_rows_internal.hpp"
#include "saltus/fesd_integrator/run/position_internal.hpp"
#include "saltus/fesd_integrator/run/run_status_internal.hpp"
#include "saltus/fesd_integrator/watch/user_events.hpp"

namespace saltus::fesd_integrator {

/// Finds zeros of event functions inside elements, each to the rounding of its own shorter element, and records them
/// together with the rows before them. An event that stops the run takes the position with it.
class EventTracker {
 public:
  /// All must outlive it.
  EventTracker(RunContext& context, Position& position, ElementInterior& interior, OutputRows& rows, Recorder& recorder,
               RunStatus& status);

  [[nodiscard]] bool empty() const { return events_.empty(); }
  /// Takes over the signs at the start; nothing fires.
  void start();
  /// Records events and output times of an element that is accepted; false if an event stops the run.
  [[nodiscard]] bool record(const Element& element, const std::vector<double>& left, double end);
  /// Fires events whose functions have another sign at the position, and that of `crossed`; functions at zero at the
  /// start have a sign from now on. True if an event stops the run.
  bool update_here(std::optional<std::size_t> crossed = std::nullopt);
  /// Fires events at a switch, behind it.
  void fire_at_switch();

 private:
  struct Zero {
    std::size_t function = 0;
    double theta = 0.0;
  };
  /// Of an element in which zeros of event functions are looked for.
  struct Stretch {
    double from = 0.0, to = 1.0;
    int halvings = 0;           ///< that are left
    bool behind_zeros = false;  ///< what is zero where it begins was so before
  };
  void sample(const Element& element, const std::vector<double>& selections, const Stretch& part);
  [[nodiscard]] std::optional<Zero> first_zero(const Element& element, const std::vector<double>& selections,
                                               const Stretch& part);
  /// The first zero of one function, from the samples of a stretch.
  struct Look {
    enum class Answer { none, zero, unresolved };
    Answer answer = Answer::none;
    double theta = 0.0;
  };
  [[nodiscard]] Look look_for_zero(std::size_t function, const Element& element, const Stretch& part) const;
  void settle_signs(const Element& element, const std::vector<double>& selections);
  /// The zero itself, and the state there.
  struct Refined {
    double theta = 0.0;
    std::vector<double> x, selections;
  };
  [[nodiscard]] Refined refine(const Element& element, const std::vector<double>& selections, const Zero& zero);
  [[nodiscard]] double value_inside(const Element& element, const std::vector<double>& selections, double theta,
                                    std::size_t function);
  [[nodiscard]] double value_at(double t, const std::vector<double>& x, std::size_t function);
  /// Records events; true if one of them stops the run.
  bool fire(const std::vector<std::size_t>& fired, double t, const std::vector<double>& x,
            const std::vector<double>& selections);

  RunContext& context_;
  Position& position_;
  ElementInterior& interior_;
  OutputRows& rows_;
  Recorder& recorder_;
  RunStatus& status_;
  UserEvents events_;
  std::vector<double> samples_;  ///< at the nodes of an interpolant, then at those where it is checked
  std::vector<double> values_;
  Element shorter_;
};

}  // namespace saltus::fesd_integrator
