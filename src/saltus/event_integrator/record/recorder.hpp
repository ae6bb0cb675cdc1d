// Rows and events of a run, as they come.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "saltus/base/at.hpp"
#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/event_integrator/contact/open_motion.hpp"
#include "saltus/event_integrator/decide/transition.hpp"
#include "saltus/event_integrator/mode/mode_change.hpp"
#include "saltus/event_integrator/mode/mode_state.hpp"
#include "saltus/event_integrator/record/recording.hpp"
#include "saltus/linalg/matrix.hpp"
#include "saltus/model/layout.hpp"
#include "saltus/ode/straight_lines.hpp"

namespace saltus::event_integrator {

/// Holds states and modes on both sides of an event.
struct Passage {
  const std::vector<double>& x;
  const std::vector<double>& x_after;
  const ModeState& before;
  const ModeState& after;
};

/// Holds one execution of a jump.
struct ExecutedJump {
  int jump = 0;
  std::vector<double> x, x_after;
  Activities activities, activities_after;
  linalg::Vector impulses;  ///< Contacts::impulses()
  OpenMotion why_open;
};

class Recorder {
 public:
  explicit Recorder(const evaluation::ModelKernel& kernel);

  /// Lets every row from now on widen these: states, inputs, outputs (of which the last `selections` are cut to [0,
  /// 1]), selections by switching function. They must outlive this.
  void widen(ode::ColumnRanges& ranges, std::size_t selections) {
    ranges_ = &ranges;
    cut_outputs_ = selections;
  }
  /// Adds one row in a mode; `alpha` over switching functions (the sliding values at this point). Selections that
  /// nothing determines are recorded as NaN; outputs have the ones that they are handed.
  void row(double t, const std::vector<double>& x, const ModeState& state, const std::vector<double>& alpha);
  /// Adds a row with the mode before the events at t, of which this is the first one (or would be, if there are none).
  void row_before(double t, const std::vector<double>& x, const ModeState& before, long first_event);
  /// Records a switch, if a listed switching function changes its mode; returns whether it did. Cost: O(1) where one
  /// surface changes, which is listed then; the last mode recorded is the one before.
  bool switched(double t, const std::vector<double>& x, const ModeChange& change);
  /// Returns whether a surface is listed.
  [[nodiscard]] bool lists(int surface) const { return !listed_columns_[at(surface)].empty(); }
  /// Adds a row in the mode behind a change that was recorded last, with the selections of this point.
  void row_behind(const std::vector<double>& x, const ModeState& state, const std::vector<double>& alpha,
                  const ModeChange& change);
  /// Records a start on a surface or in a forced mode; `surfaces` at zero. Returns whether any of them is listed.
  bool started(double t, const std::vector<double>& x, const Transition& transition, const std::vector<int>& surfaces);
  /// Records an event of [[events]].
  void user(double t, const Passage& passage, int event);
  /// Records jumps executed at t one after the other; `transition` is the mode behind the last one, `before` null at a
  /// start.
  void jumped(double t, std::span<const ExecutedJump> jumps, const ModeState* before, const Transition& transition);
  /// Records the limit of a sequence of jumps, from the last computed state.
  void accumulated(double t, const std::vector<int>& jumps, const Passage& passage, std::string_view reason);
  /// Records the limit of a sequence of switches of these surfaces, from the last computed state; `transition` leads
  /// on.
  void spiralled(double t, const std::vector<int>& surfaces, const Passage& passage, const Transition& transition,
                 std::string_view why);

  [[nodiscard]] Recording take() { return std::move(recording_); }
  /// Returns whether there are so many rows or events that a run whose output is written on the way should hand them
  /// over.
  [[nodiscard]] bool has_many() const {
    return recording_.row_times.size() >= 1024 || recording_.event_list.size() >= 256;
  }
  /// Returns what has been recorded so far, between two steps; the recording goes on behind it.
  [[nodiscard]] Recording hand_over();
  [[nodiscard]] bool ends_at(double t) const { return rows() > 0 && last_row() == t; }
  /// Returns the time of the last row; there must be one.
  [[nodiscard]] double last_row() const {
    return recording_.row_times.empty() ? past_.last_row : recording_.row_times.back();
  }
  /// Returns `unique` of the last event; there must be one.
  [[nodiscard]] std::optional<bool> last_unique() const {
    return recording_.event_list.empty() ? past_.unique : recording_.event_list.back().unique;
  }
  [[nodiscard]] long events() const {
    return static_cast<long>(past_.event_times.size() + recording_.event_list.size());
  }
  [[nodiscard]] double event_time(long event) const {
    const std::size_t past = past_.event_times.size();
    return at(event) < past ? past_.event_times[at(event)] : recording_.event_list[at(event) - past].t;
  }
  /// Returns whether one of the last events is about a listed switching function.
  [[nodiscard]] bool switched_lately(int function, long events) const;
  [[nodiscard]] std::size_t rows() const { return past_.rows + recording_.row_times.size(); }

 private:
  /// A new event, with the activities of contacts on both sides; the reference is valid until the next one.
  Recording::Event& begin(double t, result::EventKind kind, const Activities& before, const Activities& after);
  Recording::Event& begin(double t, result::EventKind kind) {
    return begin(t, kind, kernel_.activities(), kernel_.activities());
  }
  void append_row(double t, const std::vector<double>& x, const std::vector<double>& alpha, std::size_t mode);
  void widen_ranges(const std::vector<double>& x, const std::vector<double>& alpha);
  [[nodiscard]] std::size_t keep(const std::vector<double>& x);
  [[nodiscard]] std::size_t number(const ModeState& state, const std::vector<double>& alpha,
                                   const HigherOrderSet* higher);
  [[nodiscard]] std::size_t number(const ModeState& state) { return number(state, state.alpha, state.higher.get()); }
  void set_states(Recording::Event& event, const std::vector<double>& x, const std::vector<double>& x_after);
  void set_passage(Recording::Event& event, const Passage& passage);
  void add_surface(Recording::Event& event, std::size_t surface);
  /// The place of a region of a group by `indicator` in the list of surfaces.
  [[nodiscard]] std::size_t surface_of_region(int function) const {
    return layout_.columns.size() + static_cast<std::size_t>(function);
  }
  void switched_single(double t, const std::vector<double>& x, const ModeChange& change);
  Recording::Range reason_of(const ModeChange& change);
  void note_changed_regions(const ModeState& before, const ModeState& after);
  void note_held_kinks(const ModeState& before, const ModeState& after);
  void add_reason(Recording::Event& event, std::string_view reason);
  void add_transition(Recording::Event& event, const Transition& transition);
  void add_transition(Recording::Event& event, const Transition& transition, std::size_t mode_after);

  /// What is known of rows and events that were handed over.
  struct Past {
    std::size_t rows = 0;
    double last_row = 0.0;
    std::vector<double> event_times;
    std::vector<std::vector<std::size_t>> surfaces;  ///< of the last events; of jumps none
    std::optional<bool> unique;                      ///< the last one
  };

  /// The last switch: the number of the mode before it.
  struct BeforeSwitch {
    long event = -1;
    std::size_t mode = 0;
  };

  /// Of the last switches of some surfaces, one after another: where its words stand in the recording.
  struct KnownReason {
    int surface = -1;
    int slid = -1;  ///< on which it goes on sliding
    std::string_view reason;
    Recording::Range place;
  };

  const evaluation::ModelKernel& kernel_;
  const model::Layout& layout_;
  Recording recording_;
  Past past_;
  ode::ColumnRanges* ranges_ = nullptr;  ///< nullptr: nobody asks for them
  std::size_t cut_outputs_ = 0;
  std::array<KnownReason, 16> known_reasons_;
  std::vector<std::vector<std::size_t>> listed_columns_;  ///< by switching function: of the result, if it is listed
  std::vector<std::size_t> changed_, columns_;            ///< of one event
  std::vector<int> listed_before_, listed_after_;
  BeforeSwitch before_switch_;
  std::vector<double> determined_;  ///< selections, NaN where nothing determines them
};

}  // namespace saltus::event_integrator
