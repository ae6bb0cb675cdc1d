// One result for every method: plain data, everything a report needs.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
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
#include "saltus/result/error_estimate.hpp"
#include "saltus/result/events.hpp"
#include "saltus/result/optimization.hpp"
#include "saltus/result/sensitivities.hpp"
#include "saltus/result/statistics.hpp"
#include "saltus/result/status.hpp"
#include "saltus/result/table.hpp"

namespace saltus::result {

/// Holds rows; every event has two rows with the same time, before and behind it.
struct Trajectory {
  std::vector<double> t;
  Table<double> x, u;
  SteadyTable<double> alpha;
  SteadyTable<signed char> mode;
  Table<double> outputs;
  /// With groups by `indicator` a row per time, else none: the active modes, and the weights of all (region_labels).
  SteadyList<Regions> regions{};
  SteadyTable<double> theta{};
  SteadyTable<ContactMode> contact_modes{};  ///< with contacts a row per time, else none

  /// Leaves these rows, ascending.
  void keep(const std::vector<std::size_t>& rows);
  /// Appends a row of another one with the same columns.
  void append(const Trajectory& from, std::size_t row);
};

/// Returns 1 for a row behind another one at the same time, like the one behind an event; else 0.
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

/// Holds a file that the model file, or a setting, names.
struct NamedFile {
  std::string name;  ///< as it was opened
  std::string sha256;
  std::optional<std::string> text;  ///< not of files of more than 10^6 bytes
};

/// Holds an equation of a model: left = right.
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

/// Says what a surface belongs to.
enum class SurfaceRole {
  switching,  ///< a switching function: psi = 0
  jump,       ///< a guard of a jump
  region,     ///< the border of two regions by `indicator`
};
[[nodiscard]] std::string_view name(SurfaceRole role);
/// Returns the inverse of name; nullopt if there is none of that name.
[[nodiscard]] std::optional<SurfaceRole> surface_role_named(std::string_view name);

/// Is gradient . x + rate t + constant = 0, the gradient over Surface::states.
struct AffineSurface {
  std::vector<double> gradient;
  double rate = 0.0;
  double constant = 0.0;
};

/// Holds one connected piece of a surface: coordinates[i][k] is the coordinate of point k along Surface::states[i].
struct SurfaceCurve {
  std::vector<std::vector<double>> coordinates;
  std::optional<double> t{};  ///< when it lies there, for a surface that moves
};

/// Is where a switching function or a guard is zero, or two regions meet, in the space of states: what a phase plane
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

/// Holds the arrows of a drawing: where they begin and along what.
struct Arrows {
  std::vector<double> x, y, dx, dy;
};

/// Holds the field of a model with two states at one time: what a phase plane needs.
struct VectorField {
  double t = 0.0;
  Arrows free;     ///< on a grid
  Arrows sides;    ///< just beside surfaces where the field jumps
  Arrows sliding;  ///< on those parts of surfaces where solutions slide
};

/// Dotted option name ("simulate.event.integrator") and its value in force; lists of output times, and of names.
using OptionValue =
    std::variant<bool, std::int64_t, double, std::string, std::vector<double>, std::vector<std::string>>;
using OptionRecord = std::vector<std::pair<std::string, OptionValue>>;

enum class FamilyKind {
  later_departure,  ///< the mode may be left for another one at any time of an interval
  spiral,           ///< a spiral that leaves may begin with any phase
};
[[nodiscard]] std::string_view name(FamilyKind kind);
/// Returns the inverse of name; nullopt if there is none of that name.
[[nodiscard]] std::optional<FamilyKind> family_kind_named(std::string_view name);

/// Holds a continuum of solutions beside the one that is shown, with one parameter: the time at which they leave its
/// mode, or the phase of a spiral.
struct Family {
  FamilyKind kind = FamilyKind::later_departure;
  std::size_t event = 0;            ///< with which the mode, or the spiral, begins: number in the events, from 0
  double from = 0.0, until = 0.0;   ///< times at which they may leave; of a spiral both are the time of its event
  Alternative to;                   ///< what they leave into, with its selections at `from`
  std::optional<double> lap_ratio;  ///< of a spiral: from one cycle to the next; the phase is the part of it, 0 to 1
};

/// Describes a member of a family: number in the families of the parent, and its time, or its phase.
struct FamilyMember {
  std::size_t family = 0;
  double parameter = 0.0;
};

/// Says where a branch leaves its parent: at an event, or as a member of a family.
struct Departure {
  std::size_t event = 0;        ///< number in the events of the parent, from 0
  std::size_t alternative = 0;  ///< number in the alternatives of that event, from 0
  std::optional<FamilyMember> member{};
};

/// Says, of rows and events that were passed on while they were computed: what is known without them.
struct PassedOn {
  std::size_t rows = 0, events = 0;
  std::size_t alternatives = 0;              ///< in the events
  std::map<EventKind, std::size_t> kinds{};  ///< how many events of each
  std::vector<double> least, greatest;       ///< of every state, in rows and events; NaN left out
};

/// Holds columns that the rows of a trajectory have where those are not all: numbers in the lists of the result,
/// ascending.
struct KeptColumns {
  std::vector<std::size_t> states;               ///< of x
  std::vector<std::size_t> switching_functions;  ///< of alpha and mode
  bool operator==(const KeptColumns&) const = default;
};

class Continuous;

struct Result {
  ModelRecord model;
  std::string command = "simulate";
  std::string command_line;  ///< the call, without what says where its results go; empty if there was none
  std::string date;          ///< when it was computed: ISO 8601, UTC; empty if nobody noted it
  std::string method = "event";
  Status status;
  std::vector<std::string> states, controls, switching_functions, outputs;
  std::vector<RegionGroup> region_groups;
  std::vector<std::string> contacts;
  Final final;
  Events events;
  Trajectory trajectory;
  std::optional<KeptColumns> kept;    ///< what the rows have of them; end state and events always have all
  std::optional<PassedOn> passed_on;  ///< then the trajectory has no rows, and of the events at most some are left
  Statistics statistics;              ///< of an optimisation those of Optimization are written instead
  OptionRecord options;
  std::optional<Drawing> drawing;           ///< of a mechanical system that says what is drawn
  std::optional<double> penetration;        ///< with contacts: the largest depth -gap of all rows, 0 without any
  std::vector<Surface> surfaces;            ///< empty unless asked for (pipeline::surfaces)
  std::optional<VectorField> vector_field;  ///< of a model with two states, if asked for (pipeline::vector_field)

  std::optional<ErrorEstimate> error_estimate;  ///< if asked for

  std::optional<Sensitivities> sensitivities;  ///< of the end state, if asked for
  std::optional<Elements> elements;            ///< of methods made of finite elements, unless there are too many

  std::vector<Family> families;  ///< other solutions that no list of events can hold, by event

  std::optional<Optimization> optimization;  ///< of `optimize`

  /// Of `compare` and `order`, whose reference run the rest of the result is.
  std::optional<Comparison> comparison;
  std::optional<OrderStudy> order;

  std::shared_ptr<Continuous> continuous;  ///< between the rows, if asked for; in no file

  /// Of a branch. It has that event, with the mode that was taken, as its first event.
  std::optional<Departure> left_at;
  /// Other continuations that were followed, each to the end; by event, then by alternative.
  std::vector<Result> branches;
};

/// Holds a trajectory of a tree of branches.
struct TreeEntry {
  const Result* result = nullptr;
  std::string label;   ///< "2.1": first branch of the second branch; empty for the root
  std::size_t parent;  ///< number of the entry that it left; of the root its own, 0
};
/// Returns a result and all its branches, parents before their branches, depth first.
[[nodiscard]] std::vector<TreeEntry> tree(const Result& root);

/// Returns how many admissible continuations of the trajectory itself, not of its branches, were listed and not
/// followed.
[[nodiscard]] std::size_t not_followed(const Result& result);

}  // namespace saltus::result
