// The records of a result file: what their members are called.
#pragma once

#include <tuple>

#include "saltus/io/json/json_records_internal.hpp"
#include "saltus/result/comparison.hpp"
#include "saltus/result/elements.hpp"
#include "saltus/result/mpcc_result.hpp"
#include "saltus/result/optimization.hpp"
#include "saltus/result/result.hpp"
#include "saltus/result/sensitivities.hpp"

namespace saltus::io {

template <>
inline constexpr EnumWords<result::Termination> enum_words<result::Termination>{result::termination_named,
                                                                                "termination"};
template <>
inline constexpr EnumWords<result::HomotopyPhase> enum_words<result::HomotopyPhase>{result::homotopy_phase_named,
                                                                                    "phase"};
template <>
inline constexpr EnumWords<result::StationarityType> enum_words<result::StationarityType>{
    result::stationarity_type_named, "type of stationarity"};
template <>
inline constexpr EnumWords<result::SelectionForm> enum_words<result::SelectionForm>{result::selection_form_named,
                                                                                    "form of a selection"};
template <>
inline constexpr EnumWords<result::SurfaceRole> enum_words<result::SurfaceRole>{result::surface_role_named,
                                                                                "role of a surface"};
template <>
inline constexpr EnumWords<result::FamilyKind> enum_words<result::FamilyKind>{result::family_kind_named,
                                                                              "kind of a family"};
template <>
inline constexpr EnumWords<result::EventKind> enum_words<result::EventKind>{result::event_kind_named, "kind of event"};

template <>
struct RecordMembers<result::Caption> {
  using R = result::Caption;
  static constexpr auto list =
      std::make_tuple(field("unit", &R::unit, Presence::later), field("label", &R::label, Presence::later));
};

template <>
struct RecordMembers<result::NamedFile> {
  using R = result::NamedFile;
  static constexpr auto list =
      std::make_tuple(field("name", &R::name), field("sha256", &R::sha256), field("text", &R::text));
};

template <>
struct RecordMembers<result::StatedEquation> {
  using R = result::StatedEquation;
  static constexpr auto list =
      std::make_tuple(field("left", &R::left), field("right", &R::right), field("where", &R::where, Presence::later));
};

template <>
struct RecordMembers<result::Status> {
  using R = result::Status;
  static constexpr auto list = std::make_tuple(field("termination", &R::termination), field("message", &R::message),
                                               field("time_reached", &R::time_reached));
};

template <>
struct RecordMembers<result::IntegratorUse> {
  using R = result::IntegratorUse;
  static constexpr auto list =
      std::make_tuple(field("name", &R::name), field("steps", &R::steps), field("time", &R::time));
};

template <>
struct RecordMembers<result::Statistics> {
  using R = result::Statistics;
  static constexpr auto list = std::make_tuple(
      field("steps", &R::steps), field("rejected", &R::rejected), field("rhs_evaluations", &R::rhs_evaluations),
      field("wall_seconds", &R::wall_seconds), field("integrators", &R::integrators, Presence::if_any),
      field("thinned_from", &R::thinned_from, Presence::if_any),
      field("error_estimate", &R::error_estimate, Presence::if_any));
};

template <>
struct RecordMembers<result::RegionGroup> {
  using R = result::RegionGroup;
  static constexpr auto list = std::make_tuple(field("name", &R::name), field("modes", &R::modes));
};

template <>
struct RecordMembers<result::Final> {
  using R = result::Final;
  static constexpr auto list = std::make_tuple(
      field("t", &R::t), field("x", &R::x), field("mode", &R::mode), field("alpha", &R::alpha),
      field("outputs", &R::outputs), field("regions", &R::regions, Presence::if_any),
      field("theta", &R::theta, Presence::if_any), field("contact_modes", &R::contact_modes, Presence::if_any));
};

template <>
struct RecordMembers<result::Alternative> {
  using R = result::Alternative;
  static constexpr auto list = std::make_tuple(field("mode", &R::mode), field("alpha", &R::alpha),
                                               field("regions", &R::regions, Presence::if_any));
};

template <>
struct RecordMembers<result::Intersection> {
  using R = result::Intersection;
  static constexpr auto list =
      std::make_tuple(field("surfaces", &R::surfaces), field("velocities", &R::velocities),
                      field("alpha_before", &R::alpha_before), field("alpha_after", &R::alpha_after));
};

template <>
struct RecordMembers<result::Event> {
  using R = result::Event;
  static constexpr auto list = std::make_tuple(
      field("t", &R::t), field("kind", &R::kind), field("name", &R::name), field("surfaces", &R::surfaces),
      field("mode_before", &R::mode_before), field("mode_after", &R::mode_after),
      field("alpha_before", &R::alpha_before), field("alpha_after", &R::alpha_after),
      field("regions_before", &R::regions_before, Presence::if_any),
      field("regions_after", &R::regions_after, Presence::if_any),
      field("contact_modes_before", &R::contact_modes_before, Presence::if_any),
      field("contact_modes_after", &R::contact_modes_after, Presence::if_any),
      field("impulse", &R::impulse, Presence::if_any), field("x", &R::x), field("x_after", &R::x_after),
      field("unique", &R::unique), field("alternatives", &R::alternatives), field("reason", &R::reason),
      field("intersection", &R::intersection, Presence::if_any));
};

template <>
struct RecordMembers<result::Trajectory> {
  using R = result::Trajectory;
  static constexpr auto list = std::make_tuple(
      field("t", &R::t), field("x", &R::x), field("u", &R::u), field("alpha", &R::alpha), field("mode", &R::mode),
      field("outputs", &R::outputs), field("regions", &R::regions, Presence::if_any),
      field("theta", &R::theta, Presence::if_any), field("contact_modes", &R::contact_modes, Presence::if_any));
};

template <>
struct RecordMembers<result::ErrorEstimate> {
  using R = result::ErrorEstimate;
  static constexpr auto list =
      std::make_tuple(field("ratio", &R::ratio), field("x", &R::x), field("event_times", &R::event_times),
                      field("final", &R::final), field("parted_at", &R::parted_at, Presence::if_any));
};

template <>
struct RecordMembers<result::Family> {
  using R = result::Family;
  static constexpr auto list = std::make_tuple(field("kind", &R::kind), field("event", &R::event),
                                               field("from", &R::from), field("until", &R::until), field("to", &R::to),
                                               field("lap_ratio", &R::lap_ratio, Presence::if_any));
};

template <>
struct RecordMembers<result::AffineSurface> {
  using R = result::AffineSurface;
  static constexpr auto list =
      std::make_tuple(field("gradient", &R::gradient), field("rate", &R::rate), field("constant", &R::constant));
};

template <>
struct RecordMembers<result::SurfaceCurve> {
  using R = result::SurfaceCurve;
  static constexpr auto list = std::make_tuple(field("t", &R::t), field("coordinates", &R::coordinates));
};

template <>
struct RecordMembers<result::Surface> {
  using R = result::Surface;
  static constexpr auto list =
      std::make_tuple(field("name", &R::name), field("role", &R::role), field("states", &R::states),
                      field("depends_on_time", &R::depends_on_time), field("affine", &R::affine),
                      field("within", &R::within, Presence::if_any), field("curves", &R::curves));
};

template <>
struct RecordMembers<result::Arrows> {
  using R = result::Arrows;
  static constexpr auto list =
      std::make_tuple(field("x", &R::x), field("y", &R::y), field("dx", &R::dx), field("dy", &R::dy));
};

template <>
struct RecordMembers<result::VectorField> {
  using R = result::VectorField;
  static constexpr auto list = std::make_tuple(field("t", &R::t), field("free", &R::free), field("sides", &R::sides),
                                               field("sliding", &R::sliding));
};

template <>
struct RecordMembers<result::Sensitivities> {
  using R = result::Sensitivities;
  static constexpr auto list =
      std::make_tuple(field("x0", &R::x0), field("p", &R::p), field("parameters", &R::parameters));
};

template <>
struct RecordMembers<result::ElementSelection> {
  using R = result::ElementSelection;
  static constexpr auto list = std::make_tuple(field("name", &R::name), field("form", &R::form));
};

template <>
struct RecordMembers<result::Elements> {
  using R = result::Elements;
  static constexpr auto list =
      std::make_tuple(field("points", &R::points), field("selections", &R::selections), field("t", &R::t),
                      field("lambda", &R::lambda), field("selection", &R::selection));
};

template <>
struct RecordMembers<result::ComparedRun> {
  using R = result::ComparedRun;
  static constexpr auto list = std::make_tuple(
      field("method", &R::method), field("variant", &R::variant), field("reason", &R::reason, Presence::if_any),
      field("status", &R::status), field("x", &R::x), field("switches", &R::switches),
      field("last_switch", &R::last_switch), field("state_difference", &R::state_difference),
      field("switch_time_difference", &R::switch_time_difference), field("statistics", &R::statistics));
};

template <>
struct RecordMembers<result::OrderPoint> {
  using R = result::OrderPoint;
  static constexpr auto list =
      std::make_tuple(field("steps", &R::steps), field("mean_step", &R::mean_step), field("error", &R::error),
                      field("switch_time_error", &R::switch_time_error), field("reason", &R::reason, Presence::if_any),
                      field("wall_seconds", &R::wall_seconds));
};

template <>
struct RecordMembers<result::OrderSeries> {
  using R = result::OrderSeries;
  static constexpr auto list =
      std::make_tuple(field("method", &R::method), field("scheme", &R::scheme), field("stages", &R::stages),
                      field("reformulation", &R::reformulation), field("slope", &R::slope),
                      field("switch_time_slope", &R::switch_time_slope), field("points", &R::points));
};

template <>
struct RecordMembers<result::OrderStudy> {
  using R = result::OrderStudy;
  static constexpr auto list = std::make_tuple(field("reference", &R::reference), field("floor", &R::floor),
                                               field("time_floor", &R::time_floor), field("series", &R::series));
};

template <>
struct RecordMembers<result::ObjectiveTerms> {
  using R = result::ObjectiveTerms;
  static constexpr auto list = std::make_tuple(field("running", &R::running), field("terminal", &R::terminal),
                                               field("least_squares", &R::least_squares), field("time", &R::time),
                                               field("penalties", &R::penalties));
};

template <>
struct RecordMembers<result::ConstraintMultiplier> {
  using R = result::ConstraintMultiplier;
  static constexpr auto list = std::make_tuple(field("name", &R::name), field("time", &R::time),
                                               field("value", &R::value), field("range", &R::range, Presence::if_any));
};

template <>
struct RecordMembers<result::HomotopyStep> {
  using R = result::HomotopyStep;
  static constexpr auto list = std::make_tuple(
      field("phase", &R::phase), field("solver", &R::solver), field("sigma", &R::sigma),
      field("iterations", &R::iterations), field("objective", &R::objective),
      field("primal_infeasibility", &R::primal_infeasibility),
      field("complementarity_residual", &R::complementarity_residual), field("termination", &R::termination),
      field("seconds", &R::seconds), field("message", &R::message, Presence::if_any));
};

template <>
struct RecordMembers<result::StartOutcome> {
  using R = result::StartOutcome;
  static constexpr auto list =
      std::make_tuple(field("seed", &R::seed), field("termination", &R::termination), field("objective", &R::objective),
                      field("infeasibility", &R::infeasibility), field("iterations", &R::iterations),
                      field("seconds", &R::seconds), field("is_taken", &R::is_taken));
};

template <>
struct RecordMembers<result::Certificate> {
  using R = result::Certificate;
  static constexpr auto list = std::make_tuple(
      field("primal_infeasibility", &R::primal_infeasibility),
      field("complementarity_residual", &R::complementarity_residual), field("stationarity", &R::stationarity),
      field("biactive", &R::biactive), field("stationarity_type", &R::stationarity_type),
      field("b_stationary", &R::b_stationary), field("lpcc_decrease", &R::lpcc_decrease),
      field("other_sides_tried", &R::other_sides_tried, Presence::later), field("licq", &R::licq, Presence::later),
      field("dependent_rows", &R::dependent_rows, Presence::later), field("dependent", &R::dependent, Presence::if_any),
      field("unique_multipliers", &R::unique_multipliers, Presence::later),
      field("strict_complementarity", &R::strict_complementarity, Presence::later),
      field("ulsc", &R::ulsc, Presence::later), field("sosc", &R::sosc, Presence::later));
};

template <>
struct RecordMembers<result::FeedbackGain> {
  using R = result::FeedbackGain;
  static constexpr auto list = std::make_tuple(field("t", &R::t), field("interval", &R::interval), field("K", &R::K));
};

template <>
struct RecordMembers<result::OpenLoop> {
  using R = result::OpenLoop;
  static constexpr auto list = std::make_tuple(
      field("end_state_error", &R::end_state_error), field("terminal_violation", &R::terminal_violation),
      field("termination", &R::termination), field("amplification", &R::amplification), field("message", &R::message),
      field("t", &R::t), field("x", &R::x), field("gains", &R::gains, Presence::if_any));
};

template <>
struct RecordMembers<result::Penetration> {
  using R = result::Penetration;
  static constexpr auto list = std::make_tuple(field("solution", &R::solution), field("simulation", &R::simulation));
};

template <>
struct RecordMembers<result::PathViolation> {
  using R = result::PathViolation;
  static constexpr auto list = std::make_tuple(field("name", &R::name), field("time", &R::time),
                                               field("value", &R::value), field("share", &R::share));
};

template <>
struct RecordMembers<result::Verification> {
  using R = result::Verification;
  static constexpr auto list = std::make_tuple(
      field("tolerance", &R::tolerance), field("interval_defect", &R::interval_defect),
      field("interval", &R::interval, Presence::not_negative), field("state", &R::state),
      field("switch_time_error", &R::switch_time_error), field("switches_missed", &R::switches_missed),
      field("switches_extra", &R::switches_extra), field("path_violation", &R::path_violation),
      field("message", &R::message), field("open_loop", &R::open_loop),
      field("closed_loop", &R::closed_loop, Presence::if_any), field("plant", &R::plant, Presence::if_any),
      field("penetration", &R::penetration, Presence::if_any),
      field("path_violations", &R::path_violations, Presence::if_any));
};

template <>
struct RecordMembers<result::OptimizationStatistics> {
  using R = result::OptimizationStatistics;
  static constexpr auto list = std::make_tuple(
      field("iterations", &R::iterations), field("variables", &R::variables), field("equations", &R::equations),
      field("pairs", &R::pairs), field("build_seconds", &R::build_seconds),
      field("evaluation_seconds", &R::evaluation_seconds), field("linear_algebra_seconds", &R::linear_algebra_seconds),
      field("wall_seconds", &R::wall_seconds));
};

template <>
struct RecordMembers<result::PresolveCounts> {
  using R = result::PresolveCounts;
  static constexpr auto list =
      std::make_tuple(field("fixed_variables", &R::fixed_variables), field("empty_rows", &R::empty_rows),
                      field("forced_pairs", &R::forced_pairs), field("fixed_pairs", &R::fixed_pairs),
                      field("infeasible", &R::infeasible, Presence::if_any));
};

template <>
struct RecordMembers<result::MpccMultipliers::Range> {
  using R = result::MpccMultipliers::Range;
  static constexpr auto list =
      std::make_tuple(field("row", &R::row), field("name", &R::name), field("range", &R::range));
};

template <>
struct RecordMembers<result::MpccMultipliers> {
  using R = result::MpccMultipliers;
  static constexpr auto list =
      std::make_tuple(field("rows", &R::rows), field("lower", &R::lower), field("upper", &R::upper), field("G", &R::G),
                      field("H", &R::H), field("not_unique", &R::not_unique, Presence::if_any));
};

template <>
struct RecordMembers<result::Optimization> {
  using R = result::Optimization;
  static constexpr auto list = std::make_tuple(
      field("objective", &R::objective), field("objective_terms", &R::terms), field("horizon", &R::horizon),
      field("parameters", &R::parameters), field("u", &R::u), field("grid", &R::grid), field("h", &R::h),
      field("speed_of_time", &R::speed_of_time, Presence::if_any), field("multipliers", &R::multipliers),
      field("homotopy", &R::homotopy), field("starts", &R::starts, Presence::if_any),
      field("certificate", &R::certificate), field("verification", &R::verification, Presence::if_any));
};

/// Names what another run begins with: bounds, states at the ends of intervals, and the vectors of the transcription.
struct StartValues {
  using R = result::Optimization;
  static constexpr auto list = std::make_tuple(
      field("nodes", &R::nodes), field("state_lower", &R::state_lower), field("state_upper", &R::state_upper),
      field("control_lower", &R::control_lower), field("control_upper", &R::control_upper), field("primal", &R::primal),
      field("dual_rows", &R::dual_rows), field("dual_lower", &R::dual_lower), field("dual_upper", &R::dual_upper));
};

[[nodiscard]] Json comparison_json(const result::Comparison& comparison);
void read_comparison(JsonReader& reader, const Json& json, const std::string& path,
                     std::optional<result::Comparison>& comparison);

}  // namespace saltus::io
