#include <filesystem>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "saltus/cli/commands.hpp"
#include "saltus/cli/outputs.hpp"
#include "saltus/cli/terminal.hpp"
#include "saltus/io/json_result.hpp"

namespace saltus::cli {
namespace {

struct ReportArguments {
  std::string result;
  std::string page;
};

ExitCode run_report(const ReportArguments& arguments) {
  const auto page = arguments.page.empty() ? std::filesystem::path(arguments.result).replace_extension(".html").string()
                                           : arguments.page;
  const auto result = io::read_result(arguments.result);
  if (!result) return refuse(result.error());
  const auto output = Outputs::make({}, page, arguments.result);
  if (!output) return refuse(output.error());
  if (auto written = output->write(*result); !written) return refuse(written.error());
  print(page + "\n");
  return ExitCode::done;
}

}  // namespace

Command add_report(CLI::App& app) {
  auto* command = app.add_subcommand("report", "make the page with pictures of a stored result");
  // Shared: the parser fills it after this function has returned, the command reads it.
  auto arguments = std::make_shared<ReportArguments>();
  command->add_option("RESULT", arguments->result, "result written by simulate --out RESULT.json")->required();
  command->add_option("--out", arguments->page, "page to write (default: the result's name with .html)")
      ->type_name("FILE.html");
  command->footer("Example:\n  saltus simulate stick-slip --out stick-slip.json && saltus report stick-slip.json");
  return {"report", [arguments] { return run_report(*arguments); }};
}

}  // namespace saltus::cli
