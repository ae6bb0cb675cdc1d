// Does a trajectory of the hidden dynamics come back to where it was?
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "saltus/base/at.hpp"

namespace saltus::switching {

/// Says what the trajectory was doing between two passages of one section, in the same zones and direction.
struct Turn {
  enum class Kind { none, cycle, spiral_out } kind = Kind::none;
  double remaining = 0.0;    ///< how far the limit of the passages is still away
  std::vector<int> side;     ///< m: 0 if the selection varied, else the side on which u_j stayed
  std::vector<double> mean;  ///< m: selections averaged over the turn
  /// Turns that can be skipped before the first saturated component is back, whose distance shrinks by `change` per
  /// turn: 0 where all go outwards.
  double turns_to_skip = 0.0;
  std::vector<double> change;  ///< m: of u_j in a turn
};

/// Notes passages of sections: changes of zone, and maxima of components inside a zone. A passage is compared with up
/// to four earlier ones of the same section (cycles may pass a section more than once).
///
/// A limit cycle is taken for proven in two cases, between passages with turns of one duration. The distances of
/// successive passages shrink geometrically towards a limit that is close, or they are 0 up to rounding. A spiral, and
/// a limit cycle of slow attraction, are taken for proven where only closed-form zones were visited. There the return
/// map is affine, and the ratio of two distances is its factor.
class Recurrence {
 public:
  explicit Recurrence(int surfaces);
  /// Forgets everything, for a new trajectory.
  void reset();

  /// Accumulates the time integral of the selections.
  void add_time(double t) { time_ += t; }
  void add_selection(int j, double integral) { integral_[at(j)] += integral; }
  /// Notes that a zone is visited: its free components vary; `closed_form` if it is solved exactly.
  void visit(const std::vector<int>& zone, bool closed_form);

  /// Notes a passage, and says what the trajectory did since an earlier one.
  /// @param section  identifies zone and event
  Turn pass(std::uint64_t section, const std::vector<double>& u, const std::vector<int>& zone);

 private:
  static constexpr std::size_t remembered = 96;
  static constexpr std::size_t lags = 4;
  struct Passage {
    std::uint64_t section = 0;
    long count = 0;
    double time = 0.0;
    double amplitude = 0.0;
    std::array<double, lags> distance{}, ratio{}, period{};
    std::array<int, lags> compared{};  ///< turns in a row
  };

  /// Of passage number i (all are numbered, the last `remembered` are kept), with u and the integrals: m doubles each.
  [[nodiscard]] Passage& passage(std::size_t i) { return passages_[i % remembered]; }
  [[nodiscard]] double* u_of(std::size_t i) { return values_.data() + i % remembered * 2 * integral_.size(); }
  [[nodiscard]] double* integral_of(std::size_t i) { return u_of(i) + integral_.size(); }
  double turns_back(std::size_t now_number, std::size_t before_number, const std::vector<int>& zone);
  void measure(std::size_t now_number, std::size_t before_number, std::size_t lag);
  [[nodiscard]] std::pair<Turn::Kind, double> kind_of(const Passage& now, const Passage& before, std::size_t lag) const;
  Turn compare(std::size_t now_number, std::size_t before_number, std::size_t lag, const std::vector<int>& zone);

  std::vector<Passage> passages_;  ///< ring; grows up to `remembered`
  std::vector<double> values_;
  std::size_t next_ = 0;
  long count_ = 0;
  long last_interior_ = -1;
  std::vector<long> last_free_;
  std::vector<double> integral_;
  double time_ = 0.0;
};

}  // namespace saltus::switching
