#include "saltus/frontend/optimize_text.hpp"

#include <cstddef>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "saltus/model/ocp.hpp"

namespace saltus::frontend {
namespace {

using pipeline::OcpCounts;
using pipeline::OcpOverview;

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

Expected<std::optional<OcpOverview>> optimize_overview(const ModelInput& input) {
  if (!input.file.optimize) return std::optional<OcpOverview>();
  if (auto fits = io::check_optimize_options(input.file); !fits) return tl::unexpected(fits.error());
  io::ModelFile file = input.file;
  if (auto done = io::read_start_result(file); !done) return tl::unexpected(done.error());
  const auto ocp = model::build_ocp(file.description, input.overrides);
  if (!ocp) return tl::unexpected(io::located(ocp.error(), file));
  auto overview = pipeline::describe_ocp(*ocp, *file.optimize);
  if (!overview) return tl::unexpected(io::located(overview.error(), file));
  overview->warnings.insert(overview->warnings.begin(), ocp->warnings.begin(), ocp->warnings.end());
  return std::optional<OcpOverview>(std::move(*overview));
}

std::string optimize_text(const OcpOverview& overview) {
  std::string text = fmt::format("\noptimal control ({} control intervals)\n", overview.intervals.size());
  text += fmt::format("  {:<20}{:>12}{:>12}{:>12}{:>12}\n", "", "variables", "equations", "pairs", "nonzeros");
  text += lines_of(overview.intervals) + counts_line("problem", overview.problem);
  for (const auto& warning : overview.warnings) text += fmt::format("  warning: {}\n", warning);
  return text;
}

}  // namespace saltus::frontend
