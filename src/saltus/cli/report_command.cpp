#include <filesystem>
#include <memory>
#include <set>

#include <fmt/format.h>

#include "saltus/cli/command_line_internal.hpp"
#include "saltus/cli/commands.hpp"
#include "saltus/cli/outputs.hpp"
#include "saltus/cli/text/figure_file.hpp"
#include "saltus/cli/text/terminal.hpp"
#include "saltus/io/json/json_result.hpp"
#include "saltus/report/figure.hpp"

namespace saltus::cli {
namespace {

struct ReportArguments {
  std::vector<std::string> results;
  std::string page;
  std::vector<std::string> figures;
  std::string phase, columns;
  bool open = false;
};

/// All drawings, or the first mistake; nothing is written before all is known to be right.
Expected<void> write_figures(const ReportArguments& arguments, const result::Result& result,
                             const std::vector<report::Overlay>& overlays) {
  std::optional<report::PhaseAxes> phase;
  if (!arguments.phase.empty()) {
    auto axes = report::phase_axes(result, arguments.phase);
    if (!axes) return tl::unexpected(axes.error());
    phase = std::move(*axes);
  }
  std::vector<std::string> columns;
  if (!arguments.columns.empty()) {
    auto names = report::figure_names(result, arguments.columns);
    if (!names) return tl::unexpected(names.error());
    columns = std::move(*names);
  }
  for (const auto& file : arguments.figures) {
    if (auto possible = check_figure(file); !possible) return possible;
  }
  if (arguments.figures.empty()) return {};
  const auto svg = report::to_svg(result, phase, columns, overlays);
  if (!svg) return tl::unexpected(svg.error());
  for (const auto& file : arguments.figures) {
    if (auto written = write_figure(file, *svg); !written) return written;
    print(file + "\n");
  }
  return {};
}

/// The results behind the first, as far as they are of the same model.
Expected<std::vector<report::Overlay>> read_overlays(const std::vector<std::string>& files,
                                                     const result::Result& first) {
  std::vector<report::Overlay> overlays;
  for (std::size_t i = 1; i < files.size(); ++i) {
    auto result = io::read_result(files[i]);
    if (!result) return tl::unexpected(result.error());
    overlays.push_back({std::filesystem::path(files[i]).filename().string(), std::move(*result)});
    if (auto fits = report::check_overlay(first, overlays.back()); !fits) return tl::unexpected(fits.error());
  }
  return overlays;
}

Expected<void> write_page(const std::string& page, const ReportArguments& arguments, const result::Result& result,
                          const std::vector<report::Overlay>& overlays) {
  const OutputNames names{.report = page, .report_option = "--out"};
  for (const auto& input : arguments.results) {
    // None of the results that are read may be written over.
    if (auto output = Outputs::make(names, input); !output) return tl::unexpected(output.error());
  }
  const auto output = Outputs::make(names, arguments.results.front());
  if (!output) return tl::unexpected(output.error());
  if (auto written = output->write(result, ShowProgress::when_terminal, overlays); !written) {
    return tl::unexpected(written.error());
  }
  print(page + "\n");
  return {};
}

ExitCode run_report(const ReportArguments& arguments) {
  const bool is_plane = !arguments.phase.empty();
  if ((is_plane || !arguments.columns.empty()) && arguments.figures.empty()) {
    return refuse(
        {ErrorCode::invalid_option,
         fmt::format("{} chooses the columns of a drawing, and there is none", is_plane ? "--phase" : "--columns"),
         "add --figure FILE.svg; in a page the columns are chosen with the mouse",
         {},
         {}});
  }
  if (is_plane && !arguments.columns.empty()) {
    return refuse({ErrorCode::invalid_option,
                   "--columns chooses what is drawn over time, and --phase draws in a plane",
                   "give one of them",
                   {},
                   {}});
  }
  const auto result = io::read_result(arguments.results.front());
  if (!result) return refuse(result.error());
  const auto overlays = read_overlays(arguments.results, *result);
  if (!overlays) return refuse(overlays.error());
  if (auto drawn = write_figures(arguments, *result, *overlays); !drawn) return refuse(drawn.error());
  // With drawings alone no page is made unless it is asked for.
  if (!arguments.figures.empty() && arguments.page.empty() && !arguments.open) return ExitCode::done;
  const auto page = arguments.page.empty()
                        ? std::filesystem::path(arguments.results.front()).replace_extension(".html").string()
                        : arguments.page;
  if (auto written = write_page(page, arguments, *result, *overlays); !written) return refuse(written.error());
  if (!arguments.open) return ExitCode::done;
  // The page is there, whoever can show it.
  if (auto opened = open_page(page); !opened) {
    print_error(fmt::format("note: {} is written; {}\n  {}", page, opened.error().message, opened.error().remedy));
  }
  return ExitCode::done;
}

}  // namespace

Command add_report(CLI::App& app) {
  auto* command = app.add_subcommand(
      "report", "make the page with pictures of a stored result, or of several laid over each other");
  // Shared: the parser fills it after this function has returned, the command reads it.
  auto arguments = std::make_shared<ReportArguments>();
  command
      ->add_option("RESULT", arguments->results,
                   "result written by simulate --out RESULT.json; further ones of the same model are laid over it")
      ->required();
  command->add_option("--out", arguments->page, "page to write (default: the result's name with .html)")
      ->type_name("FILE.html");
  command
      ->add_option("--figure", arguments->figures,
                   "draw into this file instead of a page; .pdf and .png need rsvg-convert (librsvg2-bin); repeatable")
      ->type_name("FILE.svg|.pdf|.png")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command
      ->add_option("--phase", arguments->phase,
                   "draw column Y over column X: states, controls, outputs, alpha(NAME) or t; default: all over time")
      ->type_name("X,Y");
  command
      ->add_option("--columns", arguments->columns,
                   "draw these columns over time, in this order; default: what moves, as in the page")
      ->type_name("X,Y,…");
  command->add_flag("--open", arguments->open, "show the page with $BROWSER, else xdg-open");
  command->footer(
      "Example:\n  saltus simulate stick-slip --out stick-slip.json && saltus report stick-slip.json --figure "
      "plane.svg --phase q,v");
  return {"report", [arguments] { return run_report(*arguments); }};
}

}  // namespace saltus::cli
