#include "saltus/frontend/overview_text.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "saltus/base/told_together.hpp"

namespace saltus::frontend {
namespace {

using io::ModelOverview;

std::string heading(std::string_view title, std::size_t count) { return fmt::format("\n{} ({})\n", title, count); }

/// One line each; of a large model those of the first and the last entries.
template <class Entries, class LineOf>
std::string shown_lines(const Entries& entries, LineOf line_of) {
  constexpr std::size_t most = 60, at_front = 20, at_back = 4;
  std::string text;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    if (entries.size() > most && i == at_front) {
      text += fmt::format("  … ({} more; --json shows all)\n", entries.size() - at_front - at_back);
      i = entries.size() - at_back;
    }
    text += line_of(entries[i]);
  }
  return text;
}

std::string bounds(const io::OverviewQuantity& quantity) {
  if (std::isinf(quantity.lower) && std::isinf(quantity.upper)) return "";
  return fmt::format("  in [{}, {}]", quantity.lower, quantity.upper);
}

std::string in_unit(const result::Caption& caption) { return caption.unit.empty() ? "" : " " + caption.unit; }
std::string labelled(const result::Caption& caption) {
  return caption.label.empty() ? "" : fmt::format("  ({})", caption.label);
}

std::string quantities_text(std::string_view title, const std::vector<io::OverviewQuantity>& quantities) {
  return heading(title, quantities.size()) + shown_lines(quantities, [](const io::OverviewQuantity& quantity) {
           return fmt::format("  {} = {}{}{}{}{}\n", quantity.name, quantity.value, in_unit(quantity.caption),
                              bounds(quantity), labelled(quantity.caption),
                              quantity.remark.empty() ? "" : "  " + quantity.remark);
         });
}

std::string equations_text(const std::vector<io::OverviewEquation>& equations, std::string_view prime) {
  return shown_lines(equations, [&](const io::OverviewEquation& equation) {
    const std::string unit = equation.caption.unit.empty() ? "" : fmt::format("  [{}]", equation.caption.unit);
    return fmt::format("  {}{} = {}{}{}\n", equation.name, prime, equation.text, unit, labelled(equation.caption));
  });
}

std::string named_text(std::string_view title, const std::vector<io::OverviewEquation>& equations) {
  return equations.empty() ? "" : heading(title, equations.size()) + equations_text(equations, "");
}

/// Definitions, those that are recorded marked, and the outputs that are none of them.
std::string definitions_text(const ModelOverview& overview) {
  auto definitions = overview.definitions;
  auto outputs = overview.outputs;
  for (auto& definition : definitions) {
    const auto count = std::erase_if(outputs, [&](const io::OverviewEquation& output) {
      return output.name == definition.name && output.text == definition.name;
    });
    if (count > 0) definition.text += ", recorded";
  }
  return named_text("definitions", definitions) + named_text("outputs", outputs);
}

std::string mode_text(const io::OverviewMode& mode) {
  std::vector<std::string> rates;
  for (const auto& rate : mode.rates) rates.push_back(fmt::format("{}' = {}", rate.name, rate.text));
  return fmt::format("    {}{}: {}\n", mode.name.empty() ? "" : mode.name + ", ", mode.when,
                     rates.empty() ? "all rates 0" : fmt::format("{}", fmt::join(rates, ", ")));
}

/// Groups of [[modes]], which are summed.
std::string modes_text(const ModelOverview& overview) {
  if (overview.modes.empty()) return "";
  std::vector<std::pair<std::string, std::string>> groups;
  for (const auto& mode : overview.modes) {
    auto group = std::find_if(groups.begin(), groups.end(), [&](const auto& g) { return g.first == mode.group; });
    if (group == groups.end()) group = groups.insert(groups.end(), {mode.group, ""});
    group->second += mode_text(mode);
  }
  std::string text = heading("groups of modes", groups.size());
  for (const auto& [name, lines] : groups) {
    const auto regions = std::count(lines.begin(), lines.end(), '\n');
    std::vector<std::string> by_indicator;
    for (const auto& mode : overview.modes) {
      if (mode.group == name && !mode.name.empty()) by_indicator.push_back(mode.name);
    }
    text += fmt::format(
        "  {}: {} region{}\n{}{}", name.empty() ? "(without name)" : name, regions, regions == 1 ? "" : "s",
        by_indicator.empty() ? "" : fmt::format("    by the smallest indicator: {}\n", fmt::join(by_indicator, ", ")),
        lines);
  }
  return text;
}

/// "slip: v - 0.2 = 0", "v - 0.2 = 0" of one without a name, "hot: region".
std::string surface_head(const io::OverviewSurface& surface) {
  const bool is_plain = surface.role == "listed" || surface.role == "kink";
  const bool has_expression = !surface.expression.empty() && surface.role != "region";
  std::string compact = surface.expression;
  std::erase(compact, ' ');
  const bool is_named = !has_expression || compact != surface.name;
  std::string text = is_named ? surface.name + ":" : "";
  if (!is_plain) text += fmt::format("{}{}:", text.empty() ? "" : " ", surface.role);
  return has_expression ? fmt::format("{}{}{} = 0;", text, text.empty() ? "" : " ", surface.expression) : text;
}

std::string surface_text(const io::OverviewSurface& surface) {
  if (!surface.alias_of.empty()) {
    return fmt::format("  {}: alias of {}{}\n", surface.name, surface.alias_of,
                       surface.swapped ? ", with the sides swapped" : "");
  }
  const std::string inner =
      surface.inner.empty() ? "" : fmt::format("; depends on the sign of {}", fmt::join(surface.inner, ", "));
  return fmt::format("  {} {}{}\n", surface_head(surface), surface.meaning, inner);
}

std::string surfaces_text(const ModelOverview& overview) {
  return heading("switching functions", overview.surfaces.size()) + shown_lines(overview.surfaces, surface_text);
}

std::string cells_text(const ModelOverview& overview) {
  if (overview.cells.empty()) return "";
  std::string text = heading("piecewise functions", overview.cells.size());
  text += shown_lines(overview.cells, [](const auto& cell) { return fmt::format("  {}: {}\n", cell.name, cell.text); });
  return text + "  the integrator restarts where an argument leaves its piece\n";
}

std::string events_text(const ModelOverview& overview) {
  if (overview.events.empty()) return "";
  std::string text = heading("events", overview.events.size());
  return text + shown_lines(overview.events, [](const auto& event) {
           return fmt::format("  {}: {}{}\n", event.name, event.when, event.stops ? ": stops the simulation" : "");
         });
}

std::string jumps_text(const ModelOverview& overview) {
  if (overview.jumps.empty()) return "";
  return heading("jumps", overview.jumps.size()) + shown_lines(overview.jumps, [](const auto& jump) {
           std::vector<std::string> targets, values;
           for (const auto& [name, value, caption] : jump.set) {
             targets.push_back(name);
             values.push_back(fmt::format("{} becomes {}", name, value));
           }
           return fmt::format("  {}: {}; sets {}: {}\n", jump.name, jump.when, fmt::join(targets, ", "),
                              fmt::join(values, ", "));
         });
}

/// Of two ways to state the motion on several surfaces, where it matters which.
std::string inclusion_text(const ModelOverview& overview) {
  const bool is_other = overview.inclusion != "filippov";
  if (overview.inclusion_differences.empty() && !is_other) return "";
  return fmt::format("\ninclusion: {}\n  filippov and aizerman_pyatnitskii differ in: {}\n", overview.inclusion,
                     overview.inclusion_differences.empty()
                         ? "nothing"
                         : fmt::format("{}", fmt::join(overview.inclusion_differences, ", ")));
}

}  // namespace

std::string inclusion_in_depth(const ModelOverview& overview) {
  std::string text = fmt::format("\ninclusion: {}\n", overview.inclusion);
  text += fmt::format("  the right-hand side as written is {}multi-affine in the selections\n",
                      overview.multi_affine ? "" : "not ");
  if (overview.inclusion_differences.empty()) {
    return text + "  filippov and aizerman_pyatnitskii are the same for this model\n";
  }
  return text + fmt::format("  filippov and aizerman_pyatnitskii differ in: {}\n",
                            fmt::join(overview.inclusion_differences, ", "));
}

std::string overview_text(const ModelOverview& overview, const std::string& path) {
  const std::string_view colon = overview.description.empty() ? "" : ": ";
  std::string text = fmt::format("{}{}{}\n{}\n", overview.name, colon, overview.description, path);
  text += quantities_text("states", overview.states) + quantities_text("parameters", overview.parameters) +
          quantities_text("controls", overview.controls);
  text += heading("equations", overview.equations.size()) + equations_text(overview.equations, "'");
  text += modes_text(overview) + definitions_text(overview);
  for (std::size_t i = 0; i < overview.contacts.size(); ++i) {
    if (i == 0) text += heading("contacts", overview.contacts.size());
    text += fmt::format("  {}: {}\n", overview.contacts[i].name, overview.contacts[i].text);
  }
  return text + surfaces_text(overview) + cells_text(overview) + events_text(overview) + jumps_text(overview) +
         inclusion_text(overview);
}

std::string warnings_text(const ModelOverview& overview) {
  std::string text = heading("warnings", overview.warnings.size());
  const auto told = told_together(overview.warnings);
  for (const auto& warning : told) text += fmt::format("  {}\n", warning);
  return text + (told.size() < overview.warnings.size() ? "  (--json shows all)\n" : "");
}

}  // namespace saltus::frontend
