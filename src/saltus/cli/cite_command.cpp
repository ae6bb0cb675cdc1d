#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "references.hpp"
#include "saltus/base/version.hpp"
#include "saltus/cli/command_line_internal.hpp"
#include "saltus/cli/commands.hpp"
#include "saltus/cli/text/terminal.hpp"
#include "saltus/frontend/model_input.hpp"
#include "saltus/model/build.hpp"
#include "saltus/model/frozen_system.hpp"
#include "saltus/model/system.hpp"

namespace saltus::cli {
namespace {

/// As in CITATION.cff; a test compares.
constexpr std::string_view software =
    R"(% If Saltus helps your work, please cite it together with the papers of the methods you used.
@software{{saltus,
  author  = {{{{The Saltus authors}}}},
  title   = {{Saltus: simulation and optimal control of nonsmooth dynamical systems}},
  version = {{{}}},
}}
)";

struct Citation {
  std::string_view key, reason;
};

/// The entry of docs/references.bib with this key.
std::string entry_of(std::string_view key) {
  const std::string_view all = embedded::references;
  const auto name = all.find(fmt::format("{{{},", key));
  if (name == std::string_view::npos) return "";
  const auto begin = all.rfind('@', name);
  const auto end = all.find("\n}", name);
  return std::string(all.substr(begin, end + 2 - begin)) + "\n";
}

Citation cite_integrator(pipeline::Integrator integrator) {
  switch (integrator) {
    case pipeline::Integrator::automatic:
      return {"hairer1993", "the integrators dopri5 and dop853, with which auto begins"};
    case pipeline::Integrator::dopri5:
    case pipeline::Integrator::dop853:
      return {"hairer1993", "the integrators dopri5 and dop853"};
    case pipeline::Integrator::radau5:
      return {"hairer1996", "the integrator radau5"};
    case pipeline::Integrator::radau9:
    case pipeline::Integrator::radau13:
      return {"hairer1999", "the integrators radau9 and radau13"};
    case pipeline::Integrator::taylor:
      return {"jorba2005", "the integrator taylor"};
  }
  __builtin_unreachable();
}

/// The papers behind what a model is run with.
std::vector<Citation> citations_of(const frontend::ModelInput& input, const model::System& system) {
  const auto& options = input.file.simulate;
  std::vector<Citation> list;
  const bool by_elements = options.method == pipeline::Method::fesd || options.method == pipeline::Method::timestepping;
  if (options.method == pipeline::Method::event) {
    list.push_back({"guglielmi2022", "the event-driven method"});
    list.push_back(cite_integrator(options.event.integrator));
  }
  if (!system.switching.empty()) list.push_back({"filippov1988", "solutions at discontinuities"});
  if (by_elements || input.file.optimize) list.push_back({"nurkanovic2024", "finite elements with switch detection"});
  if (system.frozen && (by_elements || input.file.optimize)) {
    list.push_back({"nurkanovic2022", "time-freezing of state jumps and hysteresis"});
  }
  if (input.file.optimize) {
    list.push_back({"scholtes2001", "relaxation of complementarities"});
    list.push_back({"waechter2006", "Ipopt, which solves the relaxed problems"});
  }
  return list;
}

ExitCode cite(const std::string& model) {
  std::vector<Citation> list = {{"guglielmi2022", "the event-driven method (simulate)"},
                                {"nurkanovic2024", "finite elements with switch detection (--method fesd, optimize)"}};
  if (!model.empty()) {
    const auto input = frontend::read_input(model, {});
    if (!input) return refuse(input.error());
    const auto system = model::build(input->file.description, input->overrides);
    if (!system) return refuse(io::located(system.error(), input->file));
    list = citations_of(*input, *system);
  }
  std::string text = fmt::format(software, version);
  for (const auto& [key, reason] : list) text += fmt::format("\n% {}\n{}", reason, entry_of(key));
  print(text);
  return ExitCode::done;
}

}  // namespace

Command add_cite(CLI::App& app) {
  auto* command = app.add_subcommand("cite", "print how to cite Saltus and the papers of its methods, for BibTeX");
  auto model = std::make_shared<std::string>();
  command->add_option("MODEL", *model,
                      "model file, name of the catalogue or stored result: the papers of what it is run with");
  command->footer("Example:\n  saltus cite stick-slip >> references.bib");
  return {"cite", [model] { return cite(*model); }};
}

}  // namespace saltus::cli
