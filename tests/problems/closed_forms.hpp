// Problems at the intersection of two surfaces whose solutions are known in closed form, and the same problems bent.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace saltus::problems {

/// y' = velocity(y, s), s the surfaces; expressions of the model language in y1, y2, …, s1, s2.
struct ClosedForm {
  std::string name;
  std::vector<double> start;
  std::vector<std::string> surfaces;    ///< psi of s1, s2
  std::vector<std::string> velocities;  ///< one per y
  std::vector<int> initial_mode{};      ///< empty: as the start decides
  double until = 0.0;
  struct Event {
    double t = 0.0;
    std::vector<double> y;
    std::vector<int> mode_after;
  };
  std::vector<Event> events{};
  std::vector<double> final_y{};
};

/// The problems of tests/data/switching_cases.json, as they are there.
[[nodiscard]] nlohmann::json stored_closed_forms();
/// One of them; every psi times `scale`. A problem without a list of events (the spiral that leaves) has none here.
[[nodiscard]] ClosedForm closed_form(const nlohmann::json& stored, double scale = 1.0);

/// The model file of a problem.
[[nodiscard]] std::string text_of(const ClosedForm& problem);

/// Clock and coordinates of bent problems: t = 2 atan(tau/2), z1 = y1 + 0.3 sin(tau), z_i = y_i + 0.2 sin(z_(i-1)) and
/// tau itself, where tau is the time of the straight problem. The surfaces y_i = 0 become curved, and so do all motions
/// on them; events and end states stay known.
[[nodiscard]] double bent_time(double tau);
[[nodiscard]] std::vector<double> bent_state(double tau, const std::vector<double>& y);
/// The model file of a problem in these coordinates; its `until` is 1 and has to be set to bent_time(problem.until).
[[nodiscard]] std::string bent_text_of(const ClosedForm& problem);

/// Polynomial fields, codimension 2 with selections that move:
/// onto the first surface at 1/2, onto both at 1, off the second one at 2, where alpha_1 reaches 1 (leaf A1).
[[nodiscard]] ClosedForm in_and_out();
/// Off both surfaces at 1, where no scaling keeps sliding stable any more (leaf C9-2).
[[nodiscard]] ClosedForm unstable_exit();

}  // namespace saltus::problems
