// Reference solutions of the catalogue's models (references.json, written by make_references.py).
#pragma once

#include <iosfwd>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace saltus::problems {

struct ReferenceAlternative {
  std::vector<int> mode;
  std::vector<double> alpha;
};

/// One event as it must appear in a result; interface.md section 3 defines the fields.
struct ReferenceEvent {
  double t = 0.0;
  std::string kind;
  std::vector<std::string> surfaces;
  std::optional<std::vector<int>> mode_before;  ///< absent for a start
  std::vector<int> mode_after;
  std::vector<double> x, x_after;  ///< they differ at jumps
  std::optional<bool> unique = true;
  std::vector<ReferenceAlternative> alternatives;
  std::optional<std::vector<std::vector<std::string>>> regions_after{};  ///< of groups by `indicator`
};

/// A model of the catalogue with the changes of one case, its events and its end.
struct ReferenceProblem {
  std::string model;
  std::string variant;                                    ///< what differs from the model file; empty: nothing
  std::vector<std::pair<std::string, double>> overrides;  ///< as `--set NAME=VALUE`
  std::vector<std::pair<std::string, int>> initial_mode;
  double until = 0.0;
  int digits = 0;  ///< to which every number is known
  std::vector<ReferenceEvent> events;
  std::vector<double> final_x, final_alpha, final_theta;
  std::vector<int> final_mode;
};

/// All cases, in the order of the file; the file is read once. Throws if it cannot be read: a broken test suite.
[[nodiscard]] const std::vector<ReferenceProblem>& references();
/// The case of that model without a variant.
[[nodiscard]] const ReferenceProblem& reference(const std::string& model);
/// "stick_slip_from_outside": what GoogleTest accepts as a name.
[[nodiscard]] std::string test_name(const ReferenceProblem& problem);
/// How GoogleTest prints a parameter (its name for such a function).
void PrintTo(const ReferenceProblem& problem, std::ostream* out);
/// Names of all models of the catalogue, from the files in models/, sorted.
[[nodiscard]] std::vector<std::string> catalogue();

}  // namespace saltus::problems
