
#include "saltus/cli/command_line_internal.hpp"
#include "saltus/cli/commands.hpp"
#include "saltus/cli/text/terminal.hpp"
#include "saltus/pipeline/options/optimize_fields.hpp"
#include "saltus/pipeline/options/option_fields.hpp"

namespace saltus::cli {

Command add_options_page(CLI::App& app) {
  auto* command = app.add_subcommand("options-page", "print docs/options.md");
  command->group("");  // for developers: not in --help
  command->footer("Example:\n  saltus options-page > docs/options.md");
  return {"options-page", [] {
            print(pipeline::options_page() + pipeline::optimize_options_page());
            return ExitCode::done;
          }};
}

}  // namespace saltus::cli
