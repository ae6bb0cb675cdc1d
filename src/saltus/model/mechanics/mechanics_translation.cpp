// [mechanics] of a description, in the expressions of the statement.
#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/preparation.hpp"
#include "saltus/model/mechanics/contacts_internal.hpp"

namespace saltus::model {

using casadi::SX;

namespace {

Error mechanics_mistake(const SourceLocation& location, std::string message, std::string remedy) {
  return {ErrorCode::invalid_model, std::move(message), std::move(remedy), location, {}};
}

/// A matrix of the entries that are not 0.
SX sparse_matrix(casadi_int n, const std::vector<casadi_int>& rows, const std::vector<casadi_int>& columns,
                 const std::vector<SXElem>& entries) {
  std::vector<casadi_int> order;
  const auto pattern = casadi::Sparsity::triplet(n, n, rows, columns, order, false);
  std::vector<SXElem> sorted;
  for (const auto k : order) sorted.push_back(entries[at(k)]);
  return SX(pattern, sorted);
}

class MechanicsTranslation {
 public:
  MechanicsTranslation(const Description& description, ModelScope& scope, const Statement& statement)
      : mechanics_(*description.mechanics), scope_(scope), statement_(statement) {}

  [[nodiscard]] Expected<MechanicsStatement> run() {
    stated_.coriolis = mechanics_.coriolis;
    stated_.location = mechanics_.location;
    stated_.mass_location = mechanics_.mass_location;
    for (const auto step :
         {&MechanicsTranslation::states, &MechanicsTranslation::mass, &MechanicsTranslation::potential,
          &MechanicsTranslation::force, &MechanicsTranslation::draw}) {
      if (auto error = (this->*step)()) return tl::unexpected(*error);
    }
    return std::move(stated_);
  }

 private:
  std::optional<Error> states() {
    for (const auto& [names, numbers] : {std::pair{&mechanics_.positions, &stated_.positions},
                                         std::pair{&mechanics_.velocities, &stated_.velocities}}) {
      for (const auto& entry : *names) {
        if (auto error = take_state(entry, *numbers)) return error;
      }
    }
    const std::size_t n = mechanics_.positions.size(), m = mechanics_.velocities.size();
    if (n == m) return std::nullopt;
    const auto& alone = n > m ? mechanics_.positions[m] : mechanics_.velocities[n];
    return mechanics_mistake(
        alone.location,
        n > m ? fmt::format("the position '{}' has no velocity", alone.name)
              : fmt::format("the velocity '{}' has no position", alone.name),
        "`positions` and `velocities` list states in the same order, one velocity for every position");
  }

  std::optional<Error> take_state(const StateName& entry, std::vector<int>& numbers) {
    const Meaning* meaning = scope_.names().find(entry.name);
    if (meaning == nullptr || meaning->kind != NameKind::state) {
      const std::string found = meaning == nullptr ? "" : fmt::format(", which is {}", with_article(meaning->kind));
      return Error{ErrorCode::unknown_name,
                   fmt::format("expected the name of a state, found '{}'{}", entry.name, found),
                   suggest(entry.name, scope_.names().of({NameKind::state})),
                   entry.location,
                   {}};
    }
    for (const auto* list : {&stated_.positions, &stated_.velocities}) {
      if (std::find(list->begin(), list->end(), meaning->index) == list->end()) continue;
      return mechanics_mistake(entry.location, fmt::format("'{}' is listed twice", entry.name),
                               "a state is one position or one velocity");
    }
    numbers.push_back(meaning->index);
    return std::nullopt;
  }

  std::optional<Error> mass() {
    const auto n = static_cast<casadi_int>(stated_.positions.size());
    stated_.mass = SX::eye(n);
    if (mechanics_.mass.empty()) return std::nullopt;
    if (mechanics_.mass.size() != static_cast<std::size_t>(n)) {
      return mechanics_mistake(
          mechanics_.mass_location,
          fmt::format("the mass matrix has {} rows, and there are {} velocities", mechanics_.mass.size(), n),
          "it has a row and a column for every velocity");
    }
    std::vector<casadi_int> rows, columns;
    std::vector<SXElem> entries;
    for (casadi_int i = 0; i < n; ++i) {
      prepares("reading the mass matrix", at(i), at(n));
      const auto& row = mechanics_.mass[at(i)];
      if (row.size() != static_cast<std::size_t>(n)) {
        return mechanics_mistake(
            row.empty() ? mechanics_.mass_location : row.front()->location,
            fmt::format("row {} of the mass matrix has {} entries instead of {}", i + 1, row.size(), n),
            "it has a row and a column for every velocity");
      }
      for (casadi_int j = 0; j < n; ++j) {
        auto entry = scope_.expression(*row[at(j)]);
        if (!entry) return with_context(entry.error(), "in mass");
        if (entry->is_zero()) continue;
        rows.push_back(i);
        columns.push_back(j);
        entries.push_back(*entry);
      }
    }
    stated_.mass = sparse_matrix(n, rows, columns, entries);
    return std::nullopt;
  }

  std::optional<Error> potential() {
    stated_.potential_location = mechanics_.potential ? mechanics_.potential->location : mechanics_.location;
    if (!mechanics_.potential) return std::nullopt;
    auto potential = scope_.expression(*mechanics_.potential);
    if (!potential) return with_context(potential.error(), "in potential");
    stated_.potential = SX(*potential);
    return std::nullopt;
  }

  std::optional<Error> force() {
    const auto& velocities = stated_.velocities;
    stated_.force = SX::zeros(static_cast<casadi_int>(velocities.size()), 1);
    std::vector<bool> given(velocities.size(), false);
    for (const auto& entry : mechanics_.force) {
      const auto place = std::find_if(velocities.begin(), velocities.end(),
                                      [&](int state) { return statement_.states[at(state)].name == entry.velocity; });
      if (place == velocities.end()) return no_such_velocity(entry);
      const auto i = static_cast<std::size_t>(place - velocities.begin());
      if (given[i]) {
        return mechanics_mistake(entry.location, fmt::format("'{}' has two forces", entry.velocity), "write their sum");
      }
      given[i] = true;
      auto force = scope_.expression(*entry.force);
      if (!force) return with_context(force.error(), fmt::format("in force {}", entry.velocity));
      stated_.force(static_cast<casadi_int>(i)) = *force;
    }
    return std::nullopt;
  }

  std::optional<Error> draw() {
    for (const auto& drawn : mechanics_.draw) {
      DrawnStatement stated{.shape = {SX::zeros(2, static_cast<casadi_int>(drawn.points.size())), SX()},
                            .location = drawn.location};
      for (std::size_t k = 0; k < drawn.points.size(); ++k) {
        for (const std::size_t axis : {0U, 1U}) {
          auto coordinate = scope_.expression(*drawn.points[k][axis]);
          if (!coordinate) return with_context(coordinate.error(), "in draw");
          stated.shape.points(static_cast<casadi_int>(axis), static_cast<casadi_int>(k)) = *coordinate;
        }
      }
      if (drawn.radius) {
        auto radius = scope_.expression(*drawn.radius);
        if (!radius) return with_context(radius.error(), "in draw");
        stated.shape.radius = SX(*radius);
      }
      stated_.draw.push_back(std::move(stated));
    }
    return std::nullopt;
  }

  [[nodiscard]] Error no_such_velocity(const ForceDescription& entry) const {
    std::vector<std::string> known;
    for (const auto& velocity : mechanics_.velocities) known.push_back(velocity.name);
    return {ErrorCode::unknown_name,
            fmt::format("a force on '{}', which is no velocity of [mechanics]", entry.velocity),
            suggest(entry.velocity, known),
            entry.location,
            {}};
  }

  const MechanicsDescription& mechanics_;
  ModelScope& scope_;
  const Statement& statement_;
  MechanicsStatement stated_;
};

}  // namespace

Expected<std::optional<MechanicsStatement>> mechanics_of(const Description& description, ModelScope& scope,
                                                         const Statement& statement) {
  if (!description.mechanics && description.contacts.empty()) return std::nullopt;
  if (!description.mechanics) {
    return tl::unexpected(mechanics_mistake(description.contacts.front().location, "[[contacts]] without [mechanics]",
                                            "write [mechanics] with `positions`, `velocities` and `mass`"));
  }
  auto stated = MechanicsTranslation(description, scope, statement).run();
  if (!stated) return tl::unexpected(with_context(stated.error(), "in [mechanics]"));
  auto contacts = contacts_of(description, scope, statement, *stated);
  if (!contacts) return tl::unexpected(contacts.error());
  stated->contacts = std::move(*contacts);
  return std::optional(std::move(*stated));
}

}  // namespace saltus::model
