// Syntax trees -> CasADi expressions, with nonsmooth functions recognised on the way.
#pragma once

#include <string>

#include "saltus/expression/syntax_tree.hpp"
#include "saltus/model/recognition/recognition_internal.hpp"

namespace saltus::model {

class ModelScope;

/// Resolves names through the scope, which in turn has definitions translated here.
class Translation {
 public:
  Translation(Recognition& recognition, ModelScope& scope) : recognition_(recognition), scope_(scope) {}

  /// @return the expression, or the first error with the position of the part it is about.
  [[nodiscard]] Expected<SXElem> number(const expression::Node& node);
  [[nodiscard]] Expected<Condition> condition(const expression::Node& node);
  [[nodiscard]] bool is_condition(const expression::Node& node) const;

 private:
  [[nodiscard]] Expected<SXElem> unary(const expression::Unary& unary, const SourceLocation& location);
  [[nodiscard]] Expected<SXElem> binary(const expression::Binary& binary, const SourceLocation& location);
  [[nodiscard]] Expected<SXElem> call(const expression::Call& call, const SourceLocation& location);
  [[nodiscard]] Expected<SXElem> nonsmooth(const expression::Call& call, const SourceLocation& location);
  [[nodiscard]] Expected<SXElem> cells(const expression::Call& call, const SXElem& argument);
  [[nodiscard]] Expected<SXElem> branch(const expression::Call& call);
  [[nodiscard]] Expected<Condition> comparison(const expression::Binary& binary, const SourceLocation& location);
  [[nodiscard]] Expected<Condition> equality(const expression::Binary& binary, const SourceLocation& location);

  Recognition& recognition_;
  ModelScope& scope_;
};

}  // namespace saltus::model
