// What several engines, or one engine at several step sizes, gave for one model.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "saltus/result/statistics.hpp"
#include "saltus/result/status.hpp"

namespace saltus::result {

/// Holds one engine's run of the model, or why there is none.
struct ComparedRun {
  std::string method;   ///< event, fesd, timestepping or smoothed
  std::string variant;  ///< what tells it from the others of its method: "dop853", "radau_iia 2, stewart"
  std::string reason;   ///< why there is no run; empty if there is one, and only then the rest holds
  Status status;
  std::vector<double> x;                         ///< n_x, at the time of the comparison; empty if not reached
  std::optional<std::int64_t> switches;          ///< changes of mode and jumps; nullopt for a method without modes
  std::optional<double> last_switch;             ///< its time
  std::optional<double> state_difference;        ///< max_i |x_i - x_i of the reference| at that time
  std::optional<double> switch_time_difference;  ///< max_k |t_k - t_k of the reference|; nullopt if the numbers differ
  Statistics statistics;
};

struct Comparison {
  std::vector<ComparedRun> runs;
  std::optional<double> time;  ///< of the states: the end, or the last time that all runs (but hopeless ones) reach
  std::size_t reference = 0;   ///< number in `runs`
};

/// Holds a scheme at one number of steps.
struct OrderPoint {
  std::int64_t steps = 0;
  double mean_step = 0.0;       ///< length of the run by the number of finite elements
  std::optional<double> error;  ///< max_i |x_i - x_i of the reference| at the end; nullopt: it stopped early
  std::optional<double> switch_time_error;  ///< max_k |t_k - t_k of the reference|; nullopt if the numbers differ
  std::string reason;                       ///< why there is no error
  double wall_seconds = 0.0;
};

/// Holds one scheme over step sizes; slopes are those of log(error) over log(mean step), fitted to what is above the
/// floor.
struct OrderSeries {
  std::string method;  ///< fesd, or timestepping: without switch detection
  std::string scheme;
  std::int64_t stages = 0;
  std::string reformulation;
  std::vector<OrderPoint> points;
  std::optional<double> slope;              ///< of the error of the end state
  std::optional<double> switch_time_slope;  ///< of the error of the switching times
};

struct OrderStudy {
  std::string reference;    ///< "event, dop853, rtol 1e-13, atol 1e-15"
  double floor = 0.0;       ///< errors of end states below this are those of the reference or of rounding
  double time_floor = 0.0;  ///< the same for switching times
  std::vector<OrderSeries> series;
};

}  // namespace saltus::result
