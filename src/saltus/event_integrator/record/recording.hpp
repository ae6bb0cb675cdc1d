// What a run has recorded, compactly: numbers in a few long lists, modes by their differences, no text that is known
// elsewhere.
#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "saltus/event_integrator/choices.hpp"
#include "saltus/event_integrator/decide/transition.hpp"
#include "saltus/event_integrator/mode/mode_log.hpp"
#include "saltus/model/layout.hpp"
#include "saltus/result/result.hpp"

namespace saltus::event_integrator {

/// Holds rows and events in the order of time. What one event takes does not grow with the number of switching
/// functions; events() and trajectory() turn it into the columns of the result, by their names.
struct Recording {
  static constexpr std::size_t none = std::numeric_limits<std::size_t>::max();
  /// Holds the place of a part of a list.
  struct Range {
    std::size_t begin = 0;
    std::size_t end = 0;
  };
  struct Event {
    double t = 0.0;
    result::EventKind kind = result::EventKind::crossing;
    std::size_t entry = none;  ///< of [[jumps]] (kind jump) or [[events]] (kind user)
    std::size_t x = 0;         ///< places of n_x numbers in `states`
    std::size_t x_after = 0;   ///< behind the event; the same as `x` where the state does not jump
    std::size_t mode = none;   ///< number in `modes`
    std::size_t mode_after = none;
    std::size_t contacts = 0;  ///< place of 2 n_c numbers in `contact_states`: before and after
    Range impulses;            ///< in `impulses`
    std::optional<bool> unique = true;
    Range surfaces;  ///< in `surfaces`: columns of the result, behind them switching functions of regions; or jumps
    bool of_jumps = false;
    Range alternatives;          ///< in `alternatives`
    Range reason;                ///< in `text`
    std::size_t meeting = none;  ///< number in `meetings`
  };

  struct Alternative {
    std::vector<int> mode;
    std::vector<double> alpha;
  };

  /// Holds what result::Family has.
  struct Family {
    result::FamilyKind kind = result::FamilyKind::later_departure;
    std::size_t event = 0;
    double from = 0.0, until = 0.0;
    std::vector<int> mode;
    std::vector<double> alpha;
    std::optional<double> lap_ratio;
    long number = 0;  ///< in the run, when events have been dropped
  };

  std::size_t n_x = 0, n_u = 0, n_y = 0, n_c = 0;
  ModeLog modes;

  std::vector<Event> event_list;
  std::vector<double> states;       ///< at events
  std::vector<int> contact_states;  ///< model::Activity::State at events; negative while a slip goes down its tangent
  std::vector<double> impulses;     ///< Contacts::impulses()
  std::vector<std::size_t> surfaces;
  std::vector<Alternative> alternatives;
  std::vector<BranchPoint> branch_points;
  std::vector<Meeting> meetings;
  std::vector<Family> families;
  std::string text;

  std::vector<double> row_times;
  std::vector<double> row_states, row_inputs, row_outputs;  ///< n_x, n_u, n_y a row
  std::vector<std::size_t> row_modes;                       ///< numbers in `modes`
  std::vector<int> row_contacts;                            ///< n_c a row, as `contact_states`

  /// Takes away the first events and rows; families that are left belong to the first event that is.
  void drop(std::size_t events, std::size_t rows);
  /// Returns events and rows as the result has them. Cost: O(n_psi) for each.
  [[nodiscard]] result::Events events(const model::Layout& layout) const;
  /// Takes the numbers of the rows away.
  [[nodiscard]] result::Trajectory trajectory(const model::Layout& layout) &&;
  [[nodiscard]] std::vector<long> family_numbers() const;
  [[nodiscard]] std::vector<result::Family> listed_families(const model::Layout& layout) const;
  /// Returns the last row; there must be one.
  [[nodiscard]] result::Final last(const model::Layout& layout) const;
};

using TakeRecording = std::function<void(Recording)>;

}  // namespace saltus::event_integrator
