// Nonsmooth terms -> switching functions and selections alpha.
#pragma once

#include <memory>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <unordered_map>
#include <utility>
#include <vector>

#include "saltus/base/function_ref.hpp"
#include "saltus/model/graph/sharing_internal.hpp"
#include "saltus/model/graph/sx_graph_internal.hpp"
#include "saltus/model/recognition/condition.hpp"
#include "saltus/model/recognition/decisions_internal.hpp"

namespace saltus::model {

/// Holds a switching function in the order it was met; the alphas in psi belong to smaller numbers.
struct MetFunction {
  std::string name;
  SXElem psi;
  int psi_node = 0;
  SXElem alpha;
  int alpha_node = 0;
  bool named = false;
  /// Changes by jumps only: nothing moves it off 0, so alpha has a value there, the one written.
  bool discrete = false;
  /// Of one that depends on discrete states (for others they can make it vanish for a while, as n x does for n = 0);
  /// nothing: it does not matter (abs) or nobody asked.
  std::optional<double> alpha_at_zero{};
};

/// Holds a name of [switching]: a function, seen with this orientation.
struct DeclaredFunction {
  std::string name;
  SharedFunction function;
  std::string alias_of;  ///< empty unless the function had a declared name before
};

/// Holds an expression with both values of a two-valued state put in.
struct BothValues {
  int function = 0;  ///< its selection is the state
  SXElem at_one, at_zero;
};

/// Holds how a term with selections or cells inside was written: what it is at an instant is made of its parts there.
struct WrittenTerm {
  enum class Kind { step, whole_part, choice } kind = Kind::step;
  SXElem argument;  ///< of a choice: a where it is positive, else b
  SXElem a = 0.0, b = 0.0;
  [[nodiscard]] std::vector<SXElem> parts() const { return {argument, a, b}; }
};

/// Holds what jumps need to know to read values at an instant.
struct Instant {
  /// Returns what is left of a value by rounding, also by that of the time at which it is read.
  FunctionRef<SXElem(const SXElem&)> rounding;
  std::vector<bool> followed;  ///< by function: a run knows when it is at zero, whatever is left of it there
  std::vector<bool> moving;    ///< by function: f depends on it; its selection may lie between 0 and 1
  std::vector<int> inputs;     ///< nodes, by control
};

/// Largest number of smooth branches a chain of nested nonsmooth terms may unfold into.
inline constexpr int branch_limit = 64;

/// Collects the switching functions of one model. All results are expressions over the graph's symbols.
/// Errors carry no location; whoever knows the text adds it.
class Recognition {
 public:
  SxGraph graph;

  [[nodiscard]] Expected<SXElem> step(const SXElem& e, const std::string& name);
  [[nodiscard]] Expected<SXElem> sign(const SXElem& e, const std::string& name);
  [[nodiscard]] Expected<SXElem> abs(const SXElem& e, const std::string& name);
  /// Takes `name`, the text of a - b.
  [[nodiscard]] Expected<SXElem> max(const SXElem& a, const SXElem& b, const std::string& name);
  [[nodiscard]] Expected<SXElem> min(const SXElem& a, const SXElem& b, const std::string& name);
  [[nodiscard]] Expected<SXElem> select(const Condition& condition, const SXElem& a, const SXElem& b);

  /// Makes expressions values at an instant, over the alphas there: 1 beyond the surface, 0 below, between them on it.
  /// A condition is 1 where it holds as written, equality included, else 0; floor is that of its argument. What is
  /// inside of a term comes first.
  [[nodiscard]] std::optional<Error> put_at_instant(const std::vector<casadi::SX*>& all, const Instant& instant);
  /// Returns by function whether the roots depend on it.
  [[nodiscard]] std::vector<bool> functions_below(const std::vector<int>& roots) const;
  /// Returns the switching function of a node, or of a multiple of it; nothing if it is none.
  [[nodiscard]] std::optional<SharedFunction> function_of(int node) { return find(node, std::nullopt); }

  /// Lets floor and mod from now on be of states and controls, too, or no longer: where nothing but a record has them.
  void take_whole_parts_of_all(bool all) { whole_parts_of_all_ = all; }
  /// Returns floor(e): e of time and parameters only.
  [[nodiscard]] Expected<SXElem> floor(const SXElem& e, const std::string& name);
  /// Returns e - m floor(e/m): m a constant other than 0, e of time and parameters only.
  [[nodiscard]] Expected<SXElem> mod(const SXElem& e, const SXElem& m, const std::string& name);
  /// Returns the value of a table at e. Alphas in e are taken out of it: the tables at e with them at 0 and 1, blended.
  [[nodiscard]] Expected<SXElem> lookup(const std::shared_ptr<const CellTable>& table, const SXElem& e,
                                        const std::string& name);

  /// Returns where a condition holds, over the functions it consists of (literals by their numbers).
  [[nodiscard]] Expected<Truth> truth(TruthDiagram& diagram, const Condition& condition);

  /// Declares a named switching function. Its scaling is kept, even if an unnamed multiple was met before.
  [[nodiscard]] Expected<DeclaredFunction> declare(const std::string& name, const SXElem& psi);

  [[nodiscard]] const std::vector<MetFunction>& functions() const { return functions_; }
  /// Returns whether an expression is constant between jumps: made of constants, parameters and discrete states.
  [[nodiscard]] Expected<bool> changes_by_jumps_only(const SXElem& expression);
  /// Returns the scalar difference of a comparison; refused where its sides move and must not.
  [[nodiscard]] Expected<SXElem> difference_of(const Comparison& comparison);
  /// Returns the value of an expression of constants and parameters; nothing if it is none.
  [[nodiscard]] std::optional<double> parameter_value(const SXElem& expression);

  /// Makes a symbol, of time or a discrete state, that of a state; its functions are moving ones from now on.
  void restate_as_state(const SXElem& symbol, int index);
  /// Takes a state as 0 or 1: what is compared with it is worked out for both from now on, and blended.
  void take_as_two_valued(const SXElem& symbol);
  /// Returns what an expression is for both values of a two-valued state in it; nothing if there is none.
  [[nodiscard]] Expected<std::optional<BothValues>> both_values(const SXElem& e);
  /// Returns selections made before their states became two-valued, each with what it is now.
  [[nodiscard]] Expected<std::vector<std::pair<SXElem, SXElem>>> restated_selections();
  /// Returns the selection of a surface as it is, also where two-valued states are between 0 and 1.
  [[nodiscard]] Expected<SXElem> surface(const SXElem& e, const std::string& name);

  /// Notes a decision; one without parameters, or noted before, is left out.
  /// @param text  of Decision
  void note(Decision decision, FunctionRef<std::string()> text);
  [[nodiscard]] const std::vector<Decision>& decisions() const { return decisions_; }

 private:
  /// What step(e) turns out to be.
  struct Selection {
    enum class Kind { constant, alpha, polynomial } kind = Kind::constant;
    double constant = 0.0;          ///< the value of e, not of its step
    SharedFunction function{};      ///< of kind alpha
    std::vector<int> literals{};    ///< of kind polynomial: e depends on nothing but these functions' alphas
    std::vector<double> corners{};  ///< of kind polynomial: values of e at the corners of `literals`
  };
  /// @param at_zero  the selection where e is 0, if that matters; regarded for discrete functions only
  [[nodiscard]] Expected<Selection> selection(const SXElem& e, const std::string& name, std::optional<double> at_zero);
  [[nodiscard]] Expected<Selection> corner_selection(int node, const std::vector<int>& literals);
  [[nodiscard]] Expected<SXElem> choose(const SXElem& difference, const std::string& name, const SXElem& a,
                                        const SXElem& b);
  [[nodiscard]] SXElem value(const Selection& selection);
  [[nodiscard]] SXElem marked(const SXElem& truth, const Condition& condition);
  [[nodiscard]] SXElem marked(const SXElem& value, const WrittenTerm& term);
  [[nodiscard]] Expected<SXElem> on_surfaces_only(const Condition& condition, bool elsewhere);
  class AtInstant;  ///< of an expression (instant_values.cpp)
  using MakeSelection = FunctionRef<Expected<SXElem>(const SXElem&, const std::string&)>;
  /// Returns what is made of e, or of e with every value of the two-valued states in it, blended.
  [[nodiscard]] Expected<SXElem> blended(const SXElem& e, const std::string& name, MakeSelection make);
  /// Returns those whose psi has a two-valued state in it, also by its selections.
  [[nodiscard]] std::vector<int> functions_of_two_valued() const;
  [[nodiscard]] std::string text_at(const std::string& name, const BothValues& both, int value) const;
  [[nodiscard]] Expected<Truth> comparison_truth(TruthDiagram& diagram, const Comparison& comparison);
  [[nodiscard]] Expected<Truth> truth_at_both(TruthDiagram& diagram, const Comparison& comparison,
                                              const BothValues& both);
  [[nodiscard]] std::optional<SharedFunction> find(int psi_node, std::optional<double> at_zero);
  int append(const std::string& name, const SXElem& psi, int psi_node, std::optional<double> at_zero);
  [[nodiscard]] Expected<SXElem> whole_part(const SXElem& e, const SXElem& written, const std::string& name);
  [[nodiscard]] std::optional<SXElem> lookup_corners(const std::shared_ptr<const CellTable>& table, const SXElem& e,
                                                     const std::string& name, int& corners);
  [[nodiscard]] std::vector<int> alphas_in(int node) const;

  bool whole_parts_of_all_ = false;
  std::vector<MetFunction> functions_;
  std::vector<int> two_valued_;  ///< functions whose selections are states
  SharingIndex index_;
  std::unordered_map<const void*, Condition> conditions_;  ///< by the marks of their truth in expressions
  std::unordered_map<const void*, WrittenTerm> terms_;     ///< by their marks
  std::vector<Decision> decisions_;
  std::set<std::tuple<Decision::Kind, int, int, std::string>> known_decisions_;
  std::shared_ptr<const CellTable> integers_ = std::make_shared<const CellTable>(integer_cells());
};

/// Counts the smooth branches an expression unfolds into, up to the limit. The alphas in it and in their switching
/// functions are decided one after the other. Each that has become constant does not count.
[[nodiscard]] int count_branches(const Tape& tape, int node, int limit);

[[nodiscard]] Error chain_too_long(const std::string& name);

}  // namespace saltus::model
