#include <algorithm>
#include <cstddef>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "saltus/report/mpcc_table.hpp"
#include "saltus/report/optimization_table_internal.hpp"
#include "saltus/report/optimization_words_internal.hpp"
#include "saltus/report/text_columns_internal.hpp"

namespace saltus::report {
namespace {

template <class Value>
std::optional<Value> option(const result::OptionRecord& options, std::string_view key) {
  for (const auto& [name, value] : options) {
    if (name != key) continue;
    if (const auto* found = std::get_if<Value>(&value)) return *found;
  }
  return std::nullopt;
}

/// One number where all intervals have as many elements, else the least and the greatest.
std::string elements_text(const std::vector<std::vector<double>>& h) {
  if (h.empty()) return "";
  const auto [least, most] =
      std::minmax_element(h.begin(), h.end(), [](const auto& a, const auto& b) { return a.size() < b.size(); });
  const auto range = least->size() == most->size() ? fmt::format("{}", most->size())
                                                   : fmt::format("{} to {}", least->size(), most->size());
  return fmt::format("{} interval{} of {} element{}", h.size(), h.size() == 1 ? "" : "s", range,
                     most->size() == 1 ? "" : "s");
}

std::string findings_text(std::string_view label, const std::vector<Finding>& findings) {
  std::string text;
  for (const auto& finding : findings) text += paragraph(text.empty() ? label : "", finding.text);
  return text;
}

}  // namespace

double residual_tolerance(const result::OptionRecord& options) {
  constexpr double by_default = 1e-8;  // of [optimize.mpcc]
  return option<double>(options, "optimize.mpcc.tolerance").value_or(by_default);
}

std::string optimization_method(const result::Result& result) {
  const auto stages = option<std::int64_t>(result.options, "optimize.stages");
  std::vector<std::string> details{option<std::string>(result.options, "optimize.scheme").value_or(""),
                                   stages ? fmt::format("{} stages", *stages) : "",
                                   result.optimization ? elements_text(result.optimization->h) : ""};
  std::erase(details, "");
  return details.empty() ? result.method : fmt::format("{} ({})", result.method, fmt::join(details, ", "));
}

std::string objective_table(const result::Optimization& optimization) {
  const auto terms = objective_terms(optimization.terms);
  std::vector<std::string> parts;
  for (const auto& [term, value] : terms) parts.push_back(fmt::format("{} {:.8g}", term, value));
  auto objective = fmt::format("{:.12g}", optimization.objective);
  if (parts.size() == 1) objective += fmt::format(" ({})", terms.front().first);
  if (parts.size() > 1) objective += fmt::format(" ({})", fmt::join(parts, ", "));
  auto text = paragraph("objective", objective);
  text += paragraph("horizon", fmt::format("{:.12g}", optimization.horizon));
  parts.clear();
  for (const auto& [parameter, value] : optimization.parameters) {
    parts.push_back(fmt::format("{} = {:.12g}", parameter, value));
  }
  return parts.empty() ? text : text + wrapped("optimised", parts);
}

std::string findings_table(const result::Result& result, const result::Optimization& optimization) {
  return findings_text("certificate", certificate_findings(result)) +
         findings_text("simulated", verification_findings(optimization));
}

std::string optimization_statistics(const result::Optimization& optimization) {
  const auto& statistics = optimization.statistics;
  const auto of = [&](result::HomotopyPhase phase) {
    return std::count_if(optimization.homotopy.begin(), optimization.homotopy.end(),
                         [&](const auto& step) { return step.phase == phase; });
  };
  std::vector<std::string> kinds;
  using enum result::HomotopyPhase;
  for (const auto& [phase, word] :
       {std::pair(relaxed, "relaxed"), std::pair(branch, "branch"), std::pair(lpcc, "linear")}) {
    if (of(phase) > 0) kinds.push_back(fmt::format("{} {}", of(phase), word));
  }
  const auto solved = optimization.homotopy.size();
  auto text = paragraph("size", fmt::format("{} variables, {} equations, {} pairs", statistics.variables,
                                            statistics.equations, statistics.pairs));
  text += starts_table(optimization.starts);
  text += paragraph("statistics", fmt::format("{} problem{}{}, {} iterations; {:.3g} s (building {:.2g}; in all "
                                              "threads together: functions {:.2g}, linear algebra {:.2g})",
                                              solved, solved == 1 ? "" : "s",
                                              kinds.empty() ? "" : fmt::format(" ({})", fmt::join(kinds, ", ")),
                                              statistics.iterations, statistics.wall_seconds, statistics.build_seconds,
                                              statistics.evaluation_seconds, statistics.linear_algebra_seconds));
  return text;
}

}  // namespace saltus::report
