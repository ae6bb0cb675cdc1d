// A random system in the engine's hands; keeps CasADi's headers out of the tests.
#pragma once

#include <memory>
#include <vector>

#include "random_systems.hpp"
#include "saltus/result/result.hpp"

namespace saltus::robustness {

enum class Integrator { dopri5, dop853, taylor };
struct Accuracy {
  Integrator integrator = Integrator::dopri5;
  double rtol = 1e-8;  ///< atol = rtol / 100
};
enum class Reformulation { step, stewart };
/// Finite elements with switch detection: Radau IIA with so many stages, two elements in each of so many steps.
struct Elements {
  Reformulation form = Reformulation::step;
  int stages = 4;
  long steps = 800;
};

/// The compiled system: states x0, x1, …; switching functions s0, s1, … in the order of the random system.
class Model {
 public:
  /// @throws std::runtime_error if the builder refuses the system
  explicit Model(const RandomSystem& random);
  ~Model();

  /// Simulates with default options, rows at the steps.
  [[nodiscard]] result::Result run(const Accuracy& accuracy, const std::vector<double>& start) const;
  /// The same by the other engine.
  [[nodiscard]] result::Result run(const Elements& elements) const;
  /// Switching functions on which something jumps: the others make no events and slide nowhere.
  [[nodiscard]] const std::vector<bool>& listed() const;
  /// Whether two of the random surfaces turned out to be one.
  [[nodiscard]] bool has_equal_surfaces() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace saltus::robustness
