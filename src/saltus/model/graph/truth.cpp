#include <algorithm>

#include "saltus/model/graph/truth_internal.hpp"

namespace saltus::model {

Truth TruthDiagram::make(int literal, Truth low, Truth high) {
  if (low == high) return low;
  if (overflowed()) return constant_false();
  const auto [it, fresh] = unique_.try_emplace({literal, low, high}, size());
  if (fresh) nodes_.push_back({literal, low, high});
  return it->second;
}

Truth TruthDiagram::literal(int index) { return make(index, constant_false(), constant_true()); }

Truth TruthDiagram::negation(Truth a) {
  if (a <= 1) return 1 - a;
  // Shares its cache with the conjunctions: the pair (a, -1) cannot be one.
  if (const auto it = conjunctions_.find({a, -1}); it != conjunctions_.end()) return it->second;
  const Node node = (*this)[a];
  const Truth result = make(node.literal, negation(node.low), negation(node.high));
  conjunctions_[{a, -1}] = result;
  return result;
}

Truth TruthDiagram::conjunction(Truth a, Truth b) {
  if (a > b) std::swap(a, b);
  if (a == constant_false() || a == b) return a;
  if (a == constant_true()) return b;
  if (const auto it = conjunctions_.find({a, b}); it != conjunctions_.end()) return it->second;
  const Node first = (*this)[a], second = (*this)[b];
  const int top = std::min(first.literal, second.literal);
  const Truth low = conjunction(first.literal == top ? first.low : a, second.literal == top ? second.low : b);
  const Truth high = conjunction(first.literal == top ? first.high : a, second.literal == top ? second.high : b);
  const Truth result = make(top, low, high);
  conjunctions_[{a, b}] = result;
  return result;
}

Truth TruthDiagram::disjunction(Truth a, Truth b) { return negation(conjunction(negation(a), negation(b))); }

Truth TruthDiagram::choice(Truth condition, Truth a, Truth b) {
  return disjunction(conjunction(condition, a), conjunction(negation(condition), b));
}

Truth TruthDiagram::table(std::span<const int> literals, const std::vector<bool>& entries) {
  if (literals.empty()) return entries.front() ? constant_true() : constant_false();
  std::vector<bool> halves[2];
  for (std::size_t i = 0; i < entries.size(); ++i) halves[i & 1U].push_back(entries[i]);
  const Truth low = table(literals.subspan(1), halves[0]);
  const Truth high = table(literals.subspan(1), halves[1]);
  return make(literals.front(), low, high);
}

}  // namespace saltus::model
