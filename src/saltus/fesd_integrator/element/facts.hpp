// What the engine needs to know of a model beside its functions: plain data.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "saltus/fesd_integrator/element/active_set.hpp"
#include "saltus/model/cells.hpp"
#include "saltus/model/statement/event_rules.hpp"
#include "saltus/result/result.hpp"

namespace saltus::model {
struct System;
}
namespace saltus::reformulation {
struct Dcs;
}

namespace saltus::fesd_integrator {

/// Holds a column of the result.
struct ColumnFact {
  std::string name;
  int function = 0;  ///< into System::alpha
  int orientation = 1;
  bool listed = false;  ///< changes of its mode are events
};

/// Holds a group of modes by `indicator`: functions first, first + 1, … of System::alpha are its weights.
struct RegionFact {
  int first = 0;
  std::vector<std::string> names;
};

struct HeldFact {
  bool cell = false;  ///< a constant of a cell; else a selection
  std::shared_ptr<const model::CellTable> table;
  int column = 0;
  double at_zero = 0.5;
};

struct EventFact {
  std::string name;
  model::EventRule rule;
  bool stop = false;
};

struct Facts {
  std::size_t n_x = 0, n_u = 0, n_y = 0, n_functions = 0;
  std::vector<Part> parts;
  std::vector<ColumnFact> columns;
  std::vector<RegionFact> regions;
  /// Names of selections: of the surface; in Stewart's form of the region, its mode or its sides ("a > 0, b < 0").
  std::vector<result::ElementSelection> selections;
  std::vector<HeldFact> held;
  std::vector<EventFact> events;
  std::vector<double> initial_state;
  std::vector<std::string> state_names;
};

[[nodiscard]] Facts facts(const model::System& system, const reformulation::Dcs& dcs);

}  // namespace saltus::fesd_integrator
