// Notes of what was decided with the values of parameters, so that it can be asked whether others decide the same.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "saltus/model/recognition/surfaces_internal.hpp"

namespace saltus::model {

/// Names a number of a System that was computed from parameters; who sets it himself does not mean the computed one.
struct ComputedNumber {
  enum class Of { nothing_kept, parameters, initial_state };
  Of list = Of::nothing_kept;
  int index = 0;
};

/// Holds a decision by the nodes it was about.
struct Decision {
  enum class Kind {
    value,     ///< a number that was computed
    sign,      ///< of a constant
    cell,      ///< of a table, in which a constant lies
    multiple,  ///< one switching function is a multiple of the other
    excluded,  ///< signs that two thresholds cannot have together
  };
  Kind kind = Kind::value;
  int node = -1, other = -1;
  std::string text{};  ///< says what was decided; of a value or sign: what has it
  std::shared_ptr<const CellTable> table{};
  ComputedNumber computed{};
  double outcome = 0.0;
};

/// Returns what is decided with the values that parameters have on a tape.
[[nodiscard]] double outcome(const Tape& tape, const Decision& decision);
[[nodiscard]] bool has_parameters(const Tape& tape, const Decision& decision);
/// Returns a decision with its outcome for the values that parameters have on the tape, and that in its text.
[[nodiscard]] Decision decided(const Tape& tape, Decision decision);

/// Holds what has to stay positive of a mass matrix: a pivot of its factorisation that depends on positions.
struct MassPivot {
  int row = 0, velocity = 0;  ///< of the matrix; its state
  int node = -1;
};

/// Holds all of a system, over a tape of its own that has their nodes only.
struct Decisions {
  Tape tape{};
  std::vector<Decision> noted{};
  std::vector<std::pair<int, std::string>> functions{};  ///< psi of all, with their names
  std::vector<Surface> kinks{};                          ///< nothing jumps there
  Selections discrete{};
  std::vector<int> targets{};  ///< what could jump
  std::vector<MassPivot> mass_pivots{};
};

/// Returns them over a tape of their own, without targets that are on no kink, or in which no parameter is; null where
/// none is in any, and there are no pivots.
[[nodiscard]] std::shared_ptr<const Decisions> on_tape_of_their_own(const Tape& tape, Decisions decisions);

}  // namespace saltus::model
