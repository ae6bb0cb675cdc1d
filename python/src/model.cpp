#include "model.hpp"

#include <algorithm>
#include <memory>
#include <nanobind/nanobind.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "errors.hpp"
#include "parts.hpp"
#include "result.hpp"
#include "saltus/frontend/check_text.hpp"
#include "saltus/frontend/model_input.hpp"
#include "saltus/frontend/optimum_record.hpp"
#include "saltus/io/check/model_overview.hpp"
#include "saltus/io/toml/toml_model.hpp"
#include "saltus/model/build.hpp"
#include "saltus/model/ocp.hpp"
#include "saltus/pipeline/compare.hpp"
#include "saltus/pipeline/optimal_control/optimize.hpp"
#include "saltus/pipeline/options/option_effects.hpp"
#include "saltus/pipeline/order.hpp"
#include "saltus/pipeline/simulate.hpp"
#include "saltus/report/mpcc_table.hpp"
#include "watch.hpp"

namespace nb = nanobind;

namespace saltus::python {
namespace {

/// The run as an object of Python; raises what came during it.
nb::object finished(Expected<result::Result> result, const frontend::ModelInput& input,
                    std::shared_ptr<const model::System> system, Watch& watch) {
  if (!result) raise(io::located(result.error(), input.file));
  auto shared = std::make_shared<result::Result>(std::move(*result));
  nb::object run = nb::cast(Run{std::move(shared), std::move(system), {}, {}, {}});
  watch.raise_what_came(run);
  return run;
}

/// What `compute` returns; where a signal or `progress` has stopped it while the model was prepared, raises that.
template <class Compute>
nb::object watched(Watch& watch, Compute compute) {
  const PreparationScope scope([&](const Preparation& preparation) { return watch.goes_on(preparation); });
  try {
    return compute();
  } catch (const Stopped&) {
    watch.raise_what_came(nb::none());
    throw;
  }
}

/// One of the commands that simulate: what it computes from a system and options.
template <class Compute>
nb::object run_simulation(Model& model, const Request& request, nb::object progress, nb::list warnings,
                          Compute compute) {
  const auto input = model.stated(request);
  value_or_raise(io::check_options(input.file));
  if (request.methods == frontend::RunMethods::chosen) append(warnings, frontend::options_without_effect(input.file));
  Watch watch(std::move(progress));
  return watched(watch, [&] {
    const auto system = model.system(input, request);
    append(warnings, system->warnings);
    std::optional<std::string> note;
    auto result = [&] {
      const nb::gil_scoped_release released;
      auto computed = compute(*system, input.file.simulate, watch.observers());
      if (computed) note = frontend::complete_record(input, *computed);
      return computed;
    }();
    if (note) warnings.append(*note);
    return finished(std::move(result), input, system, watch);
  });
}

nb::object simulate(Model& model, std::vector<std::string> settings, std::vector<Option> options, nb::object progress,
                    nb::list warnings) {
  const Request request{std::move(settings), std::move(options), frontend::RunMethods::chosen};
  return run_simulation(model, request, std::move(progress), std::move(warnings),
                        [&](const auto& system, const auto& options, const auto& observers) {
                          return pipeline::simulate(system, options, observers, &model.kernels());
                        });
}

nb::object compare(Model& model, std::vector<std::string> settings, std::vector<Option> options, nb::object progress,
                   nb::list warnings) {
  return run_simulation(model, {std::move(settings), std::move(options), frontend::RunMethods::several},
                        std::move(progress), std::move(warnings), pipeline::compare);
}

nb::object order(Model& model, std::vector<std::string> settings, std::vector<Option> options, nb::object progress,
                 nb::list warnings, const std::string& schemes, const std::string& steps) {
  pipeline::OrderOptions what;
  if (!schemes.empty()) what.schemes = value_or_raise(pipeline::parse_schemes(schemes));
  if (!steps.empty()) what.steps = value_or_raise(pipeline::parse_steps(steps));
  return run_simulation(model, {std::move(settings), std::move(options), frontend::RunMethods::several},
                        std::move(progress), std::move(warnings),
                        [&](const auto& system, const auto& simulate, const auto& observers) {
                          return pipeline::order(system, simulate, what, observers);
                        });
}

nb::object optimize(Model& model, std::vector<std::string> settings, std::vector<Option> options,
                    const nb::object& start, nb::object on_step, nb::list warnings) {
  auto input = model.stated({std::move(settings), std::move(options), frontend::RunMethods::several});
  value_or_raise(io::check_optimize_options(input.file));
  if (nb::isinstance<Run>(start)) {
    input.file.optimize->start_from = nb::cast<Run&>(start).result;
  } else {
    if (!start.is_none()) input.file.optimize->start_result = nb::cast<std::string>(start);
    value_or_raise(io::read_start_result(input.file));
  }
  const auto ocp = model::build_ocp(input.file.description, input.overrides);
  if (!ocp) raise(io::located(ocp.error(), input.file));
  append(warnings, ocp->system.warnings);
  append(warnings, ocp->warnings);
  Watch watch{nb::none()};
  pipeline::OptimizeObservers observers;
  observers.is_interrupted = [&] { return watch.look(); };
  observers.on_warning = [&](const std::string& warning) {
    const nb::gil_scoped_acquire held;
    warnings.append(warning);
  };
  if (!on_step.is_none()) {
    observers.on_step = [&](const result::HomotopyStep& step) { watch.call(on_step, report::to_line(step)); };
  }
  auto result = [&] {
    const nb::gil_scoped_release released;
    return pipeline::optimize(*ocp, *input.file.optimize, observers);
  }();
  if (result) {
    if (const auto note = frontend::complete_optimum(input, *result)) warnings.append(*note);
    frontend::add_surfaces(*ocp, *result);
  }
  return finished(std::move(result), input, nullptr, watch);
}

/// The run once more, with what is between its rows; with all its branches, or none.
nb::object simulate_between(Model& model, std::vector<std::string> settings, std::vector<Option> options,
                            bool branches) {
  const Request request{std::move(settings), std::move(options), frontend::RunMethods::chosen};
  auto input = model.stated(request);
  auto& chosen = input.file.simulate;
  chosen.continuous = true;
  chosen.event_rows = true;
  chosen.kept = {};
  chosen.output = pipeline::EveryStep{};  // has both sides where inputs break
  if (!branches) chosen.event.trajectories = 1;
  const auto system = model.system(input, request);
  Watch watch{nb::none()};
  auto result = [&] {
    const nb::gil_scoped_release released;
    return pipeline::simulate(*system, chosen, watch.observers(), &model.kernels());
  }();
  return finished(std::move(result), input, nullptr, watch);
}

/// From how many starts the problem is solved.
int starts(const Model& model, std::vector<std::string> settings, std::vector<Option> options) {
  const auto input = model.stated({std::move(settings), std::move(options), frontend::RunMethods::several});
  value_or_raise(io::check_optimize_options(input.file));
  return input.file.optimize->mpcc.starts.value_or(1);
}

std::string check(Model& model, std::vector<std::string> settings) {
  const auto input = model.stated({std::move(settings), {}, frontend::RunMethods::several});
  auto text = frontend::check_text(input);
  if (!text) raise(io::located(text.error(), input.file));
  return *text;
}

/// (left, right, where) of each equation.
std::vector<std::tuple<std::string, std::string, std::string>> equations(const Model& model, bool latex) {
  constexpr std::size_t most = 1000;
  std::vector<std::tuple<std::string, std::string, std::string>> list;
  const auto notation = latex ? io::Notation::latex : io::Notation::text;
  for (auto& [left, right, where] : io::stated_equations(model.input().file.description, most, notation)) {
    list.emplace_back(std::move(left), std::move(right), std::move(where));
  }
  return list;
}

/// Whether a parameter, a state or a control has this name.
bool declares(const Model& model, const std::string& name) {
  const auto& stated = model.input().file.description;
  const auto has = [&](const auto& part) {
    return std::any_of(part.begin(), part.end(), [&](const auto& entry) { return entry.name == name; });
  };
  return has(stated.parameters) || has(stated.states) || has(stated.controls);
}

/// (name, initial value) of states and parameters, as they are without settings.
std::vector<std::pair<std::string, double>> quantities(Model& model, bool of_states) {
  const Request request{{}, {}, frontend::RunMethods::several};
  const auto system = model.system(model.input(), request);
  const auto& names = of_states ? system->state_names : system->parameter_names;
  const auto& values = of_states ? system->initial_state : system->parameter_values;
  std::vector<std::pair<std::string, double>> list;
  for (std::size_t i = 0; i < names.size(); ++i) list.emplace_back(names[i], values[i]);
  return list;
}

}  // namespace

void add_model(nb::module_& module) {
  nb::class_<Model> type(module, "Model", "A model file.");
  type.def(nb::init<const std::string&>())
      .def(nb::init<const std::string&, const std::string&, const std::vector<std::pair<std::string, std::string>>&>(),
           nb::arg("text"), nb::arg("name"), nb::arg("files") = std::vector<std::pair<std::string, std::string>>())
      .def_prop_ro("name", [](const Model& self) { return self.input().file.description.name; })
      .def_prop_ro("description", [](const Model& self) { return self.input().file.description.description; })
      .def_prop_ro("path", [](const Model& self) { return self.input().path; })
      .def_prop_ro("method",
                   [](const Model& self) { return std::string(pipeline::name(self.input().file.simulate.method)); })
      .def_prop_ro("forced_modes",
                   [](const Model& self) {
                     std::vector<std::string> names;
                     for (const auto& [name, mode] : self.input().file.simulate.initial_mode) names.push_back(name);
                     return names;
                   })
      .def_prop_ro("can_optimize", [](const Model& self) { return self.input().file.optimize.has_value(); })
      .def("simulate", simulate, nb::arg("settings"), nb::arg("options"), nb::arg("progress").none(),
           nb::arg("warnings"))
      .def("compare", compare, nb::arg("settings"), nb::arg("options"), nb::arg("progress").none(), nb::arg("warnings"))
      .def("order", order, nb::arg("settings"), nb::arg("options"), nb::arg("progress").none(), nb::arg("warnings"),
           nb::arg("schemes"), nb::arg("steps"))
      .def("optimize", optimize, nb::arg("settings"), nb::arg("options"), nb::arg("start").none(),
           nb::arg("on_step").none(), nb::arg("warnings"))
      .def("starts", starts, nb::arg("settings"), nb::arg("options"))
      .def("simulate_between", simulate_between, nb::arg("settings"), nb::arg("options"), nb::arg("branches"))
      .def("equations", equations, nb::arg("latex"))
      .def("declares", declares, nb::arg("name"))
      .def("quantities", quantities, nb::arg("of_states"))
      .def("check", check, nb::arg("settings"));
  add_sweep(type);
}

}  // namespace saltus::python
