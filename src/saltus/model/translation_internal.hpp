// Syntax trees -> CasADi expressions, with nonsmooth functions recognised on the way.
#pragma once

#include <string>

#include "saltus/base/function_ref.hpp"
#include "saltus/expression/syntax_tree.hpp"
#include "saltus/model/recognition_internal.hpp"

namespace saltus::model {

/// What names mean; implemented by whoever knows the tables.
class Scope {
 public:
  Scope() = default;
  Scope(const Scope&) = delete;
  Scope& operator=(const Scope&) = delete;
  virtual ~Scope() = default;

  /// The expression a name stands for (t and pi excepted).
  [[nodiscard]] virtual Expected<SXElem> number(const std::string& name, const SourceLocation& location) = 0;
  /// The condition a name stands for; called only if is_condition(name).
  [[nodiscard]] virtual Expected<Condition> condition(const std::string& name, const SourceLocation& location) = 0;
  [[nodiscard]] virtual bool is_condition(const std::string& name) const = 0;
};

class Translation {
 public:
  Translation(Recognition& recognition, Scope& scope) : recognition_(recognition), scope_(scope) {}

  /// @return the expression, or the first error with the position of the part it is about.
  [[nodiscard]] Expected<SXElem> number(const expression::Node& node);
  [[nodiscard]] Expected<Condition> condition(const expression::Node& node);
  [[nodiscard]] bool is_condition(const expression::Node& node) const;

 private:
  [[nodiscard]] Expected<SXElem> unary(const expression::Unary& unary, const SourceLocation& location);
  [[nodiscard]] Expected<SXElem> binary(const expression::Binary& binary, const SourceLocation& location);
  [[nodiscard]] Expected<SXElem> call(const expression::Call& call, const SourceLocation& location);
  [[nodiscard]] Expected<SXElem> nonsmooth(const expression::Call& call, const SourceLocation& location);
  [[nodiscard]] Expected<SXElem> branch(const expression::Call& call);
  [[nodiscard]] Expected<Condition> comparison(const expression::Binary& binary, const SourceLocation& location);
  [[nodiscard]] Expected<Condition> equality(const expression::Binary& binary, const SourceLocation& location);

  Recognition& recognition_;
  Scope& scope_;
};

}  // namespace saltus::model
