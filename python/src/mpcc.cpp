// Foreign problems with complementarities.
#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "errors.hpp"
#include "model.hpp"
#include "parts.hpp"
#include "saltus/base/stopwatch.hpp"
#include "saltus/cli/mpcc_input.hpp"
#include "saltus/io/mpcc/json_mpcc.hpp"
#include "saltus/pipeline/mpcc/solve_mpcc.hpp"
#include "saltus/pipeline/options/mpcc_options.hpp"
#include "saltus/report/mpcc_table.hpp"
#include "watch.hpp"

namespace nb = nanobind;

namespace saltus::python {
namespace {

/// (result as JSON, table for people, whether it did what was asked); raises what came during it, which has the same.
nb::object solve_mpcc(const std::string& file, std::vector<Option> options, std::vector<double> start,
                      nb::object on_step, nb::list warnings) {
  solver::SolveOptions chosen;
  for (const auto& [key, value, written] : options) value_or_raise(cli::set_mpcc_option(chosen, key, value, written));
  value_or_raise(pipeline::check_mpcc_options(chosen));
  const Stopwatch stopwatch;
  auto input = cli::read_mpcc(file);
  if (!input) raise(input.error());
  for (const auto& note : input->problem->notes()) warnings.append(nb::str((file + ": " + note).c_str()));
  const double building = stopwatch.seconds();
  Watch watch{nb::none()};
  chosen.is_interrupted = [&] { return watch.look(); };
  if (!on_step.is_none()) {
    chosen.on_step = [&](result::HomotopyStep step) {
      step.objective = input->problem->in_sense_of_file(step.objective);
      watch.call(on_step, report::to_line(step));
    };
  }
  auto result = [&] {
    const nb::gil_scoped_release released;
    return pipeline::solve_mpcc(*input->problem, chosen, start.empty() ? std::nullopt : std::optional(start));
  }();
  if (!result) {
    if (result.error().location.file.empty()) result.error().location.file = file;
    raise(result.error());
  }
  result->file = file;
  result->sha256 = input->sha256;
  result->statistics.build_seconds = building;
  nb::object found =
      nb::make_tuple(io::to_json(*result), report::to_table(*result), is_done(result->status.termination));
  watch.raise_what_came(found);
  return found;
}

}  // namespace

void add_mpcc(nb::module_& module) {
  module.def("solve_mpcc", solve_mpcc, nb::arg("file"), nb::arg("options"), nb::arg("start"), nb::arg("on_step").none(),
             nb::arg("warnings"));
}

}  // namespace saltus::python
