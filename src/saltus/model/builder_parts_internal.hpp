// What a Builder has gathered, and how it becomes a system.
#pragma once

#include <exception>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/base/function_ref.hpp"
#include "saltus/model/builder.hpp"
#include "saltus/model/statement/names_internal.hpp"
#include "saltus/model/time_freezing/freeze_internal.hpp"

namespace saltus::model {

struct Builder::Parts {
  struct StatedHysteresis {
    int state = 0;
    SXElem input;
    HysteresisThresholds thresholds;
  };

  Recognition recognition;
  Statement statement;
  NameTable names;
  std::optional<MechanicsStatement> mechanics;
  std::vector<std::pair<std::string, ContactOptions>> contacts;
  std::vector<casadi::SX> gaps;
  std::vector<StatedHysteresis> hysteresis;
  FreezingNumbers freezing;
  std::optional<Error> error;

  void fail(Error mistake) {
    if (!error) error = std::move(mistake);
  }
  void refuse(std::string message, std::string remedy) {
    fail({ErrorCode::invalid_model, std::move(message), std::move(remedy), {}, {}});
  }
  bool declare(const std::string& name, NameKind kind, std::size_t index) {
    auto mistake = names.declare(name, {kind, static_cast<int>(index), {}});
    if (mistake) fail(*mistake);
    return !mistake;
  }

  /// Returns a scalar; of another shape it is refused.
  SXElem entry(const casadi::SX& expression, const std::string& where);
  /// Returns the result of a recognition, or 0 and the mistake kept. Nothing is tried after the first one.
  casadi::SX kept(FunctionRef<Expected<SXElem>()> recognise);
  casadi::SX symbol(const std::string& name, const Variable& variable) {
    return casadi::SX(recognition.graph.symbol(name, variable));
  }
  void add_state(const std::string& name, const Values& values, VariableKind kind);
  /// Adds a jump without its trigger; null after a mistake.
  JumpStatement* add_jump(const std::map<std::string, casadi::SX>& set, const JumpOptions& options);
  void add_mode(ModeStatement mode, const std::map<std::string, casadi::SX>& rates, const std::string& group);
  /// @return false after a mistake
  bool take_drawing(const std::vector<DrawnShape>& shapes, MechanicsStatement& stated);
  /// Returns the cells of points without mistake; null with the mistake kept.
  std::shared_ptr<const CellTable> cells(const std::string& kind, const std::string& name,
                                         const std::optional<PointMistake>& mistake, FunctionRef<CellTable()> make);

  template <class Entries>
  typename Entries::value_type* find(Entries& entries, const std::string& name, NameKind kind) {
    const Meaning* meaning = names.find(name);
    if (meaning != nullptr && meaning->kind == kind) return &entries[at(meaning->index)];
    fail({ErrorCode::unknown_name,
          fmt::format("'{}' is not {} of this model", name, with_article(kind)),
          suggest(name, names.of({kind})),
          {},
          {}});
    return nullptr;
  }

  /// Says whether time stands still in the form that finite elements and optimal control take.
  [[nodiscard]] bool stands_still() const { return !contacts.empty() || !hysteresis.empty(); }
  /// Returns the system with contacts and hysteresis as events.
  Expected<System> physical();
  /// Returns the system without what physical() makes of planar friction: as it is written.
  Expected<System> as_written();
  /// Returns the system whose time stands still at contacts and hysteresis. What was recognised is recognised there,
  /// too, of copies in which t is the clock, a state, and hysteresis states move.
  Expected<System> frozen(FrozenFor purpose);

 private:
  std::optional<Error> add_mechanics(Recognition& recognised, Statement& whole, const StateContacts& take = {});
  Expected<MechanicsStatement> mechanics_with_contacts(const Statement& whole);
  Expected<System> frozen_copy(Recognition recognised, Statement whole, FreezingPlan plan);
};

/// Returns what `make` makes; exceptions of CasADi become errors.
[[nodiscard]] Expected<System> guarded(FunctionRef<Expected<System>()> make);

}  // namespace saltus::model
