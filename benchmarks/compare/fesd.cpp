// Method fesd in the comparison with nosnoc: MODEL FORM SCHEME STAGES STEPS UNTIL SECONDS [interpreted], prints one
// line of JSON. Time per simulation step is CPU time from the end of the first step to that of the last, the median of
// as many runs as fit into SECONDS. A model with contacts or hysteresis is frozen: steps and UNTIL are of numerical
// time.
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>
#include <utility>

#include "protocol.hpp"
#include "saltus/fesd_integrator/integrate.hpp"
#include "saltus/io/toml/toml_model.hpp"
#include "saltus/model/build.hpp"
#include "saltus/model/frozen_system.hpp"
#include "saltus/reformulation/dcs.hpp"
#include "value_or_exit.hpp"

namespace compare {
namespace {

namespace discretization = saltus::discretization;
namespace fesd_integrator = saltus::fesd_integrator;
namespace reformulation = saltus::reformulation;

discretization::TableauFamily family_of(std::string_view scheme) {
  if (scheme == "radau_iia") return discretization::TableauFamily::radau_iia;
  if (scheme == "gauss_legendre") return discretization::TableauFamily::gauss_legendre;
  std::fprintf(stderr, "unknown scheme\n");
  std::exit(2);
}

int compare_fesd(char** arguments, saltus::evaluation::NativeCode native) {
  const auto file = value_or_exit(saltus::io::read_model(arguments[1]));
  const auto built = value_or_exit(saltus::model::build(file.description));
  const auto system = built.frozen ? value_or_exit(built.frozen->system()) : built;
  reformulation::ReformulationOptions form;
  form.reformulation =
      std::string_view(arguments[2]) == "step" ? reformulation::Form::step : reformulation::Form::stewart;
  const auto dcs = value_or_exit(reformulation::reformulate(system, form));
  fesd_integrator::IntegrationOptions options;
  options.tableau = value_or_exit(discretization::butcher_tableau(family_of(arguments[3]), std::atoi(arguments[4])));
  options.steps = std::atol(arguments[5]);
  options.until = std::atof(arguments[6]);
  options.native = native;
  options.rows = fesd_integrator::IntegrationOptions::Rows::at_times;

  double begin = 0.0, first = 0.0, last = 0.0;
  long seen = 0;
  const auto observer = [&](const saltus::result::Progress& /*progress*/) {
    if (++seen == 1) first = cpu_seconds();
    if (seen == options.steps) last = cpu_seconds();
    return saltus::result::Continue::yes;
  };
  const auto run = [&] {
    seen = 0;
    begin = cpu_seconds();
    return value_or_exit(fesd_integrator::integrate(system, dcs, options, observer));
  };
  const auto integration = run();
  std::vector<double> building, stepping;
  const double enough = cpu_seconds() + std::atof(arguments[7]);
  while (stepping.size() < 3 || (cpu_seconds() < enough && stepping.size() < 2001)) {
    static_cast<void>(run());
    building.push_back(first - begin);
    stepping.push_back((last - first) / static_cast<double>(options.steps - 1));
  }
  const auto median = [](std::vector<double>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
  };
  std::printf(
      "{\"status\":\"%s\",\"rejected\":%ld,\"elements\":%ld,\"events\":%zu,\"runs\":%zu,\"build_seconds\":%.6g,"
      "\"seconds_per_step\":%.6g,\"x\":[",
      std::string(saltus::result::name(integration.status.termination)).c_str(),
      static_cast<long>(integration.statistics.rejected), static_cast<long>(integration.statistics.steps),
      integration.events.size(), stepping.size(), median(building), median(stepping));
  for (std::size_t i = 0; i < integration.final.x.size(); ++i) {
    std::printf("%s%.17g", i == 0 ? "" : ",", integration.final.x[i]);
  }
  std::printf("]}\n");
  return 0;
}

}  // namespace
}  // namespace compare

int main(int count, char** arguments) {
  using saltus::evaluation::NativeCode;
  if (count == 8) return compare::compare_fesd(arguments, NativeCode::on);
  if (count == 9 && std::string_view(arguments[8]) == "interpreted") {
    return compare::compare_fesd(arguments, NativeCode::off);
  }
  std::fprintf(stderr, "usage: %s MODEL FORM SCHEME STAGES STEPS UNTIL SECONDS [interpreted]\n", arguments[0]);
  return 2;
}
