#include <memory>
#include <nanobind/nanobind.h>
#include <utility>
#include <vector>

#include "errors.hpp"
#include "result.hpp"
#include "saltus/result/continuous.hpp"
#include "watch.hpp"

namespace nb = nanobind;

namespace saltus::python {

nb::object values_at(const Run& run, const Run& between, const std::vector<double>& times, bool before) {
  Watch watch{nb::none()};
  auto rows = [&] {
    const nb::gil_scoped_release released;
    const auto side = before ? result::Side::before : result::Side::behind;
    return between.result->continuous->at(times, side, [&](const result::Progress&) {
      return watch.look() ? result::Continue::no : result::Continue::yes;
    });
  }();
  const auto& of = *run.result;
  auto values = std::make_shared<result::Result>();
  values->model = of.model;
  values->method = of.method;
  values->states = of.states;
  values->controls = of.controls;
  values->outputs = of.outputs;
  values->switching_functions = of.switching_functions;
  values->region_groups = of.region_groups;
  values->status = of.status;
  values->final = of.final;
  if (rows) values->trajectory = std::move(*rows);
  nb::object found = nb::cast(Run{std::move(values), nullptr, {}, {}, {}});
  watch.raise_what_came(found);
  if (!rows) raise(rows.error());
  return found;
}

}  // namespace saltus::python
