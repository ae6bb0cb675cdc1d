// What happens at points of time, and a list of it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "saltus/result/table.hpp"

namespace saltus::result {

/// k in {-1, 0, 1}^n_psi: the sign of psi_j, 0 while the solution slides on psi_j = 0.
using Mode = std::vector<int>;

enum class EventKind {
  start,
  crossing,
  enter_sliding,
  leave_sliding,
  change_sliding,
  accumulation,
  jump,
  user,
  impact,    ///< of contacts, with impulses
  contact,   ///< touch-down without an impact
  lift_off,  ///< the normal force ends
  stick,
  slip,
};
[[nodiscard]] std::string_view name(EventKind kind);
/// Returns the inverse of name; nullopt if there is none of that name.
[[nodiscard]] std::optional<EventKind> event_kind_named(std::string_view name);

/// Returns the kind of a switch from the components of the modes (docs/result-file.md).
[[nodiscard]] EventKind kind_of_switch(const Mode& before, const Mode& after);

/// The active modes of every group by `indicator`, in the order of the model; empty without such groups.
using Regions = std::vector<std::vector<std::string>>;

/// Names the modes of one contact: its gap is positive; or 0 without friction, with friction that holds, with friction
/// that yields.
enum class ContactMode { open, closed, stick, slip };
[[nodiscard]] std::string_view name(ContactMode mode);
/// Returns the inverse of name; nullopt if there is none of that name.
[[nodiscard]] std::optional<ContactMode> contact_mode_named(std::string_view name);

/// Holds a group of modes by `indicator`, of which those with the smallest one are active.
struct RegionGroup {
  std::string name;  ///< empty for the group without a name
  std::vector<std::string> modes;
  bool operator==(const RegionGroup&) const = default;
};
/// Returns the modes of all groups, one after the other, as columns: "mode", of a named group "group.mode".
[[nodiscard]] std::vector<std::string> region_labels(const std::vector<RegionGroup>& groups);

struct Alternative {
  Mode mode;
  std::vector<double> alpha;  ///< one per switching function; NaN where not determined
  Regions regions{};
};

/// Holds the fields where two surfaces that influence each other were met: what a picture of the decision needs.
struct Intersection {
  std::array<std::string, 2> surfaces;  ///< names of switching functions
  /// velocities[j][corner] is d psi_j / dt along the field of `corner`, whose bit i is the selection of surface i.
  std::array<std::array<double, 4>, 2> velocities{};
  std::optional<std::array<double, 2>> alpha_before;  ///< where the solution comes from; nullopt at a start
  std::array<double, 2> alpha_after{};                ///< of the mode that goes on
};

/// Holds one change of mode, jump or user event. Vectors over switching functions follow Result::switching_functions.
struct Event {
  double t = 0.0;
  EventKind kind = EventKind::crossing;
  std::optional<std::string> name;
  std::vector<std::string> surfaces;
  std::optional<Mode> mode_before, mode_after;
  std::optional<std::vector<double>> alpha_before, alpha_after;
  std::optional<Regions> regions_before, regions_after;
  std::vector<ContactMode> contact_modes_before{}, contact_modes_after{};  ///< by contact; empty without contacts
  std::optional<std::vector<std::vector<double>>> impulse{};  ///< of an impact, by contact: normal, tangential ones
  std::vector<double> x, x_after;
  std::optional<bool> unique = true;  ///< nullopt: not decided
  std::vector<Alternative> alternatives;
  std::string reason;
  std::optional<Intersection> intersection;
};

/// Returns what tables of numbers have for Event::unique: 1, 0, or -1 where it was not decided.
[[nodiscard]] constexpr int unique_number(std::optional<bool> unique) { return !unique ? -1 : *unique ? 1 : 0; }

/// Keeps events in their order, as columns: an event takes its states and what has changed since the one before it.
class Events {
 public:
  Events() = default;
  Events(std::initializer_list<Event> events) {
    for (const auto& event : events) push_back(event);
  }
  // NOLINTNEXTLINE(google-explicit-constructor): the same events
  Events(const std::vector<Event>& events) {
    for (const auto& event : events) push_back(event);
  }

  [[nodiscard]] std::size_t size() const { return t_.size(); }
  [[nodiscard]] bool empty() const { return t_.empty(); }
  /// Is an event by itself: a value, which cannot be changed in its place. Cost: O(n_x + n_psi).
  // NOLINTBEGIN(readability-const-return-type): what is written into a copy would be lost
  [[nodiscard]] const Event operator[](std::size_t number) const;
  [[nodiscard]] const Event front() const { return (*this)[0]; }
  [[nodiscard]] const Event back() const { return (*this)[size() - 1]; }
  // NOLINTEND(readability-const-return-type)
  [[nodiscard]] auto begin() const { return NumberedIterator<Events>(*this, 0); }
  [[nodiscard]] auto end() const { return NumberedIterator<Events>(*this, size()); }

  // NOLINTNEXTLINE(google-explicit-constructor): the same events
  operator std::vector<Event>() const { return {begin(), end()}; }

  // Parts of an event without the rest of it, valid until the list changes.
  [[nodiscard]] double t(std::size_t number) const { return t_[number]; }
  [[nodiscard]] EventKind kind(std::size_t number) const { return facts_[number].kind; }
  [[nodiscard]] std::string_view name(std::size_t number) const;  ///< empty if there is none
  [[nodiscard]] std::string_view reason(std::size_t number) const { return words_[facts_[number].reason]; }
  [[nodiscard]] std::vector<std::string> surfaces(std::size_t number) const;
  [[nodiscard]] std::optional<bool> unique(std::size_t number) const { return facts_[number].unique; }
  /// Returns how many continuations beside the one taken it has.
  [[nodiscard]] std::size_t alternatives(std::size_t number) const;
  [[nodiscard]] std::span<const double> x(std::size_t number) const;
  [[nodiscard]] std::span<const double> x_after(std::size_t number) const;
  using ModeRow = SteadyTable<signed char>::Row;
  using AlphaRow = SteadyTable<double>::Row;
  [[nodiscard]] std::optional<ModeRow> mode_before(std::size_t number) const { return row(modes_, 2 * number); }
  [[nodiscard]] std::optional<ModeRow> mode_after(std::size_t number) const { return row(modes_, 2 * number + 1); }
  [[nodiscard]] std::optional<AlphaRow> alpha_before(std::size_t number) const { return row(alphas_, 2 * number); }
  [[nodiscard]] std::optional<AlphaRow> alpha_after(std::size_t number) const { return row(alphas_, 2 * number + 1); }

  /// @param event  its vectors as long as those of the others
  void push_back(Event event);
  /// Holds a mode that differs from the one that was appended last in some columns at most.
  struct ModeChanges {
    const Mode& mode;
    const std::vector<double>& alpha;
    const std::vector<std::size_t>& columns;
  };
  /// Appends the mode before, and then that behind, an event; null: none. Cost: that of its columns.
  void add_side(const ModeChanges* changes);
  /// Appends the event to which both sides were added. It has neither modes nor states: these are `x` and, where it
  /// jumps, another `x_after`.
  void push_back(Event event, std::span<const double> x, std::span<const double> x_after);
  void pop_back();

 private:
  static constexpr std::uint32_t none = 0xffffffffU;
  /// Of one event.
  struct Facts {
    EventKind kind = EventKind::crossing;
    std::optional<bool> unique;
    std::uint32_t name = none, reason = 0;  ///< places in words_
    std::size_t surfaces = 0;               ///< where its surfaces begin in surfaces_
    std::size_t x = 0, x_after = 0;         ///< where its states begin in states_
  };
  /// Before and behind every event a row, which need not be there.
  template <class Number>
  struct Sides {
    SteadyTable<Number> rows;
    std::vector<bool> there;
  };
  template <class Number>
  [[nodiscard]] static std::optional<typename SteadyTable<Number>::Row> row(const Sides<Number>& sides,
                                                                            std::size_t number) {
    if (!sides.there[number]) return std::nullopt;
    return sides.rows[number];
  }
  template <class Number, class List>
  static void append(Sides<Number>& sides, const std::optional<List>& row) {
    sides.there.push_back(row.has_value());
    row ? sides.rows.push_back(*row) : sides.rows.repeat();
  }
  [[nodiscard]] std::uint32_t word(const std::string& text);
  void append_words(const Event& event, Facts& facts);

  std::vector<double> t_;
  std::vector<Facts> facts_;
  std::vector<double> states_;
  Sides<signed char> modes_;
  Sides<double> alphas_;
  std::vector<std::uint32_t> surfaces_;  ///< places in words_
  std::vector<std::string> words_;
  std::map<std::string, std::uint32_t, std::less<>> places_;  ///< of the words
  std::map<std::size_t, Event> rest_;                         ///< what few events have beside that
};

}  // namespace saltus::result
