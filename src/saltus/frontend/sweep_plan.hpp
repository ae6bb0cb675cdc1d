// Which values every run of a sweep has.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "saltus/base/error.hpp"

namespace saltus::frontend {

struct SweepRequest {
  std::vector<std::string> over;     ///< NAME=A:B:N or NAME=V1,V2,…
  bool paired = false;               ///< values of equal number, one by one, instead of a grid
  std::vector<std::string> samples;  ///< NAME=normal(m,s), uniform(a,b) or lognormal(m,s)
  std::optional<long> runs;          ///< samples of every point of the grid
  std::uint64_t seed = 1;
  bool confirmed = false;  ///< also more than unconfirmed_runs
};

inline constexpr std::size_t unconfirmed_runs = 10'000'000;

/// Holds the values of all runs, made when they are asked for. The last axis of a grid changes fastest, samples within
/// it.
class SweepPlan {
 public:
  /// Fails (parse_failure, invalid_option) for these:
  /// - what is no range, list or distribution, and empty ones;
  /// - a name twice, and pairs of different length;
  /// - samples without a number of runs, and too many runs.
  [[nodiscard]] static Expected<SweepPlan> make(const SweepRequest& request);

  [[nodiscard]] std::size_t runs() const { return runs_; }
  /// Returns what is changed, as it was typed: axes, then samples.
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  /// Returns the flag by which names()[k] was given: "--over" or "--sample".
  [[nodiscard]] std::string flag(std::size_t k) const { return k < axes_.size() ? "--over" : "--sample"; }
  /// Returns all values of names()[k] that are listed; none of random samples.
  [[nodiscard]] const std::vector<std::string>& listed(std::size_t k) const {
    static const std::vector<std::string> none;
    return k < axes_.size() ? axes_[k].values : none;
  }
  /// Returns values as text, one per name; depends on seed and run only.
  [[nodiscard]] std::vector<std::string> values(std::size_t run) const;

 private:
  enum class Kind { normal, uniform, lognormal };
  struct Axis {
    std::vector<std::string> values;
  };
  struct Distribution {
    Kind kind = Kind::normal;
    double first = 0.0, second = 1.0;
  };
  friend class PlanReader;

  std::vector<std::string> names_;
  std::vector<Axis> axes_;
  std::vector<Distribution> distributions_;
  bool paired_ = false;
  std::size_t samples_ = 1;
  std::size_t runs_ = 1;
  std::uint64_t seed_ = 1;
};

/// What --over takes.
inline constexpr std::string_view over_remedy =
    "for example --over mu=0.05:0.3:100 (100 values, both ends among them) or --over k=1,2,4";

/// Returns whether a value of --over is a piece of how other programs list them: 1..5, [1, 2], {1, 2}, 1 2 3.
[[nodiscard]] bool is_list_of_others(std::string_view piece);

}  // namespace saltus::frontend
