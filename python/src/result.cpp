#include "result.hpp"

#include <algorithm>
#include <array>
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "errors.hpp"
#include "parts.hpp"
#include "saltus/base/at.hpp"
#include "saltus/frontend/catalogue.hpp"
#include "saltus/frontend/difference_text.hpp"
#include "saltus/io/atomic_file.hpp"
#include "saltus/io/json/json_result.hpp"
#include "saltus/pipeline/vector_field.hpp"
#include "saltus/report/findings.hpp"
#include "saltus/report/html.hpp"
#include "saltus/report/table.hpp"
#include "saltus/result/difference.hpp"
#include "saltus/result/drawn.hpp"
#include "saltus/result/kept_columns.hpp"
#include "saltus/result/turned.hpp"

namespace nb = nanobind;

namespace saltus::python {
namespace {

/// A read-only array that keeps its owner alive.
template <class T>
nb::ndarray<nb::numpy, const T> look_at(const T* data, std::size_t rows, nb::handle owner) {
  return {data, {rows}, owner};
}

/// A read-only view of all rows of a table: (rows, width).
nb::ndarray<nb::numpy, const double> table_array(const result::Table<double>& table, std::size_t width,
                                                 nb::handle owner) {
  return {table.data(), {table.size(), width}, owner};
}

/// The same of one that is kept by its changes: written out when it is asked for first, columns contiguous.
template <class T, class Number>
nb::ndarray<nb::numpy, const T> block_array(Block<T>& block, const result::SteadyTable<Number>& table,
                                            std::size_t width, nb::handle owner) {
  const std::size_t rows = table.size();
  if (!block.made) {
    block.columns.resize(rows * width);
    for (std::size_t k = 0; k < table.width(); ++k) {
      T* const column = block.columns.data() + k * rows;
      table.column(k).for_each_change(
          [&](std::size_t from, Number value) { std::fill(column + from, column + rows, static_cast<T>(value)); });
    }
    block.made = true;
  }
  return nb::ndarray<nb::numpy, const T>(block.columns.data(), {rows, width}, owner,
                                         {1, static_cast<std::int64_t>(rows)});
}

template <auto rows, auto names>
void add_table(nb::class_<Run>& type, const char* name) {
  type.def_prop_ro(name, [](nb::handle self) {
    const auto& result = *nb::cast<Run&>(self).result;
    return table_array(result.trajectory.*rows, (result.*names).size(), self);
  });
}

template <auto table, auto block>
void add_of_functions(nb::class_<Run>& type, const char* name) {
  type.def_prop_ro(name, [](nb::handle self) {
    auto& run = nb::cast<Run&>(self);
    return block_array(run.*block, run.result->trajectory.*table, result::functions_in_rows(*run.result).size(), self);
  });
}

nb::object array_of(const std::vector<double>& values) { return owned_array(values); }

std::string text_of(std::string_view view) { return std::string(view); }

/// The surfaces are looked for when the first report or file wants them.
void want_surfaces(Run& run) {
  if (run.system && run.result->surfaces.empty()) pipeline::add_drawings(*run.system, *run.result);
}

nb::object sensitivities(const Run& run) {
  const auto& found = run.result->sensitivities;
  if (!found) return nb::none();
  const auto matrix = [](const std::vector<std::vector<double>>& rows) {
    nb::list list;
    for (const auto& row : rows) list.append(array_of(row));
    return list;
  };
  nb::dict entries;
  entries["x0"] = matrix(found->x0);
  entries["p"] = matrix(found->p);
  entries["parameters"] = found->parameters;
  return std::move(entries);
}

nb::list branches(const Run& run) {
  nb::list list;
  for (auto& branch : run.result->branches) {
    list.append(nb::cast(Run{std::shared_ptr<result::Result>(run.result, &branch), nullptr, {}, {}, {}}));
  }
  return list;
}

nb::dict final_of(const Run& run) {
  const auto& last = run.result->final;
  nb::dict entries;
  entries["t"] = last.t;
  entries["x"] = array_of(last.x);
  entries["mode"] = last.mode;
  entries["alpha"] = array_of(last.alpha);
  entries["outputs"] = array_of(last.outputs);
  entries["regions"] = last.regions;
  entries["theta"] = array_of(last.theta);
  entries["contact_modes"] = words_of(last.contact_modes);
  return entries;
}

/// Per row the mode of every contact.
nb::list contact_modes(const Run& run) {
  nb::list rows;
  const auto& table = run.result->trajectory.contact_modes;
  for (std::size_t row = 0; row < table.size(); ++row) {
    nb::list words;
    for (const auto mode : table[row]) words.append(text_of(result::name(mode)));
    rows.append(std::move(words));
  }
  return rows;
}

/// What pictures show of it; none if that is the run itself.
std::optional<Run> drawn(const Run& run) {
  auto result = result::as_drawn(*run.result);
  if (!result) return std::nullopt;
  return Run{std::make_shared<result::Result>(std::move(*result)), nullptr, {}, {}, {}};
}

/// The stored form of what is no row and no event.
std::string facts(const Run& run) {
  const auto& of = *run.result;
  result::Result about;
  about.model = of.model;
  about.command = of.command;
  about.command_line = of.command_line;
  about.date = of.date;
  about.method = of.method;
  about.status = of.status;
  about.statistics = of.statistics;
  about.optimization = of.optimization;
  about.options = of.options;
  about.penetration = of.penetration;
  about.families = of.families;
  about.left_at = of.left_at;
  return io::to_json(about);
}

/// The page of a run, with others of the model laid over it.
std::string page_of(Run& run, const std::vector<std::string>& labels, const nb::list& others) {
  want_surfaces(run);
  std::vector<report::Overlay> overlays;
  for (nb::handle other : others) {
    overlays.push_back({labels.at(overlays.size()), *nb::cast<Run&>(other).result});
    value_or_raise(report::check_overlay(*run.result, overlays.back()));
  }
  return report::to_html(*run.result, value_or_raise(frontend::plotly_source()), overlays);
}

/// (what, in a, in b) of each.
nb::list numbers_of(const std::vector<result::NumberDifference>& differences) {
  nb::list list;
  for (const auto& number : differences) list.append(nb::make_tuple(number.what, number.a, number.b));
  return list;
}

nb::dict difference_of(const Run& a, const Run& b, double rtol, std::optional<double> atol) {
  const result::Tolerances tolerances{rtol, atol};
  const auto found = value_or_raise(result::difference(*a.result, *b.result, tolerances));
  nb::dict entries;
  entries["same"] = found.is_none();
  entries["parameters"] = numbers_of(found.parameters);
  entries["end"] = numbers_of(found.end_state);
  entries["rows"] = numbers_of(found.rows);
  entries["events"] = nb::make_tuple(found.events_a, found.events_b);
  entries["first_event"] = found.first_event;
  entries["ends"] = found.ends;
  entries["text"] = frontend::difference_text(found, tolerances, a.result->states.size());
  return entries;
}

void save(Run& run, const std::string& path) {
  const bool json = path.ends_with(".json");
  if (!json && !path.ends_with(".csv") && !path.ends_with(".npz")) {
    raise({ErrorCode::io_failure,
           path + ": the name must end in .json, .csv, .events.csv or .npz",
           "the suffix says what is written",
           {},
           {}});
  }
  if (json) want_surfaces(run);
  value_or_raise(io::stream_file(path, [&](io::Sink sink) { return io::write_as(path, *run.result, sink); }));
}

Run load(const std::string& path) {
  return {std::make_shared<result::Result>(value_or_raise(io::read_result(path))), nullptr, {}, {}, {}};
}
Run parse(const std::string& text) {
  return {std::make_shared<result::Result>(value_or_raise(io::parse_result(text, "<memory>"))), nullptr, {}, {}, {}};
}

void add_names(nb::class_<Run>& type) {
  type.def_prop_ro("model", [](const Run& self) { return self.result->model.name; })
      .def_prop_ro("description", [](const Run& self) { return self.result->model.description; })
      .def_prop_ro("parameters", [](const Run& self) { return self.result->model.parameters; })
      .def_prop_ro("command", [](const Run& self) { return self.result->command; })
      .def_prop_ro("method", [](const Run& self) { return self.result->method; })
      .def_prop_ro("states", [](const Run& self) { return self.result->states; })
      .def_prop_ro("states_in_rows", [](const Run& self) { return result::states_in_rows(*self.result); })
      .def_prop_ro("functions_in_rows", [](const Run& self) { return result::functions_in_rows(*self.result); })
      .def_prop_ro("controls", [](const Run& self) { return self.result->controls; })
      .def_prop_ro("output_names", [](const Run& self) { return self.result->outputs; })
      .def_prop_ro("switching_functions", [](const Run& self) { return self.result->switching_functions; })
      .def_prop_ro("contacts", [](const Run& self) { return self.result->contacts; })
      .def_prop_ro("contact_modes", contact_modes)
      .def_prop_ro("regions", [](const Run& self) { return result::region_labels(self.result->region_groups); })
      .def_prop_ro("termination", [](const Run& self) { return text_of(name(self.result->status.termination)); })
      .def_prop_ro("done", [](const Run& self) { return is_done(self.result->status.termination); })
      .def_prop_ro("message", [](const Run& self) { return self.result->status.message; })
      .def_prop_ro("time_reached", [](const Run& self) { return self.result->status.time_reached; });
}

}  // namespace

nb::object owned_array(std::vector<double> values) {
  auto* kept = new std::vector<double>(std::move(values));
  const nb::capsule owner(kept, [](void* memory) noexcept { delete static_cast<std::vector<double>*>(memory); });
  return nb::cast(nb::ndarray<nb::numpy, const double>(kept->data(), {kept->size()}, owner));
}

std::vector<std::string> words_of(const std::vector<result::ContactMode>& modes) {
  std::vector<std::string> words;
  for (const auto mode : modes) words.emplace_back(result::name(mode));
  return words;
}

void add_result(nb::module_& module) {
  add_event(module);
  nb::class_<Run> type(module, "Run", "A result of the library.");
  add_names(type);
  type.def_prop_ro("t", [](nb::handle self) {
    const auto& t = nb::cast<Run&>(self).result->trajectory.t;
    return look_at(t.data(), t.size(), self);
  });
  using result::Result;
  using result::Trajectory;
  type.def_prop_ro("x", [](nb::handle self) {
    const auto& run = *nb::cast<Run&>(self).result;
    return table_array(run.trajectory.x, result::states_in_rows(run).size(), self);
  });
  add_table<&Trajectory::u, &Result::controls>(type, "u");
  add_table<&Trajectory::outputs, &Result::outputs>(type, "outputs");
  add_of_functions<&Trajectory::alpha, &Run::alpha>(type, "alpha");
  add_of_functions<&Trajectory::mode, &Run::mode>(type, "mode");
  type.def_prop_ro("theta",
                   [](nb::handle self) {
                     auto& run = nb::cast<Run&>(self);
                     const auto width = run.result->region_groups.empty()
                                            ? 0
                                            : result::region_labels(run.result->region_groups).size();
                     return block_array(run.theta, run.result->trajectory.theta, width, self);
                   })
      .def_prop_ro("events",
                   [](const Run& self) {
                     nb::list list;
                     const auto states = std::make_shared<const std::vector<std::string>>(self.result->states);
                     for (result::Event event : self.result->events) {
                       const auto word = turned(event, *self.result);
                       list.append(nb::cast(
                           RunEvent{std::move(event), word ? std::optional(text_of(*word)) : std::nullopt, states}));
                     }
                     return list;
                   })
      .def_prop_ro("final", final_of)
      .def_prop_ro("branches", branches)
      .def_prop_ro("is_continuous", [](const Run& self) { return self.result->continuous != nullptr; })
      .def("values_at", values_at, nb::arg("between"), nb::arg("times"), nb::arg("before"))
      .def_prop_ro("sensitivities", sensitivities)
      .def("drawn", drawn)
      .def("facts", facts)
      .def("said",
           [](const Run& self) {
             std::vector<std::array<std::string, 3>> list;
             for (auto& one : report::said_of_optimum(*self.result)) list.push_back({one.about, one.tone, one.text});
             return list;
           })
      .def("table", [](const Run& self) { return report::to_table(*self.result); })
      .def("json",
           [](Run& self, bool surfaces) {
             if (surfaces) want_surfaces(self);
             return io::to_json(*self.result);
           })
      .def("page", page_of, nb::arg("labels"), nb::arg("others"))
      .def("save", save);
  module.def("load", load);
  module.def("parse_result", parse);
  module.def("difference", difference_of, nb::arg("a"), nb::arg("b"), nb::arg("rtol"), nb::arg("atol").none());
}

}  // namespace saltus::python
