#include <algorithm>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "saltus/cli/catalogue.hpp"
#include "saltus/cli/commands.hpp"
#include "saltus/cli/text/terminal.hpp"
#include "saltus/io/atomic_file.hpp"
#include "saltus/io/toml/toml_model.hpp"

namespace saltus::cli {
namespace {

ExitCode list_models() {
  const auto entries = catalogue();
  std::size_t width = 0;
  for (const auto& entry : entries) width = std::max(width, entry.name.size());
  for (const auto& entry : entries) {
    const auto model = io::read_model(entry.file);
    print(fmt::format(
        "{:<{}}  {}\n", entry.name, width,
        model ? model->description.description : fmt::format("(cannot be read: {})", model.error().message)));
  }
  if (!entries.empty()) return ExitCode::done;
  return refuse(
      {ErrorCode::io_failure, "the catalogue is empty", "set SALTUS_MODELS to a folder of model files", {}, {}});
}

ExitCode show_model(const std::string& name) {
  const auto path = find_model(name);
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
  command->footer("Example:\n  saltus models stick-slip > my-model.toml");
  return {"models", [name] { return name->empty() ? list_models() : show_model(*name); }};
}

}  // namespace saltus::cli
