#include "saltus/cli/tool.hpp"

#include <nanobind/nanobind.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>
#include <optional>
#include <string>

#include "errors.hpp"
#include "parts.hpp"
#include "saltus/base/told_together.hpp"
#include "saltus/base/version.hpp"
#include "saltus/frontend/catalogue.hpp"
#include "saltus/frontend/sized_models.hpp"
#include "saltus/io/atomic_file.hpp"

namespace nb = nanobind;

namespace saltus::python {
namespace {

int run_tool(std::vector<std::string> arguments) {
  std::vector<char*> pointers;
  for (auto& argument : arguments) pointers.push_back(argument.data());
  pointers.push_back(nullptr);
  const nb::gil_scoped_release released;
  return cli::run_tool(static_cast<int>(arguments.size()), pointers.data());
}

std::vector<std::string> models() {
  std::vector<std::string> names;
  for (const auto& entry : frontend::catalogue()) names.push_back(entry.name);
  return names;
}

/// The file of a shipped model, whatever files of that name there are.
std::string find_catalogue(const std::string& name) {
  const auto entries = frontend::catalogue();
  for (const auto& entry : entries) {
    if (entry.name == name) return entry.file.string();
  }
  raise({ErrorCode::unknown_name, "'" + name + "' is no model of the catalogue", suggest(name, models()), {}, {}});
}

/// The text of a shipped model of any size; None for other names.
std::optional<std::string> sized_model(const std::string& name, const frontend::ModelSizes& sizes) {
  const auto* model = frontend::find_sized_model(name);
  if (model == nullptr) return std::nullopt;
  return value_or_raise(frontend::write_sized_model(*model, sizes));
}

}  // namespace

void add_tool(nb::module_& module) {
  module.attr("version") = nb::str(std::string(version).c_str());
  module.def("run_tool", run_tool);
  module.def("models", models);
  module.def("told_together", told_together, nb::arg("texts"));
  module.def("set_shared_folder", [](const std::string& folder) { frontend::set_shared_folder(folder); });
  module.def("find_catalogue", find_catalogue);
  module.def("sized_model", sized_model, nb::arg("name"), nb::arg("sizes"));
  module.def("write_file", [](const std::string& path, const std::string& content) {
    value_or_raise(io::check_writable(path));
    value_or_raise(io::write_file(path, content));
  });
  module.def("plotly_source", [] { return value_or_raise(frontend::plotly_source()); });
}

}  // namespace saltus::python
