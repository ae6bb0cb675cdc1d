#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "saltus/base/version.hpp"
#include "saltus/cli/commands.hpp"
#include "saltus/cli/text/terminal.hpp"

namespace saltus::cli {
namespace {

/// As in CITATION.cff; a test compares.
constexpr std::string_view bibliography =
    R"(% If Saltus helps your work, please cite it together with the papers of the methods you used.
@software{{saltus,
  author  = {{{{The Saltus authors}}}},
  title   = {{Saltus: simulation and optimal control of nonsmooth dynamical systems}},
  version = {{{}}},
}}

% the event-driven method (simulate)
@article{{guglielmi2022,
  author  = {{Guglielmi, Nicola and Hairer, Ernst}},
  title   = {{An efficient algorithm for solving piecewise-smooth dynamical systems}},
  journal = {{Numerical Algorithms}},
  volume  = {{89}},
  year    = {{2022}},
}}

% finite elements with switch detection (--method fesd, optimize)
@article{{nurkanovic2024,
  author  = {{Nurkanovi\'c, Armin and Pozharskiy, Anton and Frey, Jonathan and Diehl, Moritz}},
  title   = {{Finite Elements with Switch Detection for numerical optimal control of nonsmooth dynamical systems with
             set-valued Heaviside step functions}},
  journal = {{Nonlinear Analysis: Hybrid Systems}},
  volume  = {{54}},
  year    = {{2024}},
}}
)";

}  // namespace

Command add_cite(CLI::App& app) {
  auto* command = app.add_subcommand("cite", "print how to cite Saltus, for BibTeX");
  command->footer("Example:\n  saltus cite >> references.bib");
  return {"cite", [] {
            print(fmt::format(bibliography, version));
            return ExitCode::done;
          }};
}

}  // namespace saltus::cli
