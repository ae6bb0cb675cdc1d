#include "saltus/cli/optimize_text.hpp"

#include <cstddef>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "saltus/model/ocp.hpp"
#include "saltus/pipeline/optimal_control/describe_ocp.hpp"

namespace saltus::cli {
namespace {

using pipeline::OcpCounts;

std::string counts_line(std::string_view title, const OcpCounts& counts) {
  return fmt::format("  {:<20}{:>12}{:>12}{:>12}{:>12}\n", title, counts.variables, counts.equations, counts.pairs,
                     counts.nonzeros);
}

bool same(const OcpCounts& a, const OcpCounts& b) {
  return a.variables == b.variables && a.equations == b.equations && a.pairs == b.pairs && a.nonzeros == b.nonzeros;
}

/// A line for all intervals that are alike and follow each other.
std::string lines_of(const std::vector<OcpCounts>& intervals) {
  std::string text;
  for (std::size_t first = 0; first < intervals.size();) {
    std::size_t end = first + 1;
    while (end < intervals.size() && same(intervals[first], intervals[end])) ++end;
    text += counts_line(
        end - first == 1 ? fmt::format("interval {}", first) : fmt::format("each of {} to {}", first, end - 1),
        intervals[first]);
    first = end;
  }
  return text;
}

}  // namespace

Expected<std::string> optimize_text(const ModelInput& input) {
  if (!input.file.optimize) return std::string();
  if (auto fits = io::check_optimize_options(input.file); !fits) return tl::unexpected(fits.error());
  io::ModelFile file = input.file;
  if (auto done = io::read_start_result(file); !done) return tl::unexpected(done.error());
  const auto ocp = model::build_ocp(file.description, input.overrides);
  if (!ocp) return tl::unexpected(io::located(ocp.error(), file));
  const auto overview = pipeline::describe_ocp(*ocp, *file.optimize);
  if (!overview) return tl::unexpected(io::located(overview.error(), file));
  std::string text = fmt::format("\noptimal control ({} control intervals)\n", overview->intervals.size());
  text += fmt::format("  {:<20}{:>12}{:>12}{:>12}{:>12}\n", "", "variables", "equations", "pairs", "nonzeros");
  text += lines_of(overview->intervals) + counts_line("problem", overview->problem);
  auto warnings = ocp->warnings;
  warnings.insert(warnings.end(), overview->warnings.begin(), overview->warnings.end());
  for (const auto& warning : warnings) text += fmt::format("  warning: {}\n", warning);
  return text;
}

}  // namespace saltus::cli
