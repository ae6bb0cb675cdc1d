// A model ready to be simulated many times; keeps CasADi's headers out of the tests.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "problems/references.hpp"
#include "problems/relabelled.hpp"
#include "saltus/io/toml/toml_model.hpp"
#include "saltus/pipeline/options/simulate_options.hpp"
#include "saltus/result/result.hpp"

namespace saltus::pipeline {
class KernelStore;
}

namespace saltus::problems {

/// Errors of any stage are thrown as std::runtime_error with their text: in these tests every model is meant to be
/// good.
class Simulator {
 public:
  /// A model of the catalogue as it is shipped.
  [[nodiscard]] static Simulator from_catalogue(const std::string& name);
  /// The model file of a reference with its overrides, initial mode and end; relabelled if `relabelling` has a name.
  [[nodiscard]] static Simulator from_reference(const ReferenceProblem& problem, const Relabelling& relabelling = {});
  /// A model file as text.
  [[nodiscard]] static Simulator from_text(std::string_view toml, const Relabelling& relabelling = {});

  Simulator(Simulator&&) noexcept;
  Simulator& operator=(Simulator&&) noexcept;
  ~Simulator();

  /// The options of the model file, with native code off: compiling would take longer than these runs.
  [[nodiscard]] const pipeline::SimulateOptions& options() const;
  void set_initial_state(const std::vector<double>& x);
  void set_until(double t);
  /// @param kernels  from runs before, of any thread; may be null
  [[nodiscard]] result::Result run(const pipeline::SimulateOptions& options,
                                   pipeline::KernelStore* kernels = nullptr) const;

 private:
  struct Parts;
  explicit Simulator(std::unique_ptr<Parts> parts);
  [[nodiscard]] static Simulator from_file(io::ModelFile file, const std::vector<model::Override>& overrides,
                                           const Relabelling& relabelling);
  std::unique_ptr<Parts> parts_;
};

struct Accuracy {
  pipeline::Integrator integrator = pipeline::Integrator::dopri5;
  double rtol = 1e-8;
  double atol = 1e-10;
};
inline constexpr Accuracy fine{pipeline::Integrator::dop853, 1e-12, 1e-14};
inline constexpr Accuracy fine_explicit{pipeline::Integrator::dopri5, 1e-12, 1e-14};
inline constexpr Accuracy fine_implicit{pipeline::Integrator::radau5, 1e-12, 1e-14};
inline constexpr Accuracy standard{};
inline constexpr Accuracy implicit{pipeline::Integrator::radau5, 1e-8, 1e-10};
inline constexpr Accuracy series{pipeline::Integrator::taylor, 1e-8, 1e-10};

[[nodiscard]] pipeline::SimulateOptions with(pipeline::SimulateOptions options, const Accuracy& accuracy);

/// A model file as text, with its own options but for these.
[[nodiscard]] result::Result simulate_text(const std::string& toml, const Accuracy& accuracy);

/// Events without a leading `start`.
[[nodiscard]] std::vector<result::Event> switches_of(const result::Result& result);

}  // namespace saltus::problems
