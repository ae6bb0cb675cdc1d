// Least squares at the times of measurements, each in the element that holds it.
//
// Which one that is depends on the lengths, so that the objective is smooth piece by piece. It has no steps on feasible
// points, where the solution is continuous. It has kinks only where a time is the end of an element at which a rate
// jumps.
#include <algorithm>
#include <cmath>

#include "saltus/base/at.hpp"
#include "saltus/discretization/ocp/ocp_variables_internal.hpp"

namespace saltus::discretization {
namespace {

/// Shorter elements, in lengths of an interval, hold no time.
constexpr double no_length = 1e-9;

class MeasurementPlacer {
 public:
  MeasurementPlacer(const model::Ocp& ocp, OcpVariables& variables, OcpStructure& made)
      : ocp_(ocp), variables_(variables), made_(made) {
    placed_.function = &made.kernel.measured_squares;
    placed_.what = "least_squares";
    placed_.term = Term::least_squares;
  }

  void run() {
    for (std::size_t i = 0; i < ocp_.least_squares.size(); ++i) {
      const auto count = static_cast<linalg::Index>(ocp_.least_squares[i].times.size());
      for (linalg::Index row = 0; row < count; ++row) place(i, row);
    }
    made_.functions.push_back(std::move(placed_));
  }

 private:
  void place(std::size_t term, linalg::Index row) {
    const double time = ocp_.least_squares[term].times[static_cast<std::size_t>(row)];
    const double position = (time - ocp_.from) / ocp_.horizon.value * made_.intervals;
    const int number = std::clamp(static_cast<int>(std::floor(position)), 0, made_.intervals - 1);
    Measurement measurement;
    measurement.share = std::clamp(position - number, 0.0, 1.0);
    auto& interval = made_.interval[at(number)];
    const int at_time = variables_.constant(time);
    const auto samples = samples_of(term, row);
    for (int e = interval.first_element; e < interval.first_element + interval.elements; ++e) {
      const int holds = variables_.constant(0.0);
      measurement.holds.push_back(constant_number(holds));
      auto places = made_.element_places(e);
      places.push_back(at_time);
      for (std::size_t i = 0; i < ocp_.least_squares.size(); ++i) {
        if (ocp_.least_squares[i].times.empty()) continue;
        places.push_back(i == term ? holds : variables_.zero());
        if (i == term) {
          places.insert(places.end(), samples.begin(), samples.end());
        } else {
          places.insert(places.end(), at(ocp_.least_squares[i].samples.cols()), variables_.zero());
        }
      }
      placed_.places.push_back(std::move(places));
      placed_.copies.push_back({.interval = number, .element = e});
    }
    interval.measurements.push_back(std::move(measurement));
  }

  [[nodiscard]] std::vector<int> samples_of(std::size_t term, linalg::Index row) {
    const auto& samples = ocp_.least_squares[term].samples;
    std::vector<int> places;
    for (linalg::Index i = 0; i < samples.cols(); ++i) places.push_back(variables_.constant(samples(row, i)));
    return places;
  }

  const model::Ocp& ocp_;
  OcpVariables& variables_;
  OcpStructure& made_;
  Placed placed_;
};

int holder_of(const OcpStructure& made, const OcpInterval& interval, double share, mpcc::ConstVectorView w) {
  int holder = 0;
  double end = 0.0;
  for (int n = 0; n < interval.elements; ++n) {
    const double length = value_at(made.element[at(interval.first_element + n)].length, w, made.constants);
    end += length;
    if (!(length > no_length)) continue;
    holder = n;
    if (share <= end) break;
  }
  return holder;
}

}  // namespace

bool has_measurements(const model::Ocp& ocp) {
  return std::any_of(ocp.least_squares.begin(), ocp.least_squares.end(),
                     [](const auto& term) { return !term.times.empty(); });
}

void place_measurements(const model::Ocp& ocp, OcpVariables& variables, OcpStructure& made) {
  MeasurementPlacer(ocp, variables, made).run();
}

void find_measurements(OcpStructure& made, mpcc::ConstVectorView w) {
  for (const auto& interval : made.interval) {
    for (const auto& measurement : interval.measurements) {
      const int holder = holder_of(made, interval, measurement.share, w);
      for (int n = 0; n < interval.elements; ++n) made.constants[measurement.holds[at(n)]] = n == holder ? 1.0 : 0.0;
    }
  }
}

}  // namespace saltus::discretization
