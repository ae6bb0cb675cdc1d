#include "saltus/report/mpcc_table.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "saltus/report/optimization_words_internal.hpp"
#include "saltus/report/text_columns_internal.hpp"

namespace saltus::report {
namespace {

constexpr std::size_t variables_shown = 12;

std::string residual(double value) { return std::isfinite(value) ? fmt::format("{:.1e}", value) : "not known"; }

std::string step_remark(const result::HomotopyStep& step) {
  if (!step.message.empty()) return shortened(step.message, 60);
  return step.termination == result::Termination::completed ? "" : std::string(name(step.termination));
}

std::string path_table(const std::vector<result::HomotopyStep>& steps) {
  if (steps.empty()) return "";
  std::vector<Row> rows{{"phase", "sigma", "iterations", "objective", "infeasible", "min(|G|, |H|)", "s", ""}};
  for (const auto& step : steps) {
    rows.push_back({std::string(name(step.phase)), fmt::format("{:.0e}", step.sigma),
                    fmt::format("{}", step.iterations), fmt::format("{:.9g}", step.objective),
                    residual(step.primal_infeasibility), residual(step.complementarity_residual),
                    fmt::format("{:.2f}", step.seconds), step_remark(step)});
  }
  return "path\n" + aligned(rows);
}

std::string variables_line(const result::MpccResult& result) {
  std::vector<std::string> pieces;
  for (std::size_t i = 0; i < std::min(result.x.size(), variables_shown); ++i) {
    const auto label = i < result.names.size() ? shortened(result.names[i], 24) : fmt::format("x[{}]", i);
    pieces.push_back(fmt::format("{} = {:.9g}", label, result.x[i]));
  }
  if (result.x.size() > variables_shown)
    pieces.push_back(fmt::format("and {} more", result.x.size() - variables_shown));
  return wrapped("variables", pieces);
}

/// What presolve has found, if anything.
std::string presolve_line(const result::PresolveCounts& of) {
  std::vector<std::string> pieces;
  const auto add = [&](int count, const char* what) {
    if (count > 0) pieces.push_back(fmt::format("{}: {}", what, count));
  };
  add(of.fixed_variables, "fixed variables");
  add(of.empty_rows, "empty rows");
  add(of.forced_pairs, "pairs with one side that is never zero");
  add(of.fixed_pairs, "pairs with one side that is always zero");
  return pieces.empty() ? "" : wrapped("presolve", pieces);
}

std::string not_unique_line(const std::vector<result::MpccMultipliers::Range>& rows) {
  if (rows.empty()) return "";
  std::string names;
  for (std::size_t i = 0; i < std::min<std::size_t>(rows.size(), 3); ++i) {
    names += fmt::format("{}{}", i > 0 ? ", " : "", rows[i].name);
  }
  return paragraph("", fmt::format("Multipliers of {} row{} are not unique: {}{}.", rows.size(),
                                   rows.size() == 1 ? "" : "s", names, rows.size() > 3 ? ", ..." : ""));
}

}  // namespace

std::string to_line(const result::HomotopyStep& step) {
  return fmt::format(
      "{:<8} sigma {:<8.1e} {:>5} iterations   objective {:<16.9g} infeasible {:<8} min(|G|, |H|) {:<8} {:.2f} s{}",
      name(step.phase), step.sigma, step.iterations, step.objective, residual(step.primal_infeasibility),
      residual(step.complementarity_residual), step.seconds, step.message.empty() ? "" : "   " + step.message);
}

std::string starts_table(const std::vector<result::StartOutcome>& starts) {
  if (starts.empty()) return "";
  std::vector<std::vector<std::string>> rows{{"seed", "", "objective", "violation", "iterations", "s"}};
  for (const auto& start : starts) {
    rows.push_back({fmt::format("{}{}", start.seed, start.is_taken ? " *" : ""), std::string(name(start.termination)),
                    fmt::format("{:.9g}", start.objective), residual(start.infeasibility),
                    fmt::format("{}", start.iterations), fmt::format("{:.2f}", start.seconds)});
  }
  return "starts (*: taken)\n" + aligned(rows);
}

std::string to_table(const result::MpccResult& result) {
  const auto& statistics = result.statistics;
  std::string text = wrapped("file", {result.file});
  text += wrapped("size", {fmt::format("variables: {}", result.x.size()), fmt::format("rows: {}", statistics.equations),
                           fmt::format("complementarities: {}", statistics.pairs)});
  text += presolve_line(result.presolve);
  text += paragraph("status", std::string(name(result.status.termination)) +
                                  (result.status.message.empty() ? "" : ": " + result.status.message));
  text += wrapped("objective", {fmt::format("{:.12g}", result.objective)});
  const char* label = "certificate";
  for (const auto& finding : certificate_findings(result.certificate, result.tolerance)) {
    text += paragraph(label, finding.text);
    label = "";
  }
  text += not_unique_line(result.multipliers.not_unique);
  text += variables_line(result);
  text += starts_table(result.starts);
  text += path_table(result.homotopy);
  text += wrapped("statistics", {fmt::format("{} iterations", statistics.iterations),
                                 fmt::format("{:.2f} s reading and derivatives", statistics.build_seconds),
                                 fmt::format("{:.2f} s solving", statistics.wall_seconds)});
  return text;
}

}  // namespace saltus::report
