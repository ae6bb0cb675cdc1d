#include "saltus/model/recognition/condition.hpp"

#include <optional>

#include "saltus/base/contracts.hpp"

namespace saltus::model {

struct Condition::Node {
  Kind kind = Kind::constant;
  Comparison comparison{};
  std::optional<Condition> left{}, right{};
  double truth = 0.0;
};

Condition::Condition(std::shared_ptr<const Node> node) : node_(std::move(node)) {}

Condition::Condition(Comparison comparison)
    : node_(std::make_shared<const Node>(Node{.kind = Kind::comparison, .comparison = std::move(comparison)})) {}

Condition Condition::always() {
  return Condition(std::make_shared<const Node>(Node{.kind = Kind::constant, .truth = 1.0}));
}

Condition Condition::never() {
  return Condition(std::make_shared<const Node>(Node{.kind = Kind::constant, .truth = 0.0}));
}

Condition::Kind Condition::kind() const { return node_->kind; }

const Comparison& Condition::comparison() const {
  SALTUS_ASSERT(node_->kind == Kind::comparison);
  return node_->comparison;
}

const Condition& Condition::left() const {
  SALTUS_ASSERT(node_->left.has_value());
  return *node_->left;
}

const Condition& Condition::right() const {
  SALTUS_ASSERT(node_->right.has_value());
  return *node_->right;
}

double Condition::truth() const { return node_->truth; }

Condition operator&&(const Condition& a, const Condition& b) {
  using Node = Condition::Node;
  return Condition(std::make_shared<const Node>(Node{.kind = Condition::Kind::conjunction, .left = a, .right = b}));
}

Condition operator||(const Condition& a, const Condition& b) {
  using Node = Condition::Node;
  return Condition(std::make_shared<const Node>(Node{.kind = Condition::Kind::disjunction, .left = a, .right = b}));
}

Condition operator!(const Condition& a) {
  using Node = Condition::Node;
  return Condition(std::make_shared<const Node>(Node{.kind = Condition::Kind::negation, .left = a}));
}

namespace {

/// A difference of a wrong shape would throw; kept as it is, the builder refuses it with a message.
casadi::SX difference(const casadi::SX& a, const casadi::SX& b) { return a.is_scalar() && b.is_scalar() ? a - b : a; }

}  // namespace

Condition greater(const casadi::SX& a, const casadi::SX& b, const std::string& name) {
  return Condition(Comparison{difference(a, b), AtEquality::is_false, name, Sides::any});
}

Condition greater_equal(const casadi::SX& a, const casadi::SX& b, const std::string& name) {
  return Condition(Comparison{difference(a, b), AtEquality::is_true, name, Sides::any});
}

Condition less(const casadi::SX& a, const casadi::SX& b, const std::string& name) { return greater(b, a, name); }

Condition less_equal(const casadi::SX& a, const casadi::SX& b, const std::string& name) {
  return greater_equal(b, a, name);
}

Condition equal(const casadi::SX& a, const casadi::SX& b, const std::string& name, const std::string& reverse_name) {
  return Condition(Comparison{difference(a, b), AtEquality::is_true, name, Sides::still}) &&
         Condition(Comparison{difference(b, a), AtEquality::is_true, reverse_name, Sides::still});
}

Condition not_equal(const casadi::SX& a, const casadi::SX& b) { return !equal(a, b); }

}  // namespace saltus::model
