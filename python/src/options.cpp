// The tables of options as Python reads them: for signatures, help and annotations.
#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>
#include <string>
#include <string_view>

#include "parts.hpp"
#include "saltus/pipeline/options/mpcc_options.hpp"
#include "saltus/pipeline/options/optimize_fields.hpp"
#include "saltus/pipeline/options/option_fields.hpp"

namespace nb = nanobind;

namespace saltus::python {
namespace {

nb::str text(std::string_view words) { return nb::str(words.data(), words.size()); }

std::string_view name(pipeline::ListOf list) {
  switch (list) {
    case pipeline::ListOf::nothing:
      return "";
    case pipeline::ListOf::the_same:
      return "the_same";
    case pipeline::ListOf::increasing_numbers:
      return "numbers";
    case pipeline::ListOf::names:
      return "names";
  }
  __builtin_unreachable();
}

nb::dict entry(std::string_view key, std::string_view expects, std::string_view standard, std::string_view doc) {
  nb::dict made;
  made["key"] = text(key);
  made["expects"] = text(expects);
  made["default"] = text(standard);
  made["doc"] = text(doc);
  return made;
}

/// The default of a field is read from default options, so that it is stated nowhere twice.
template <class Options, class Field>
nb::dict entry_of(const Field& field, const Options& defaults) {
  result::OptionRecord record;
  field.record(defaults, field.key, record);
  const auto standard = record.empty() ? std::string() : pipeline::to_text(record.front().second);
  nb::dict made = entry(field.key, expects(field.kind), standard, field.doc);
  nb::list words, values;
  for (const auto word : field.kind.words) words.append(text(word));
  for (const int value : field.kind.values) values.append(value);
  made["words"] = words;
  made["values"] = values;
  made["truth"] = field.kind.truth;
  made["number"] = text(!field.kind.number ? "" : field.kind.number->whole ? "whole" : "real");
  made["list"] = text(name(field.kind.list));
  return made;
}

template <class Options, class Fields>
nb::list entries_of(const Fields& fields) {
  const Options defaults{};
  nb::list list;
  for (const auto& field : fields) list.append(entry_of(field, defaults));
  return list;
}

/// By command; `problem` has the keys of [optimize] that state the problem.
nb::dict option_tables() {
  nb::dict tables;
  tables["simulate"] = entries_of<pipeline::SimulateOptions>(pipeline::simulate_fields());
  tables["optimize"] = entries_of<pipeline::OptimizeOptions>(pipeline::optimize_fields());
  tables["mpcc"] = entries_of<solver::SolveOptions>(pipeline::mpcc_fields());
  nb::list problem;
  for (const auto& key : pipeline::problem_keys()) problem.append(entry(key.key, key.expects, "", key.doc));
  tables["problem"] = problem;
  return tables;
}

}  // namespace

void add_options(nb::module_& module) {
  module.def("option_tables", option_tables);
  module.def("simulate_keys", [] { return pipeline::simulate_keys(); });
  module.def("optimize_keys", [] { return pipeline::optimize_keys(); });
}

}  // namespace saltus::python
