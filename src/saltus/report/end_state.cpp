#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "saltus/base/contains.hpp"
#include "saltus/report/end_state_internal.hpp"
#include "saltus/report/table.hpp"
#include "saltus/report/text_columns_internal.hpp"
#include "saltus/result/kept_columns.hpp"

namespace saltus::report {
namespace {

/// Beyond this many a line for each says less than a summary.
constexpr std::size_t most_pieces = 60;

/// Of the words that fit a terminal the first and the last ones.
std::vector<std::string> few_of(std::vector<std::string> pieces) {
  constexpr std::size_t at_front = 20, at_back = 4;
  if (pieces.size() <= most_pieces) return pieces;
  std::vector<std::string> few(pieces.begin(), pieces.begin() + at_front);
  few.push_back(fmt::format("… ({} in all)", pieces.size()));
  few.insert(few.end(), pieces.end() - at_back, pieces.end());
  return few;
}

/// A name with # for its numbers: what "v1" and "v2" have in common.
std::string stem_of(const std::string& name) {
  std::string stem;
  for (const char c : name) {
    if (c < '0' || c > '9') {
      stem += c;
    } else if (stem.empty() || stem.back() != '#') {
      stem += '#';
    }
  }
  return stem;
}

/// Numbers of names with the same stem, in the order of the first of each.
std::vector<std::vector<std::size_t>> families_of(const std::vector<std::string>& names) {
  std::map<std::string, std::size_t> places;
  std::vector<std::vector<std::size_t>> families;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto [place, is_new] = places.emplace(stem_of(names[i]), families.size());
    if (is_new) families.emplace_back();
    families[place->second].push_back(i);
  }
  return families;
}

/// What the model says about what is shown.
std::string labels_text(const std::vector<std::string>& names, const result::Captions& captions) {
  std::map<std::string, std::string> labels;
  for (const auto& [name, caption] : captions) {
    if (!caption.label.empty()) labels.emplace(name, caption.label);
  }
  std::vector<std::string> pieces;
  for (const auto& name : names) {
    const auto found = labels.find(name);
    if (found != labels.end()) pieces.push_back(fmt::format("{}: {}", name, found->second));
  }
  return pieces.empty() ? "" : wrapped("where", few_of(std::move(pieces)));
}

struct Values {
  const std::vector<std::string>& names;
  const std::vector<double>& values;
  const result::Captions& captions;

  /// Without the sign of zero.
  [[nodiscard]] std::string number(std::size_t i, const char* form = "{:.12g}") const {
    const auto unit = caption_of(captions, names[i]).unit;
    return fmt::format("{}{}{}", fmt::format(fmt::runtime(form), values[i] + 0.0), unit.empty() ? "" : " ", unit);
  }
  /// "q = 0.5 m"
  [[nodiscard]] std::string piece(std::size_t i) const { return fmt::format("{} = {}", names[i], number(i)); }
};

/// The least and the greatest one.
Row family_row(const Values& all, const std::vector<std::size_t>& family) {
  const auto less = [&](std::size_t i, std::size_t k) { return all.values[i] < all.values[k]; };
  const auto [least, greatest] = std::minmax_element(family.begin(), family.end(), less);
  const auto place = [&](std::size_t i) { return fmt::format("({})", all.names[i]); };
  return {fmt::format("{} … {}", all.names[family.front()], all.names[family.back()]),
          fmt::format("{}", family.size()),
          "from",
          all.number(*least, "{:.6g}"),
          place(*least),
          "to",
          all.number(*greatest, "{:.6g}"),
          place(*greatest)};
}

/// Of many names a line for each family of them.
std::string summary_of(const char* label, const char* what, const Values& all, std::size_t count) {
  constexpr std::size_t least_family = 6;
  std::vector<std::string> single;
  std::vector<Row> rows;
  for (const auto& family : families_of({all.names.begin(), all.names.begin() + static_cast<std::ptrdiff_t>(count)})) {
    if (family.size() >= least_family) {
      rows.push_back(family_row(all, family));
    } else {
      for (const std::size_t i : family) single.push_back(all.piece(i));
    }
  }
  std::string text = paragraph(label, fmt::format("{} {}; --show NAME,… shows those you name (v3, v*)", count, what));
  if (!rows.empty()) text += aligned(rows);
  return single.empty() ? text : text + wrapped("", few_of(std::move(single)));
}

std::string values_text(const char* label, const char* what, const Values& all) {
  const std::size_t count = std::min(all.names.size(), all.values.size());
  if (count > most_pieces) return summary_of(label, what, all, count);
  std::vector<std::string> pieces;
  for (std::size_t i = 0; i < count; ++i) pieces.push_back(all.piece(i));
  return wrapped(label, pieces);
}

std::string sliding_text(const result::Result& result) {
  std::vector<std::string> pieces;
  const bool smoothed = result.method == "smoothed";
  for (std::size_t j = 0; j < result.switching_functions.size() && j < result.final.mode.size(); ++j) {
    if (result.final.mode[j] != 0) continue;
    const double alpha = j < result.final.alpha.size() ? result.final.alpha[j] : 0.0;
    pieces.push_back(fmt::format("{}{} ({})", shortened(result.switching_functions[j], 40), smoothed ? "" : " = 0",
                                 std::isfinite(alpha) ? fmt::format("alpha {:.6g}", alpha) : "alpha not determined"));
  }
  if (pieces.empty()) return "";
  const auto* label = smoothed ? "in layer of" : "sliding on";
  if (pieces.size() <= most_pieces) return wrapped(label, pieces);
  return paragraph(label,
                   fmt::format("{} of {} switching functions", pieces.size(), result.switching_functions.size()));
}

std::string regions_text(const result::Result& result) {
  std::vector<std::string> pieces;
  const auto labels = result::region_labels(result.region_groups);
  std::size_t label = 0;
  for (std::size_t g = 0; g < std::min(result.region_groups.size(), result.final.regions.size()); ++g) {
    const auto& active = result.final.regions[g];
    for (const auto& mode : result.region_groups[g].modes) {
      const std::size_t k = label++;
      if (!contains(active, mode) || k >= result.final.theta.size()) continue;
      const bool alone = active.size() == 1;
      pieces.push_back(shortened(labels[k], 40) + (alone ? "" : fmt::format(" (theta {:.6g})", result.final.theta[k])));
    }
  }
  return pieces.empty() ? "" : wrapped("regions", few_of(std::move(pieces)));
}

/// The mode of every contact; of many how many have each.
std::string contacts_text(const result::Result& result) {
  const std::size_t count = std::min(result.contacts.size(), result.final.contact_modes.size());
  std::vector<std::string> pieces;
  std::map<result::ContactMode, std::size_t> counts;
  for (std::size_t k = 0; k < count; ++k) {
    ++counts[result.final.contact_modes[k]];
    pieces.push_back(fmt::format("{}: {}", shortened(result.contacts[k], 40), name(result.final.contact_modes[k])));
  }
  if (count > most_pieces) {
    pieces.clear();
    for (const auto& [mode, of_mode] : counts) pieces.push_back(fmt::format("{} {}", of_mode, name(mode)));
  }
  return pieces.empty() ? "" : wrapped("contacts", pieces);
}

/// What is named, each by itself.
std::string named_values(const result::Result& result, const std::vector<std::string>& names) {
  std::vector<std::string> pieces, shown;
  const auto add = [&](const std::vector<std::string>& all, const std::vector<double>& values) {
    const Values list{all, values, result.model.captions};
    for (const auto& name : names) {
      const auto found = result::numbers_of({name}, all);
      if (!found) continue;
      for (const std::size_t i : *found) {
        if (i >= values.size()) continue;
        pieces.push_back(list.piece(i));
        shown.push_back(all[i]);
      }
    }
  };
  add(result.states, result.final.x);
  add(result.outputs, result.final.outputs);
  std::string text = pieces.empty() ? "" : wrapped("end state", pieces);
  pieces.clear();
  for (const auto& name : names) {
    const auto found = result::numbers_of({name}, result.switching_functions);
    if (!found) continue;
    for (const std::size_t j : *found) {
      if (j >= result.final.mode.size() || j >= result.final.alpha.size()) continue;
      const int mode = result.final.mode[j];
      pieces.push_back(fmt::format("{} {} 0{}", result.switching_functions[j],
                                   mode > 0   ? ">"
                                   : mode < 0 ? "<"
                                              : "=",
                                   mode == 0 ? fmt::format(" (alpha {:.6g})", result.final.alpha[j]) : ""));
    }
  }
  if (!pieces.empty()) text += wrapped("modes", pieces);
  return text + labels_text(shown, result.model.captions);
}

}  // namespace

std::string end_state(const result::Result& result, const std::vector<std::string>& names) {
  if (!names.empty()) return named_values(result, names);
  std::string text = values_text("end state", "states", {result.states, result.final.x, result.model.captions});
  text += sliding_text(result) + regions_text(result) + contacts_text(result);
  auto shown = result.states;
  if (!result.outputs.empty() && !result.final.outputs.empty()) {
    text += values_text("outputs", "outputs", {result.outputs, result.final.outputs, result.model.captions});
    shown.insert(shown.end(), result.outputs.begin(), result.outputs.end());
  }
  return text + labels_text(shown, result.model.captions);
}

std::vector<std::size_t> shown_states(const result::Result& result, const std::vector<std::string>& names) {
  std::vector<std::size_t> states;
  for (const auto& name : names) {
    const auto found = result::numbers_of({name}, result.states);
    if (found) states.insert(states.end(), found->begin(), found->end());
  }
  return states;
}

Expected<void> check_names(const std::vector<std::string>& names, const std::vector<std::string>& states,
                           const std::vector<std::string>& outputs,
                           const std::vector<std::string>& switching_functions) {
  std::vector<std::string> all = states;
  for (const auto* more : {&outputs, &switching_functions}) {
    for (const auto& name : *more) {
      if (!contains(all, name)) all.push_back(name);
    }
  }
  const auto found = result::numbers_of(names, all);
  if (found) return {};
  return tl::unexpected(
      Error{ErrorCode::unknown_name,
            fmt::format("--show: there is no state, output or switching function '{}'", found.error()),
            suggest(found.error(), all),
            {},
            {}});
}

}  // namespace saltus::report
