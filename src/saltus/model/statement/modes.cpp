#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/expression/parser.hpp"
#include "saltus/model/statement/model_scope_internal.hpp"
#include "saltus/model/statement/modes_internal.hpp"

namespace saltus::model {
namespace {

bool is_otherwise(const expression::Node& node) {
  const auto* name = std::get_if<expression::Name>(&node.value);
  return name != nullptr && name->name == "otherwise";
}

Error mode_error(const ModeDescription& mode, std::string message, std::string remedy) {
  return {ErrorCode::invalid_model, std::move(message), std::move(remedy), mode.location, {"in [[modes]]"}};
}

std::optional<Error> check_form(const ModeDescription& mode) {
  if (mode.when && mode.indicator) {
    return mode_error(mode, "this mode has both `when` and `indicator`",
                      "a region is given by a condition (`when`) or by the smallest indicator of its group");
  }
  if (!mode.when && !mode.indicator) {
    return mode_error(mode, "this mode has no `when`", "write when = \"condition\" or when = \"otherwise\"");
  }
  if (mode.name && !mode.indicator) {
    return mode_error(mode, "`name` belongs to modes with an `indicator`",
                      "remove it; a mode with `when` is seen by the signs of its switching functions");
  }
  return std::nullopt;
}

/// The groups of a description on their way into the statement.
class ModeReader {
 public:
  ModeReader(const Description& description, ModelScope& scope, Statement& statement)
      : description_(description), scope_(scope), statement_(statement) {}

  std::optional<Error> run() {
    for (const auto& mode : description_.modes) {
      auto error = check(mode);
      if (error) error = scope_.end_at(std::move(*error));
      if (error) return error;
    }
    for (const auto& group : statement_.mode_groups) {
      auto error = check_names(group);
      if (error) error = scope_.end_at(std::move(*error));
      if (error) return error;
    }
    return std::nullopt;
  }

 private:
  std::optional<Error> check(const ModeDescription& mode) {
    if (auto error = check_form(mode)) return error;
    if (auto error = check_group(mode)) return error;
    return read(mode);
  }

  /// One group has one form, and its modes different names.
  std::optional<Error> check_group(const ModeDescription& mode) {
    for (const auto& other : description_.modes) {
      if (&other == &mode) break;
      if (other.group != mode.group) continue;
      if ((other.indicator != nullptr) != (mode.indicator != nullptr)) {
        return mode_error(mode, "`when` and `indicator` in one group",
                          "give all modes of a group the same form, or another group = \"…\"");
      }
      if (mode.indicator && expression::to_text(*mode.indicator) == expression::to_text(*other.indicator)) {
        return mode_error(mode,
                          fmt::format("the modes in lines {} and {} have the same indicator", other.location.line,
                                      mode.location.line),
                          "only one of two modes with one indicator could be active: join them, or correct one");
      }
      if (mode.name && mode.name == other.name) {
        return mode_error(mode, fmt::format("two modes are named '{}'", *mode.name), "rename one of them");
      }
    }
    return std::nullopt;
  }

  /// A default name may be that of another mode.
  static std::optional<Error> check_names(const ModeGroupStatement& group) {
    std::set<std::string> names;
    for (const auto& mode : group.modes) {
      if (!mode.indicator || names.insert(mode.name).second) continue;
      return Error{
          ErrorCode::invalid_model,
          fmt::format("two modes are named '{}' (modes without a name are mode1, mode2, … by position)", mode.name),
          "rename one of them",
          mode.location,
          {"in [[modes]]"}};
    }
    return std::nullopt;
  }

  std::optional<Error> read(const ModeDescription& mode) {
    ModeStatement stated;
    stated.location = mode.location;
    if (mode.indicator) {
      const auto indicator = scope_.expression(*mode.indicator);
      if (!indicator) return with_context(indicator.error(), "in [[modes]]");
      stated.indicator = *indicator;
      stated.name = mode.name.value_or(fmt::format("mode{}", group(mode.group).modes.size() + 1));
    } else if (!is_otherwise(*mode.when)) {
      auto when = scope_.translation().condition(*mode.when);
      if (!when) return with_context(when.error(), "in [[modes]]");
      stated.when = *when;
      stated.location = mode.when->location;
    }
    for (const auto& entry : mode.dynamics) {
      const Meaning* meaning = scope_.names().find(entry.name);
      if (meaning == nullptr || meaning->kind != NameKind::state) return no_such_state(entry, meaning);
      const auto rate = scope_.expression(*entry.expression);
      if (!rate) return with_context(rate.error(), fmt::format("in [[modes]] dynamics of {}", entry.name));
      stated.rates.push_back({meaning->index, *rate, entry.expression->location});
    }
    group(mode.group).modes.push_back(std::move(stated));
    return std::nullopt;
  }

  ModeGroupStatement& group(const std::string& name) {
    auto& groups = statement_.mode_groups;
    const auto known = std::find_if(groups.begin(), groups.end(), [&](const auto& g) { return g.name == name; });
    if (known != groups.end()) return *known;
    groups.push_back({name, {}});
    return groups.back();
  }

  [[nodiscard]] Error no_such_state(const NamedExpression& entry, const Meaning* meaning) const {
    const std::string found = meaning == nullptr ? "" : fmt::format(", which is {}", with_article(meaning->kind));
    return {ErrorCode::unknown_name,
            fmt::format("expected the name of a state, found '{}'{}", entry.name, found),
            suggest(entry.name, scope_.names().of({NameKind::state})),
            entry.location,
            {"in [[modes]] dynamics"}};
  }

  const Description& description_;
  ModelScope& scope_;
  Statement& statement_;
};

void add_rate(StateStatement& state, const SXElem& rate, const SourceLocation& location) {
  if (!state.dynamics) state.dynamics_location = location;
  state.dynamics = state.dynamics ? *state.dynamics + rate : rate;
}

}  // namespace

std::optional<Error> state_modes(const Description& description, ModelScope& scope, Statement& statement) {
  return ModeReader(description, scope, statement).run();
}

std::optional<Error> add_modes(Recognition& recognition, Statement& statement) {
  for (const auto& group : statement.mode_groups) {
    if (group.by_indicator()) {
      // Regions are weighted by selections of their own, which the assembly makes.
      for (const auto& mode : group.modes) {
        for (const auto& [state, rate, location] : mode.rates) {
          add_rate(statement.states[at(state)], SXElem(0.0), location);
        }
      }
      continue;
    }
    auto regions = regions_of(recognition, group);
    if (!regions) return with_context(regions.error(), "in [[modes]]");
    std::vector<SXElem> alphas;
    for (const auto& function : recognition.functions()) alphas.push_back(function.alpha);
    for (std::size_t i = 0; i < group.modes.size(); ++i) {
      const auto& mode = group.modes[i];
      if (regions->impossible[i]) {
        statement.warnings.push_back(located(mode.location, "this mode never holds: its region is empty"));
      }
      const SXElem weight = recognition.graph.polynomial(regions->diagram, regions->truth[i], alphas);
      for (const auto& [state, rate, location] : mode.rates) {
        if (const auto added = recognition.graph.add(rate); !added) return added.error();
        add_rate(statement.states[at(state)], recognition.graph.weighted(weight, rate), location);
      }
    }
  }
  return std::nullopt;
}

}  // namespace saltus::model
