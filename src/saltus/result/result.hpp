// One result for every method: plain data, everything a report needs.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "saltus/result/caption.hpp"
#include "saltus/result/comparison.hpp"
#include "saltus/result/drawing.hpp"
#include "saltus/result/elements.hpp"
#include "saltus/result/optimization.hpp"
#include "saltus/result/sensitivities.hpp"
#include "saltus/result/statistics.hpp"
#include "saltus/result/status.hpp"

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
/// The inverse of name; nullopt if there is none of that name.
[[nodiscard]] std::optional<EventKind> event_kind_named(std::string_view name);

/// The kind of a switch from the components of the modes (interface.md section 3).
[[nodiscard]] EventKind kind_of_switch(const Mode& before, const Mode& after);

/// The active modes of every group by `indicator`, in the order of the model; empty without such groups.
using Regions = std::vector<std::vector<std::string>>;

/// Of one contact: its gap is positive; or 0 without friction, with friction that holds, with friction that yields.
enum class ContactMode { open, closed, stick, slip };
[[nodiscard]] std::string_view name(ContactMode mode);
/// The inverse of name; nullopt if there is none of that name.
[[nodiscard]] std::optional<ContactMode> contact_mode_named(std::string_view name);

/// A group of modes by `indicator`, of which those with the smallest one are active.
struct RegionGroup {
  std::string name;  ///< empty for the group without a name
  std::vector<std::string> modes;
  bool operator==(const RegionGroup&) const = default;
};
/// The modes of all groups, one after the other, as columns: "mode", of a named group "group.mode".
[[nodiscard]] std::vector<std::string> region_labels(const std::vector<RegionGroup>& groups);

struct Alternative {
  Mode mode;
  std::vector<double> alpha;  ///< one per switching function; NaN where not determined
  Regions regions{};
};

/// The fields where two surfaces that influence each other were met: what a picture of the decision needs.
struct Intersection {
  std::array<std::string, 2> surfaces;  ///< names of switching functions
  /// velocities[j][corner] is d psi_j / dt along the field of `corner`, whose bit i is the selection of surface i.
  std::array<std::array<double, 4>, 2> velocities{};
  std::optional<std::array<double, 2>> alpha_before;  ///< where the solution comes from; nullopt at a start
  std::array<double, 2> alpha_after{};                ///< of the mode that goes on
};

/// One change of mode, jump or user event. Vectors over switching functions follow Result::switching_functions.
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

/// Rows; every event has two rows with the same time, before and behind it.
struct Trajectory {
  std::vector<double> t;
  std::vector<std::vector<double>> x, u, alpha;
  std::vector<Mode> mode;
  std::vector<std::vector<double>> outputs;
  /// With groups by `indicator` a row per time, else none: the active modes, and the weights of all (region_labels).
  std::vector<Regions> regions{};
  std::vector<std::vector<double>> theta{};
  std::vector<std::vector<ContactMode>> contact_modes{};  ///< with contacts a row per time, else none
};

/// 1 for a row behind another one at the same time, like the one behind an event; else 0.
[[nodiscard]] inline int side(const Trajectory& trajectory, std::size_t row) {
  return row > 0 && trajectory.t[row - 1] == trajectory.t[row] ? 1 : 0;
}

struct Final {
  double t = 0.0;
  std::vector<double> x;
  Mode mode;
  std::vector<double> alpha;
  std::vector<double> outputs;
  Regions regions{};
  std::vector<double> theta{};  ///< of all modes by `indicator`
  std::vector<ContactMode> contact_modes{};
};

/// A file that the model file, or a setting, names.
struct NamedFile {
  std::string name;  ///< as it was opened
  std::string sha256;
  std::optional<std::string> text;  ///< not of files of more than 10^6 bytes
};

/// An equation of a model: left = right.
struct StatedEquation {
  std::string left;   ///< "v'", "s", "v behind impact"
  std::string right;  ///< as it was read
  std::string where;  ///< where or when it holds; empty: everywhere
};

struct ModelRecord {
  std::string name;
  std::string description;
  std::string sha256;  ///< of the model file's bytes; empty for a model stated in C++
  std::vector<std::pair<std::string, double>> parameters;
  std::vector<std::pair<std::string, double>> initial_state{};
  // What it takes to run it again; empty for a model stated in C++.
  std::string file{};                       ///< its name, as it was opened
  std::string text{};                       ///< of the model file
  std::vector<NamedFile> files{};           ///< of a branch none: they are its root's
  std::vector<std::string> settings{};      ///< NAME=VALUE, in their order: of --set, then of the other options
  Captions captions{};                      ///< units and labels of its quantities
  std::vector<StatedEquation> equations{};  ///< the first ones; its text has all
};

/// What a surface belongs to.
enum class SurfaceRole {
  switching,  ///< a switching function: psi = 0
  jump,       ///< a guard of a jump
  region,     ///< the border of two regions by `indicator`
};
[[nodiscard]] std::string_view name(SurfaceRole role);
/// The inverse of name; nullopt if there is none of that name.
[[nodiscard]] std::optional<SurfaceRole> surface_role_named(std::string_view name);

/// gradient . x + rate t + constant = 0, the gradient over Surface::states.
struct AffineSurface {
  std::vector<double> gradient;
  double rate = 0.0;
  double constant = 0.0;
};

/// One connected piece of a surface: coordinates[i][k] is the coordinate of point k along Surface::states[i].
struct SurfaceCurve {
  std::vector<std::vector<double>> coordinates;
  std::optional<double> t{};  ///< when it lies there, for a surface that moves
};

/// Where a switching function or a guard is zero, or two regions meet, in the space of states: what a phase plane
/// needs.
struct Surface {
  std::string name;  ///< of the switching function, or of the jump; "a | b" of two regions
  SurfaceRole role = SurfaceRole::switching;
  std::vector<std::string> states;  ///< those it depends on, in the order of Result::states
  bool depends_on_time = false;
  std::optional<AffineSurface> affine;  ///< exact, of any number of states
  std::vector<AffineSurface> within{};  ///< the surface ends where one of these is < 0 (curves have ended there)
  /// Of other functions of one state (points) or two (polylines), within the range of the trajectory and a margin; at
  /// several times if it depends on time; none for functions of more states.
  std::vector<SurfaceCurve> curves;
};

/// Arrows of a drawing: where they begin and along what.
struct Arrows {
  std::vector<double> x, y, dx, dy;
};

/// The field of a model with two states at one time: what a phase plane needs.
struct VectorField {
  double t = 0.0;
  Arrows free;     ///< on a grid
  Arrows sides;    ///< just beside surfaces where the field jumps
  Arrows sliding;  ///< on those parts of surfaces where solutions slide
};

/// Dotted option name ("simulate.event.integrator") and its value in force; a vector for output times.
using OptionValue = std::variant<bool, std::int64_t, double, std::string, std::vector<double>>;
using OptionRecord = std::vector<std::pair<std::string, OptionValue>>;

enum class FamilyKind {
  later_departure,  ///< the mode may be left for another one at any time of an interval
  spiral,           ///< a spiral that leaves may begin with any phase
};
[[nodiscard]] std::string_view name(FamilyKind kind);
/// The inverse of name; nullopt if there is none of that name.
[[nodiscard]] std::optional<FamilyKind> family_kind_named(std::string_view name);

/// A continuum of solutions beside the one that is shown, with one parameter: the time at which they leave its mode, or
/// the phase of a spiral.
struct Family {
  FamilyKind kind = FamilyKind::later_departure;
  std::size_t event = 0;            ///< with which the mode, or the spiral, begins: number in the events, from 0
  double from = 0.0, until = 0.0;   ///< times at which they may leave; of a spiral both are the time of its event
  Alternative to;                   ///< what they leave into, with its selections at `from`
  std::optional<double> lap_ratio;  ///< of a spiral: from one lap to the next; the phase is the part of it, 0 to 1
};

/// Where a branch leaves its parent: at an event, or as a member of a family.
struct Departure {
  std::size_t event = 0;        ///< number in the events of the parent, from 0
  std::size_t alternative = 0;  ///< number in the alternatives of that event, from 0
  /// Of a member of a family: number in the families of the parent, and its time, or its phase.
  struct Member {
    std::size_t family = 0;
    double parameter = 0.0;
  };
  std::optional<Member> member{};
};

struct Result {
  ModelRecord model;
  std::string command = "simulate";
  std::string command_line;  ///< the call, without what says where its results go; empty if there was none
  std::string method = "event";
  Status status;
  std::vector<std::string> states, controls, switching_functions, outputs;
  std::vector<RegionGroup> region_groups;
  std::vector<std::string> contacts;
  Final final;
  std::vector<Event> events;
  Trajectory trajectory;
  Statistics statistics;  ///< of an optimisation those of Optimization are written instead
  OptionRecord options;
  std::optional<Drawing> drawing;           ///< of a mechanical system that says what is drawn
  std::optional<double> penetration;        ///< with contacts: the largest depth -gap of all rows, 0 without any
  std::vector<Surface> surfaces;            ///< empty unless asked for (pipeline::surfaces)
  std::optional<VectorField> vector_field;  ///< of a model with two states, if asked for (pipeline::vector_field)

  std::optional<Sensitivities> sensitivities;  ///< of the end state, if asked for
  std::optional<Elements> elements;            ///< of methods made of finite elements, unless there are too many

  std::vector<Family> families;  ///< other solutions that no list of events can hold, by event

  std::optional<Optimization> optimization;  ///< of `optimize`

  /// Of `compare` and `order`, whose reference run the rest of the result is.
  std::optional<Comparison> comparison;
  std::optional<OrderStudy> order;

  /// Of a branch. It has that event, with the mode that was taken, as its first event.
  std::optional<Departure> left_at;
  /// Other continuations that were followed, each to the end; by event, then by alternative.
  std::vector<Result> branches;
};

/// A trajectory of a tree of branches.
struct TreeEntry {
  const Result* result = nullptr;
  std::string label;   ///< "2.1": first branch of the second branch; empty for the root
  std::size_t parent;  ///< number of the entry that it left; of the root its own, 0
};
/// A result and all its branches, parents before their branches, depth first.
[[nodiscard]] std::vector<TreeEntry> tree(const Result& root);

/// How many admissible continuations of the trajectory itself, not of its branches, were listed and not followed.
[[nodiscard]] std::size_t not_followed(const Result& result);

}  // namespace saltus::result
