#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "saltus/base/text.hpp"
#include "saltus/cli/command_line_internal.hpp"
#include "saltus/cli/commands.hpp"
#include "saltus/cli/text/terminal.hpp"
#include "saltus/frontend/catalogue.hpp"
#include "saltus/frontend/sized_models.hpp"
#include "saltus/io/atomic_file.hpp"
#include "saltus/io/toml/toml_model.hpp"

namespace saltus::cli {
namespace {

ExitCode list_models() {
  const auto entries = frontend::catalogue();
  std::size_t width = 0;
  for (const auto& entry : entries) width = std::max(width, entry.name.size());
  for (const auto& model : frontend::sized_models()) width = std::max(width, model.name.size());
  for (const auto& entry : entries) {
    const auto model = io::read_model(entry.file);
    print(fmt::format(
        "{:<{}}  {}\n", entry.name, width,
        model ? model->description.description : fmt::format("(cannot be read: {})", model.error().message)));
  }
  print("\nof any size:\n");
  for (const auto& model : frontend::sized_models()) {
    std::string sizes;
    for (const auto& size : model.sizes) sizes += fmt::format(" --set {}={}", size.name, size.value);
    print(fmt::format("{:<{}}  {} ({})\n", model.name, width, model.description, sizes.substr(1)));
  }
  if (!entries.empty()) return ExitCode::done;
  return refuse(
      {ErrorCode::io_failure, "the catalogue is empty", "set SALTUS_MODELS to a folder of model files", {}, {}});
}

/// NAME=N of one --set.
Expected<frontend::ModelSizes::value_type> read_size(const std::string& setting) {
  const auto equals = setting.find('=');
  const std::string name = setting.substr(0, equals);
  const std::string number = equals == std::string::npos ? std::string() : setting.substr(equals + 1);
  if (const auto value = whole_text_as<std::int64_t>(number)) return frontend::ModelSizes::value_type{name, *value};
  return tl::unexpected(Error{ErrorCode::invalid_option,
                              fmt::format("--set {}: expected NAME=N with a whole number", setting),
                              "as in: --set blocks=1000",
                              {},
                              {}});
}

ExitCode show_sized_model(const frontend::SizedModel& model, const std::vector<std::string>& settings) {
  frontend::ModelSizes sizes;
  for (const auto& setting : settings) {
    const auto size = read_size(setting);
    if (!size) return refuse(size.error());
    sizes[size->first] = size->second;
  }
  const auto text = frontend::write_sized_model(model, sizes);
  if (!text) return refuse(text.error());
  print(*text);
  return ExitCode::done;
}

ExitCode show_model(const std::string& name, const std::vector<std::string>& settings) {
  if (const auto* sized = frontend::find_sized_model(name)) return show_sized_model(*sized, settings);
  if (!settings.empty()) {
    return refuse({ErrorCode::invalid_option,
                   fmt::format("--set belongs to models of any size; '{}' is none", name),
                   "change values where it is run: saltus simulate MODEL --set NAME=VALUE",
                   {},
                   {}});
  }
  const auto path = frontend::find_model(name);
  if (!path) return refuse(path.error());
  const auto text = io::read_file(*path);
  if (!text) return refuse(text.error());
  print(*text);
  return ExitCode::done;
}

}  // namespace

Command add_models(CLI::App& app) {
  auto* command = app.add_subcommand("models", "list the shipped models, or print one");
  // Shared: the parser fills it after this function has returned, the command reads it.
  auto name = std::make_shared<std::string>();
  command->add_option("NAME", *name, "model to print");
  auto settings = std::make_shared<std::vector<std::string>>();
  command->add_option("--set", *settings, "NAME=N of a model of any size, as blocks=1000; may repeat");
  command->footer(
      "Example:\n"
      "  saltus models spring-block --set blocks=1000 > chain.toml");
  return {"models", [name, settings] { return name->empty() ? list_models() : show_model(*name, *settings); }};
}

}  // namespace saltus::cli
