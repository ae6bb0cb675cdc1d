#include "saltus/frontend/reformulation_text.hpp"

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "saltus/model/frozen_system.hpp"
#include "saltus/model/system.hpp"
#include "saltus/model/time_freezing/time_freezing.hpp"
#include "saltus/pipeline/well_posedness.hpp"
#include "saltus/reformulation/dcs.hpp"
#include "saltus/reformulation/sizes.hpp"

namespace saltus::frontend {
namespace {

using reformulation::Counts;
using reformulation::Form;
using reformulation::ReformulationOptions;
using reformulation::Sizes;

struct Row {
  std::string_view title;
  ReformulationOptions options;
};

const Row forms_of_sizes[] = {
    {"step", {.reformulation = Form::step, .lifting = std::nullopt}},
    {"step, lifted", {}},
    {"stewart", {.reformulation = Form::stewart}},
};

std::string line(std::string_view title, const Counts& counts) {
  return fmt::format("  {:<28}{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}\n", title, counts.alpha, counts.theta, counts.beta,
                     counts.algebraic, counts.complementarities, counts.equations);
}

/// At most 24 characters.
std::string shortened(const std::vector<std::string>& names) {
  constexpr std::size_t most = 24;
  const std::string text = fmt::format("{}", fmt::join(names, ", "));
  if (text.size() <= most) return text;
  const std::string count = names.size() > 1 ? fmt::format("… ({})", names.size()) : "…";
  const std::size_t room = most - std::min(most, count.size() - 2);  // the ellipsis is one character of three bytes
  return text.substr(0, room) + count;
}

/// The system that finite elements discretise: the frozen one, where there are contacts or hysteresis.
const model::System& of_elements(const model::System& system) {
  return system.frozen && system.frozen->system() ? *system.frozen->system() : system;
}

/// A line for each group of surfaces, and one for all that follow each other with the same numbers.
std::string groups_text(const Sizes& sizes) {
  if (sizes.groups.size() < 2) return "";
  std::string text;
  for (auto first = sizes.groups.begin(); first != sizes.groups.end();) {
    const auto end =
        std::find_if(first, sizes.groups.end(), [&](const auto& group) { return !(group.counts == first->counts); });
    const auto alike = end - first;
    text += line(alike == 1 ? "  " + shortened(first->surfaces)
                            : fmt::format("  {} … ({} alike)", shortened(first->surfaces), alike),
                 first->counts);
    first = end;
  }
  return text;
}

struct FormSizes {
  std::string_view title;
  Expected<Sizes> sizes;
};

/// Every form of a system with its sizes, or why it has none; empty where nothing switches with the state. Lifting is
/// a form of its own where it adds variables.
std::vector<FormSizes> sizes_by_form(const model::System& system) {
  std::vector<ReformulationOptions> options;
  for (const Row& row : forms_of_sizes) options.push_back(row.options);
  auto all = reformulation::sizes_of_all(of_elements(system), options);
  std::vector<FormSizes> forms;
  for (const Row& row : forms_of_sizes) {
    auto& sizes = all[static_cast<std::size_t>(&row - forms_of_sizes)];
    if (sizes && sizes->groups.empty()) return {};
    if (sizes && &row == &forms_of_sizes[1] && sizes->total.beta == 0) continue;
    forms.push_back({row.title, std::move(sizes)});
  }
  return forms;
}

std::string reason_of(const Error& error) { return fmt::format("{}; {}", error.message, error.remedy); }

}  // namespace

std::string reformulation_text(const model::System& system) {
  if (system.switching.size() > most_reformulated) {
    return fmt::format("\ncomplementarity systems\n  not made: more than {} switching functions\n", most_reformulated);
  }
  const std::string text = "\ncomplementarity systems (numbers of one stage, Table 4 of Nurkanović et al. 2024)\n";
  const auto forms = sizes_by_form(system);
  if (forms.empty()) return text + "  none: nothing switches with the state\n";
  // Without the first form there is one reason for all.
  if (!forms.front().sizes) return text + fmt::format("  none: {}\n", reason_of(forms.front().sizes.error()));
  std::string table, reasons;
  for (const auto& [title, sizes] : forms) {
    if (sizes) {
      table += line(title, sizes->total) + groups_text(*sizes);
    } else {
      reasons += fmt::format("  {}: none: {}\n", title, reason_of(sizes.error()));
    }
  }
  return text +
         fmt::format("  {:<28}{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}\n", "form", "n_alpha", "n_theta", "n_beta", "n_alg",
                     "n_comp", "n_eq") +
         table + reasons;
}

std::vector<io::OverviewForm> complementarity_forms(const model::System& system) {
  if (of_elements(system).switching.size() > most_reformulated) {
    return {{.name = "all", .reason = fmt::format("not made: more than {} switching functions", most_reformulated)}};
  }
  std::vector<io::OverviewForm> forms;
  for (const auto& [title, sizes] : sizes_by_form(system)) {
    const Counts total = sizes ? sizes->total : Counts{};
    forms.push_back({.name = std::string(title),
                     .reason = sizes ? "" : reason_of(sizes.error()),
                     .alpha = total.alpha,
                     .theta = total.theta,
                     .beta = total.beta,
                     .algebraic = total.algebraic,
                     .complementarities = total.complementarities,
                     .equations = total.equations});
  }
  return forms;
}

std::string ranks_text(const model::System& system, const pipeline::SimulateOptions& options,
                       const pipeline::Observers& observers) {
  // Without one there is nothing to look at.
  if (!end_time(options) || !reformulation::reformulate(system)) return "";
  const auto ranks = pipeline::ranks_along_solution(system, options, observers);
  std::string text = "\nwell-posedness along the solution of [simulate] (rank of W B, Assumption 7 ibid.)\n";
  if (!ranks) return text + fmt::format("  not computed: {}\n", ranks.error().message);
  if (ranks->active_sets.empty()) text += "  nothing slides\n";
  for (const auto& set : ranks->active_sets) {
    text += fmt::format("  {} = 0, first at t = {:.6g}, {} row{}\n", fmt::join(set.names, ", "), set.first, set.rows,
                        set.rows == 1 ? "" : "s");
    for (const auto& form : set.forms) {
      text += fmt::format("    {:<8} rank {} of {}, smallest singular value {:.3g}{}\n",
                          form.form == Form::step ? "step" : "stewart", form.rank, form.unknowns,
                          form.smallest_singular_value,
                          form.rank < form.unknowns ? ": singular, the multipliers are not determined by it" : "");
    }
  }
  const auto& status = ranks->status;
  if (!result::is_done(status.termination)) {
    text += fmt::format("  the simulation stopped at t = {:.6g}: {}\n", status.time_reached, status.message);
  }
  return text;
}

}  // namespace saltus::frontend
