// [[contacts]] of a description, in the expressions of the statement.
#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "saltus/model/mechanics/contacts_internal.hpp"

namespace saltus::model {

using casadi::SX;

namespace {

SourceLocation tangent_location(const ContactDescription& contact) {
  const bool is_stated = !contact.tangents.empty() && !contact.tangents.front().empty();
  return is_stated ? contact.tangents.front().front().location : contact.location;
}

class ContactTranslation {
 public:
  ContactTranslation(const ContactDescription& contact, ModelScope& scope, const Statement& statement,
                     const MechanicsStatement& mechanics)
      : contact_(contact), scope_(scope), statement_(statement), mechanics_(mechanics) {}

  [[nodiscard]] Expected<ContactStatement> run() {
    ContactStatement stated{.name = contact_.name, .location = contact_.location};
    stated.gap_location = contact_.gap->location;
    stated.tangent_location = tangent_location(contact_);
    stated.friction_location = contact_.friction ? contact_.friction->location : contact_.location;
    stated.restitution_location = contact_.restitution ? contact_.restitution->location : contact_.location;
    for (const auto& [node, result] :
         {std::pair{&contact_.gap, &stated.gap}, std::pair{&contact_.friction, &stated.friction},
          std::pair{&contact_.restitution, &stated.restitution}}) {
      if (*node == nullptr) continue;
      auto e = scope_.expression(**node);
      if (!e) return tl::unexpected(e.error());
      *result = SX(*e);
    }
    for (const auto& entries : contact_.tangents) {
      auto row = tangent(entries);
      if (!row) return tl::unexpected(row.error());
      stated.tangents = stated.tangents.is_empty() ? *row : SX::vertcat({stated.tangents, *row});
    }
    return stated;
  }

 private:
  [[nodiscard]] Expected<SX> tangent(const std::vector<TangentEntry>& entries) {
    const auto& positions = mechanics_.positions;
    SX row = SX::zeros(1, static_cast<casadi_int>(positions.size()));
    for (const auto& entry : entries) {
      const auto place = std::find_if(positions.begin(), positions.end(),
                                      [&](int state) { return statement_.states[at(state)].name == entry.position; });
      if (place == positions.end()) return tl::unexpected(no_such_position(entry));
      auto e = scope_.expression(*entry.value);
      if (!e) return tl::unexpected(e.error());
      row(0, place - positions.begin()) = *e;
    }
    return row;
  }

  [[nodiscard]] Error no_such_position(const TangentEntry& entry) const {
    std::vector<std::string> known;
    for (const int state : mechanics_.positions) known.push_back(statement_.states[at(state)].name);
    const bool velocity = std::any_of(mechanics_.velocities.begin(), mechanics_.velocities.end(),
                                      [&](int state) { return statement_.states[at(state)].name == entry.position; });
    return {ErrorCode::unknown_name,
            fmt::format("the tangent of '{}' has the entry '{}', which is no position of [mechanics]", contact_.name,
                        entry.position),
            velocity ? "a tangent is a row over the positions: write the position whose rate this velocity is"
                     : suggest(entry.position, known),
            entry.location,
            {}};
  }

  const ContactDescription& contact_;
  ModelScope& scope_;
  const Statement& statement_;
  const MechanicsStatement& mechanics_;
};

}  // namespace

Expected<std::vector<ContactStatement>> contacts_of(const Description& description, ModelScope& scope,
                                                    const Statement& statement, const MechanicsStatement& mechanics) {
  std::vector<ContactStatement> result;
  for (const auto& contact : description.contacts) {
    if (contact.tangents.size() > 2) {
      return tl::unexpected(
          Error{ErrorCode::invalid_model,
                fmt::format("the contact '{}' has {} tangents", contact.name, contact.tangents.size()),
                "a contact slips along one tangent, or in the plane of two",
                tangent_location(contact),
                {"in [[contacts]]"}});
    }
    auto stated = ContactTranslation(contact, scope, statement, mechanics).run();
    if (!stated) return tl::unexpected(with_context(stated.error(), "in [[contacts]]"));
    result.push_back(std::move(*stated));
  }
  return result;
}

}  // namespace saltus::model
