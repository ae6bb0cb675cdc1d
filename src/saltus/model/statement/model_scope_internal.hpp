// The names of a description and what they stand for; definitions and switching functions are worked out when first
// used.
#pragma once

#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "saltus/model/description.hpp"
#include "saltus/model/statement/names_internal.hpp"
#include "saltus/model/statement/statement_internal.hpp"
#include "saltus/model/statement/translation_internal.hpp"

namespace saltus::model {

/// Says what an expression may speak of.
enum class Reach {
  constants,           ///< numbers and pi (--set)
  earlier_parameters,  ///< parameters declared so far, too
  everything,
  outputs_too,  ///< and the outputs
};

class ModelScope {
 public:
  ModelScope(const Description& description, Recognition& recognition, Statement& statement);

  /// Lets a mistake from now on not end the work: it goes into the list.
  void collect_mistakes(std::vector<Error>& found, bool is_whole) {
    found_ = &found;
    follows_mistake_ = !is_whole;
    is_whole_ = is_whole;
  }
  /// Returns what a step says of a mistake: the error, which ends the work, or nothing, as it is in the list. Errors
  /// without message follow from others.
  [[nodiscard]] std::optional<Error> end_at(Error error);
  /// Returns whether there are mistakes, also if they follow from others that stand in no list: the statement is not
  /// complete.
  [[nodiscard]] bool has_mistakes() const { return follows_mistake_ || (found_ != nullptr && !found_->empty()); }
  /// Notes that what a name means could not be worked out: expressions with it follow suit in silence.
  void give_up(const std::string& name) { given_up_.insert(name); }
  [[nodiscard]] bool is_given_up(const std::string& name) const { return name.empty() || given_up_.contains(name); }

  /// Returns all names of the description, in the order of the file; a clash is an error.
  [[nodiscard]] std::optional<Error> declare_names();

  ModelScope(const ModelScope&) = delete;  // the translation refers to it
  ModelScope& operator=(const ModelScope&) = delete;
  ~ModelScope() = default;

  /// Returns the expression a name stands for (pi excepted, which the translation knows).
  [[nodiscard]] Expected<SXElem> number(const std::string& name, const SourceLocation& location);
  /// Returns the cells of a table of the description; only for names the parser took for one.
  [[nodiscard]] Expected<std::shared_ptr<const CellTable>> table(const std::string& name);
  /// Returns the condition a name stands for; only for names of which is_condition is true.
  [[nodiscard]] Expected<Condition> condition(const std::string& name, const SourceLocation& location);
  [[nodiscard]] bool is_condition(const std::string& name) const;

  /// Returns the whole expression of an entry.
  [[nodiscard]] Expected<SXElem> expression(const saltus::expression::Node& node, Reach reach = Reach::everything);
  /// Returns the value of an expression of constants and parameters.
  /// @param what  "the initial value of 'q'", for the error
  /// @param computed  where the system has it; nothing: simulations do not ask for it
  [[nodiscard]] Expected<double> value(const saltus::expression::Node& node, Reach reach, const std::string& what,
                                       const std::optional<ComputedNumber>& computed = ComputedNumber{});

  /// Works out entry number `index` of [switching] unless that has happened, and declares it.
  [[nodiscard]] std::optional<Error> resolve_switching(int index);
  /// Works out a definition that nothing has used, for its errors.
  [[nodiscard]] std::optional<Error> resolve_definition(int index);

  /// Notes names that occur in some expression of the description, replaced ones (--set) included.
  void note_names(const saltus::expression::NodePtr& node);
  [[nodiscard]] bool is_used(const std::string& name) const { return used_.contains(name); }
  [[nodiscard]] bool is_table_used(std::size_t index) const { return index < tables_.size() && tables_[index]; }
  [[nodiscard]] const NameTable& names() const { return names_; }
  Translation& translation() { return translation_; }
  Recognition& recognition() { return recognition_; }

 private:
  [[nodiscard]] bool is_shared(const std::string& name, const Meaning& meaning) const;
  [[nodiscard]] Error unknown(const std::string& name, const SourceLocation& location) const;
  [[nodiscard]] Error out_of_reach(const std::string& name, const Meaning& meaning,
                                   const SourceLocation& location) const;
  [[nodiscard]] Expected<SXElem> meant(const std::string& name, const Meaning& meaning, const SourceLocation& location);
  [[nodiscard]] Expected<SXElem> definition(int index, const SourceLocation& location);
  /// What has an expression of its own: definitions, conditions among them, and switching functions
  /// (definition_chains.cpp).
  [[nodiscard]] const NamedExpression& entry(const Meaning& meaning) const;
  [[nodiscard]] bool is_worked_out(const Meaning& meaning) const;
  [[nodiscard]] std::optional<Error> work_out(const Meaning& meaning, const SourceLocation& location);
  [[nodiscard]] std::optional<Error> work_out_needs(const Meaning& meaning);
  [[nodiscard]] std::optional<Error> translate(const Meaning& meaning);
  [[nodiscard]] std::optional<Error> declare_switching(int index);
  [[nodiscard]] std::optional<Error> enter(const std::string& name, const SourceLocation& location);

  const Description& description_;
  Recognition& recognition_;
  Statement& statement_;
  Translation translation_;
  NameTable names_;
  Reach reach_ = Reach::everything;
  std::vector<std::string> open_;  ///< definitions and switching functions being worked out
  std::map<int, SXElem> definitions_;
  std::map<int, Condition> conditions_;  ///< those of the definitions that are conditions
  std::map<int, SXElem> switching_;
  std::vector<std::shared_ptr<const CellTable>> tables_;  ///< null until used
  std::set<std::string> used_;
  std::vector<Error>* found_ = nullptr;  ///< null: the first mistake ends the work
  bool follows_mistake_ = false;         ///< some error had no message, or something was left out
  bool is_whole_ = true;                 ///< else names that are unknown may be those left out
  std::set<std::string> given_up_;
};

/// Notes the names in all expressions of a description.
void note_names(const Description& description, ModelScope& scope);

}  // namespace saltus::model
