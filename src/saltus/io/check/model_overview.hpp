// What Saltus understood of a model, in the user's names: plain data for people and programs.
#pragma once

#include <string>
#include <vector>

#include "saltus/model/description.hpp"
#include "saltus/result/caption.hpp"
#include "saltus/result/result.hpp"

namespace saltus::model {
struct Summary;
}

namespace saltus::io {

/// Holds a state, a parameter or a control.
struct OverviewQuantity {
  std::string name;
  double value = 0.0;  ///< at the start
  double lower = 0.0, upper = 0.0;
  result::Caption caption{};
  std::string remark{};  ///< of a state that does not move: why
};

/// Holds name = text, as it was read.
struct OverviewEquation {
  std::string name;
  std::string text;
  result::Caption caption{};
};

/// Holds one of [[modes]]: where it holds and what it adds.
struct OverviewMode {
  std::string group, name;
  std::string when;  ///< a condition, "otherwise", or "indicator" and its expression
  std::vector<OverviewEquation> rates;
};

struct OverviewSurface {
  std::string name;
  std::string expression;          ///< psi, as it was read
  std::string role;                ///< listed, kink, time event, discrete, region
  std::string meaning;             ///< what happens there, in words
  std::vector<std::string> rates;  ///< states whose right-hand side has its selection
  std::vector<std::string> inner;  ///< functions whose selection its expression contains
  std::string alias_of;            ///< empty, or the function that it is under another name
  bool swapped = false;            ///< an alias with the sides exchanged
};

struct OverviewJump {
  std::string name;
  std::string when;  ///< "when on == 1 and x1 > h", "when y falls below 0", "every 0.5"
  std::vector<OverviewEquation> set;
};

struct OverviewEvent {
  std::string name;
  std::string when;
  bool stops = false;
};

/// Holds the size of one stage as a complementarity system: Table 4 of [nurkanovic2024].
struct OverviewForm {
  std::string name;      ///< step; step, lifted; stewart
  std::string reason{};  ///< why there is none; empty if there is one, whose numbers follow
  int alpha = 0, theta = 0, beta = 0, algebraic = 0, complementarities = 0, equations = 0;
};

struct ModelOverview {
  std::string name, description;
  std::vector<OverviewQuantity> states, parameters, controls;
  std::vector<OverviewEquation> equations;  ///< of [dynamics] and [mechanics]
  std::vector<OverviewEquation> contacts;   ///< gap, tangents, friction, restitution
  std::vector<OverviewMode> modes;
  std::vector<OverviewEquation> definitions, outputs;
  std::vector<OverviewSurface> surfaces;  ///< the columns of a result first and in their order
  std::vector<OverviewEquation> cells;    ///< tables, floor and mod, samples of inputs
  std::vector<OverviewEvent> events;
  std::vector<OverviewJump> jumps;
  std::string inclusion;
  bool multi_affine = true;
  std::vector<std::string> inclusion_differences;
  std::vector<std::string> warnings;
  std::vector<OverviewForm> forms;  ///< filled by who knows them; none where nothing switches with the state
};

/// Says how expressions are written.
enum class Notation { text, latex };

/// Lists the equations of a model in the order of its file: motion, modes, definitions, switching functions, jumps,
/// outputs; at most `most` of them. `where` is plain text in both notations.
[[nodiscard]] std::vector<result::StatedEquation> stated_equations(const model::Description& description,
                                                                   std::size_t most,
                                                                   Notation notation = Notation::text);

/// Reads the two, computes nothing.
/// @param system  of this description, by model::summary_of
[[nodiscard]] ModelOverview overview_of(const model::Description& description, const model::Summary& system,
                                        const result::Captions& captions = {});

}  // namespace saltus::io
