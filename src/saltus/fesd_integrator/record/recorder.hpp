// Rows and events in the columns of the result.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "saltus/discretization/point_functions.hpp"
#include "saltus/fesd_integrator/decide/transition.hpp"
#include "saltus/fesd_integrator/element/active_set.hpp"
#include "saltus/fesd_integrator/element/facts.hpp"
#include "saltus/result/result.hpp"

namespace saltus::fesd_integrator {

/// Holds the modes of System::switching at an active set, and the selections at a point.
struct ModeView {
  std::vector<int> mode;      ///< -1, 0, 1 by function; of a region 0 while it is active
  std::vector<double> alpha;  ///< by function
};

class Recorder {
 public:
  /// Both must outlive it.
  Recorder(const discretization::PointFunctions& functions, const Facts& facts);

  void row(double t, const std::vector<double>& x, const ActiveSet& set, const std::vector<double>& selections,
           const double* held);
  /// Records that what is held changed at the last row. Adds the same row with what is held now, if its inputs or
  /// outputs differ.
  enum class RowBefore { kept, replaced };
  void row_behind(RowBefore before, const ActiveSet& set, const std::vector<double>& selections, const double* held);
  /// Records that the set changed at t, or was chosen at a start (`before` nullptr; then `at_zero` tells which
  /// selections are zero). Two rows and an event if a listed function changed; at a start a row, and an event if one is
  /// at zero.
  struct Side {
    const ActiveSet* set = nullptr;
    const std::vector<double>* selections = nullptr;
    const double* held = nullptr;  ///< what is held on this side
  };
  /// Records a switch, and returns whether it was an event. `found` are all continuations; the first is where it goes
  /// on.
  bool switched(double t, const std::vector<double>& x, const Side& before, const std::vector<Continuation>& found,
                const double* held, std::string_view reason) {
    return jumped(t, x, x, before, found, held, reason);
  }
  /// Does the same where the state jumps, too.
  bool jumped(double t, const std::vector<double>& x, const std::vector<double>& x_after, const Side& before,
              const std::vector<Continuation>& found, const double* held, std::string_view reason);
  bool started(double t, const std::vector<double>& x, const std::vector<Continuation>& found, const double* held,
               const std::vector<int>& at_zero);
  /// Records that switches have a limit at t: `x` is the last state before it.
  void accumulated(double t, const std::vector<double>& x, const std::vector<double>& x_limit, const Side& before,
                   const std::vector<Continuation>& found, const double* held);
  void user(double t, const std::vector<double>& x, const Side& side, std::size_t event, std::string_view reason);

  [[nodiscard]] ModeView view(const ActiveSet& set, const std::vector<double>& selections, const double* held) const;
  [[nodiscard]] std::size_t events() const { return events_.size(); }
  [[nodiscard]] bool ends_at(double t) const { return !trajectory_.t.empty() && trajectory_.t.back() == t; }
  [[nodiscard]] result::Trajectory& trajectory() { return trajectory_; }
  [[nodiscard]] std::vector<result::Event>& event_list() { return events_; }
  [[nodiscard]] result::Final last() const;

 private:
  struct Columns {
    result::Mode mode;
    std::vector<double> alpha;
    result::Regions regions;
    std::vector<double> theta;
  };
  struct Differences {
    std::vector<std::string> names;
    result::Mode before, after;
  };
  void row_before(double t, const std::vector<double>& x, const Side& before);
  void drop_last_row();
  [[nodiscard]] Differences differences(const Columns& from, const Columns& to) const;
  [[nodiscard]] Columns columns(const ActiveSet& set, const std::vector<double>& selections, const double* held) const;
  void note_before(result::Event& event, const Columns& before) const;
  void finish(result::Event& event, const Columns& after, const std::vector<Continuation>& found, const double* held,
              std::string_view reason);

  const discretization::PointFunctions& functions_;
  const Facts& facts_;
  result::Trajectory trajectory_;
  std::vector<result::Event> events_;
};

}  // namespace saltus::fesd_integrator
